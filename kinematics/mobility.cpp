#include "kinematics/mobility.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "catalog/counted.hpp"
#include "kinematics/branches.hpp"
#include "kinematics/evidence.hpp"
#include "kinematics/manifold.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {
namespace {

constexpr double kDoubtfulGap = 1e3;  // contract: a smaller gap is said in the reasons
constexpr double kDrawnNoise =
    1e-11;                          // closure or rank noise above it comes from rounded coordinates
constexpr double kMoved = 0.02;     // of a step: a platform that went less far has not moved
constexpr double kWavering = 0.03;  // of the best conditioned posture's smallest singular value
constexpr double kStep = 0.25;      // of a walk [rad, or length/size of the fastest joint]
constexpr double kExact = 1e-10;    // loop error at a posture reached by exact data, and
constexpr double kLoose = 100;      // how much more than a drawing's noise it may be
constexpr int kFarther = 3;         // steps made on when the drives seem not to hold
constexpr double kStray = 1e-5;     // [rad, or length/size] of a coordinate said to stay zero

/// What was measured on one motion branch.
struct Measured {
  Freedoms free, locked;  ///< at the posture with the fewest freedoms
  TaskSpace task;
  const Posture* at = nullptr;  ///< that posture
  int dimension = 0;
};

/// Gathers a mobility report step by step; the public function reads as its plan.
class Analysis {
 public:
  Analysis(const Model& model, const MobilityOptions& options)
      : model_(model), options_(options), random_(options.seed), home_(home(model)) {}

  void look_at_home();
  void ask_held_system();
  void explore_branches();
  void choose_main_branch();
  void look_for_self_motion();
  void decide();
  void collect();
  [[nodiscard]] MobilityReport take() { return std::move(report_); }

 private:
  [[nodiscard]] Measured measure(const Branch& branch);
  void note(const RankDecision& rank);
  void note(const Freedoms& freedoms);
  void describe_task();
  [[nodiscard]] bool several_ways() const { return branches_.size() > 1 || departure_.cone; }
  [[nodiscard]] WalkOptions walk_options(int walks, int steps) const {
    return {walks, steps, kStep, std::max(kExact, kLoose * report_.noise), options_.leaps};
  }

  const Model& model_;
  const MobilityOptions& options_;
  std::mt19937_64 random_;
  Posture home_;
  Freedoms home_free_, home_locked_;
  Departure departure_;
  std::vector<Measured> branches_;
  const Measured* main_ = nullptr;
  bool self_motion_ = false;
  MobilityReport report_;
};

void Analysis::note(const RankDecision& rank) {
  report_.rank_gap = std::min(report_.rank_gap, rank.gap);
  report_.noise = std::max(report_.noise, rank.noise);
}

void Analysis::note(const Freedoms& freedoms) {
  note(freedoms.rank);
  note(freedoms.platform_rank);
}

void Analysis::look_at_home() {
  report_.rank_gap = 1e16;
  home_free_ = freedoms_at(model_, home_);
  home_locked_ = hold_drives(model_, home_free_);
  note(home_free_);
  note(home_locked_);
  report_.home = home_free_.mobility;
  report_.platform_home_dof = home_free_.platform_rank.rank;
  report_.home_locked_platform = home_locked_.platform_rank.rank;
  report_.drives = static_cast<int>(model_.drives.size());
  report_.kutzbach =
      static_cast<int>(model_.freedoms.size()) - 6 * static_cast<int>(model_.loop_joints.size());
  if (options_.evidence) ask_held_system();
}

/// The drive-locked system itself: how far home is from singular, and a second opinion.
void Analysis::ask_held_system() {
  const std::vector<int> passive = passive_freedoms(model_);
  const RankDecision held = rank_of(columns(closure_jacobian(model_, home_), passive));
  report_.margin = held.largest > 0 ? held.smallest / held.largest : 0;
  const int nullity = static_cast<int>(passive.size()) - held.rank;
  if (nullity != home_locked_.mobility) report_.rank_gap = 1;
}

void Analysis::explore_branches() {
  departure_ = leave(model_, home_, home_free_.kernel, false,
                     walk_options(options_.walks, options_.steps), random_);
  report_.residual = departure_.residual;
  report_.obstructions = departure_.obstructions;
  for (Branch& branch : departure_.branches) {
    branches_.push_back(measure(branch));
    // Near a self-motion the drives hardly hold: only farther away is it seen that they do.
    if (branches_.back().locked.platform_rank.rank == 0 || branch.excess > 0) continue;
    branch.far.push_back(branch.far.back());
    walk_on(model_, branch.far.back(), walk_options(1, kFarther), random_);
    branches_.back() = measure(branch);
  }
}

Measured Analysis::measure(const Branch& branch) {
  Measured found;
  double best = 0;
  for (const Place& place : branch.far) best = std::max(best, place.free.rank.smallest);
  for (const auto& [posture, there] : branch.far) {
    if (there.rank.smallest < kWavering * best) continue;  // counts waver there
    Freedoms free = there;
    if (branch.excess > 0) {
      free.kernel = branch.near_kernel * branch.span;
      free.platform = platform_motion(model_, posture, free.kernel);
      free.platform_rank = rank_of(free.platform, 1);
      free.mobility = static_cast<int>(free.kernel.cols());
    }
    Freedoms locked = hold_drives(model_, free);
    note(free);
    note(locked);
    // Fewest freedoms are generic; among equals the posture farthest from singular.
    const auto generic = [](const Freedoms& all, const Freedoms& held) {
      return std::tuple(all.mobility, held.mobility, -all.platform_rank.rank, -all.rank.smallest);
    };
    if (found.at && generic(free, locked) >= generic(found.free, found.locked)) continue;
    found.task = task_axes(free);
    found.dimension = free.mobility;
    found.free = std::move(free);
    found.locked = std::move(locked);
    found.at = &posture;
  }
  return found;
}

void Analysis::choose_main_branch() {
  const auto key = [](const Measured& branch) {
    return std::tuple(branch.dimension, branch.task.translations, branch.free.platform_rank.rank,
                      -branch.locked.mobility);
  };
  for (const Measured& branch : branches_) {
    if (!main_ || key(branch) > key(*main_)) main_ = &branch;
    report_.branches.push_back(
        {branch.dimension, pattern_name(branch.task.translations, branch.task.rotations)});
  }
  report_.finite = main_ ? main_->dimension : 0;
  report_.platform_dof = main_ ? main_->free.platform_rank.rank : 0;
  if (main_) report_.task = main_->task;
  // Freedoms that are never more than instantaneous are left by constraints that repeat others.
  const int excess = main_ ? departure_.branches[main_ - branches_.data()].excess : 0;
  report_.redundant_constraints = report_.finite + excess - report_.kutzbach;
  report_.idle = report_.finite - report_.platform_dof;
  report_.locked_mobility = main_ ? main_->locked.mobility : 0;
  report_.locked_platform = main_ ? main_->locked.platform_rank.rank : 0;
  report_.surplus = report_.drives - (report_.finite - report_.locked_mobility);
  report_.motions_meet = report_.home > report_.finite && (several_ways() || departure_.blind);
  describe_task();
}

/// Name, purity, parasitic motion and fixed rotation axis of the task space, from finite motion.
void Analysis::describe_task() {
  TaskSpace& task = report_.task;
  task.characteristic_length = characteristic_length(model_);
  report_.pattern = pattern_name(task.translations, task.rotations);
  report_.axes = axes_name(task.axes);
  if (!main_) return;
  const auto& far = departure_.branches[main_ - branches_.data()].far;
  const int platform = model_.mechanism.platform;
  Screw stray = Screw::Zero();
  Eigen::MatrixXd turns(3, far.size());
  for (std::size_t i = 0; i < far.size(); ++i) {
    const Transform& body = far[i].posture.bodies[platform];
    const Eigen::AngleAxisd turn(body.linear());
    turns.col(static_cast<Eigen::Index>(i)) = turn.angle() * turn.axis();
    Screw moved = coordinates_of(platform_pose(model_, body));
    moved.head<3>() /= model_.size;
    stray = stray.cwiseMax(moved.cwiseAbs());
  }
  for (int axis : task.axes) stray[axis] = 0;
  task.pure = stray.maxCoeff() < kStray;
  for (int axis = 0; axis < 6; ++axis)
    if (stray[axis] >= kStray)
      report_.parasitic.push_back({axis, stray[axis] * (axis < 3 ? model_.size : 1)});
  if (task.rotations != 1) return;
  const Svd svd = svd_of(turns);
  const bool fixed = turns.cols() < 2 || svd.values[1] < kStray;
  if (!fixed) return;
  task.rotation_axis = svd.u.col(0);
  int largest = 0;
  task.rotation_axis.cwiseAbs().maxCoeff(&largest);
  if (task.rotation_axis[largest] < 0) task.rotation_axis = -task.rotation_axis;
  for (double& part : task.rotation_axis)
    if (std::abs(part) < 1e-12) part = 0;
}

/// Whether the platform can move finitely from home although all drives are held.
/// Generic postures do not show it: equal parallel legs, for example, let go at
/// home only.
void Analysis::look_for_self_motion() {
  const bool settled = report_.locked_platform > 0 || (report_.motions_meet && several_ways());
  if (report_.home_locked_platform == 0 || settled) return;
  const Departure held =
      leave(model_, home_, home_locked_.kernel, true, walk_options(1, options_.steps), random_);
  const auto moved = [&](const Place& place) {
    const double way = displacement(model_, home_, place.posture);
    const int platform = model_.mechanism.platform;
    return displacement(model_, home_, place.posture, platform) > kMoved * way &&
           hold_drives(model_, place.free).platform_rank.rank > 0;
  };
  // Where every freedom continues, the platform's do, however little of them a walk happens to use.
  self_motion_ = held.smooth || std::ranges::any_of(held.branches, [&](const Branch& branch) {
                   return std::ranges::any_of(branch.far, moved);
                 });
  report_.residual = std::max(report_.residual, held.residual);
  // A motion that was found says more than ways that are not excluded.
  if (self_motion_) report_.motions_meet = false;
}

void Analysis::decide() {
  auto& reasons = report_.reasons;
  if (report_.platform_dof == 0) {
    report_.verdict = Verdict::rigid;
    reasons.push_back(
        report_.home > 0
            ? fmt::format("The platform cannot move: {} at home, which {} not continue into a "
                          "finite motion.",
                          counted(report_.home, "instantaneous freedom"),
                          report_.home == 1 ? "does" : "do")
            : "The platform cannot move: the loop-closure Jacobian at home has full column rank.");
  } else if (report_.locked_platform > 0) {
    report_.verdict = Verdict::uncertain;
    reasons.push_back(fmt::format(
        "With {} held the platform keeps {} at generic postures.",
        (report_.drives == 1 ? "its drive" : fmt::format("all {} drives", report_.drives)),
        counted(report_.locked_platform, "freedom")));
  } else if (self_motion_) {
    report_.verdict = Verdict::uncertain;
    reasons.push_back(
        "With all drives held at home the platform can still move: a finite self-motion passes "
        "through home, although generic postures are held.");
  } else if (report_.motions_meet) {
    report_.verdict = Verdict::uncertain;
    const std::string ways =
        branches_.size() > 1 ? fmt::format("{} of which meet at home", branches_.size())
        : departure_.cone    ? std::string("whose directions form a cone there")
                             : std::string("one of which was found; others may meet it there");
    reasons.push_back(
        fmt::format("Home is a constraint singularity: {} freedoms there, {} on the motion "
                    "branches, {}; the drives do not decide which way is taken.",
                    report_.home, report_.finite, ways));
  } else if (report_.home_locked_platform > 0) {
    report_.verdict = Verdict::singular_home;
    reasons.push_back(
        fmt::format("Home is an actuation singularity: with the drives held the platform keeps {} "
                    "there; generic postures are held.",
                    counted(report_.home_locked_platform, "instantaneous freedom")));
  } else if (report_.surplus > 0) {
    report_.verdict = Verdict::overdriven;
    reasons.push_back(fmt::format("{} control {}: {} too many, which work against each other.",
                                  counted(report_.drives, "drive"),
                                  counted(report_.finite - report_.locked_mobility, "freedom"),
                                  report_.surplus));
  } else {
    report_.verdict = Verdict::determinate;
    reasons.push_back(fmt::format(
        "The {} the platform's {} ({}) at home and at generic postures.",
        report_.drives == 1 ? "drive holds" : fmt::format("{} drives hold", report_.drives),
        counted(report_.platform_dof, "freedom"), report_.axes));
  }
  if (report_.redundant_constraints > 0)
    reasons.push_back(
        fmt::format("{} redundant: the machine {} only as far as its axes are "
                    "exactly parallel or intersecting as drawn.",
                    counted(report_.redundant_constraints, "constraint is", "constraints are"),
                    report_.verdict == Verdict::rigid ? "can be assembled" : "moves"));
  if (std::max(report_.noise, report_.residual) > kDrawnNoise)
    reasons.push_back(
        fmt::format("The drawing holds to about {:.0e} of the machine's size: what agrees to that "
                    "precision was "
                    "taken as exact, and loops were closed to {:.0e}.",
                    std::max(report_.noise, report_.residual), report_.residual));
  if (departure_.blind)
    reasons.push_back(
        "Home is singular beyond second order: the ways out of it were found by random trials, and "
        "another may have been missed.");
  if (report_.rank_gap < kDoubtfulGap)
    reasons.push_back(
        fmt::format("A rank decision rests on a gap of only {:.3g}; treat the verdict with care.",
                    report_.rank_gap));
}

void Analysis::collect() {
  report_.motion = describe_motion(report_);
  if (!options_.evidence) return;
  Findings findings{model_, home_, home_free_, home_locked_, nullptr, nullptr, nullptr};
  if (main_) {
    findings.generic = main_->at;
    findings.free = &main_->free;
    findings.locked = &main_->locked;
  }
  collect_evidence(findings, report_);
}

}  // namespace

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::determinate:
      return "determinate";
    case Verdict::overdriven:
      return "overdriven";
    case Verdict::singular_home:
      return "singular-home";
    case Verdict::uncertain:
      return "uncertain";
    case Verdict::rigid:
      return "rigid";
  }
  return "";
}

MobilityOptions screening_options(std::uint64_t seed) { return {seed, 1, 1, 3, false}; }

MobilityReport analyse_mobility(const Model& model, const MobilityOptions& options) {
  Analysis analysis(model, options);
  analysis.look_at_home();
  analysis.explore_branches();
  analysis.choose_main_branch();
  analysis.look_for_self_motion();
  analysis.decide();
  analysis.collect();
  return analysis.take();
}

}  // namespace polyglide
