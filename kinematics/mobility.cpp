#include "kinematics/mobility.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <random>

#include "kinematics/manifold.hpp"
#include "kinematics/motion.hpp"

namespace polyglide {
namespace {

constexpr double kMoved = 0.25;  // of a step: a posture nearer to its start has not moved
constexpr double kOtherBranch =
    0.5;  // sine of the angle between tangent spaces of different branches
constexpr double kDoubtfulGap = 1e3;  // contract: a smaller gap is said in the reasons

/// A normal random direction; own generator so that a seed means the same everywhere.
Eigen::VectorXd random_direction(std::mt19937_64& random, Eigen::Index size) {
  Eigen::VectorXd direction(size);
  for (double& value : direction) value = 2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1;
  return direction;
}

/// A walk from home along the constraint manifold.
struct Walk {
  Posture near;  ///< one step from home: where the branch's tangent is taken
  Posture far;   ///< a generic posture
};

std::optional<Walk> walk_from_home(const Model& model, const MobilityOptions& options,
                                   std::mt19937_64& random) {
  const std::vector<int> active = all_freedoms(model);
  const Posture start = home(model);
  const Eigen::VectorXd direction =
      random_direction(random, static_cast<Eigen::Index>(active.size()));
  Walk walk{start, start};
  for (int i = 0; i < options.steps; ++i) {
    const Eigen::VectorXd along = tangent(model, walk.far, active, direction);
    // A long step may leave what closes; a shorter one of the same walk need not.
    bool stepped = false;
    for (double length = options.step; !stepped && length > options.step / 10; length /= 2)
      stepped = step_along(model, walk.far, active, along, length);
    if (!stepped && i == 0) return std::nullopt;
    if (i == 0) {
      walk.near = walk.far;
      if (displacement(model, start, walk.near) < kMoved * options.step / 4) return std::nullopt;
    }
  }
  return walk;
}

/// One motion branch through home and what was measured on it.
struct Branch {
  Eigen::MatrixXd near_kernel;  ///< tangent space near home
  std::vector<Posture> far;
  Freedoms free;    ///< at the posture with the fewest freedoms
  Freedoms locked;  ///< the same with drives held
  TaskSpace task;
  std::optional<Posture> at;  ///< where free and locked were measured
};

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& basis) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(basis).householderQ() *
         Eigen::MatrixXd::Identity(basis.rows(), basis.cols());
}

/// Sine of the largest angle from the smaller space to the larger.
double separation(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::MatrixXd small = orthonormal(a.cols() <= b.cols() ? a : b);
  const Eigen::MatrixXd large = orthonormal(a.cols() <= b.cols() ? b : a);
  if (small.cols() == 0) return 0;
  const Eigen::MatrixXd rest = small - large * (large.transpose() * small);
  return Eigen::JacobiSVD<Eigen::MatrixXd>(rest).singularValues()[0];
}

/// Gathers a mobility report step by step; the public function reads as its plan.
class Analysis {
 public:
  Analysis(const Model& model, const MobilityOptions& options)
      : model_(model),
        options_(options),
        random_(options.seed),
        all_(all_freedoms(model)),
        passive_(passive_freedoms(model)),
        home_(home(model)) {}

  void look_at_home();
  void explore_branches();
  void choose_main_branch();
  void look_for_self_motion();
  void decide();
  void collect_evidence();
  [[nodiscard]] MobilityReport take() { return std::move(report_); }

 private:
  void measure(Branch& branch);
  void note_gap(const RankDecision& rank) {
    report_.rank_gap = std::min(report_.rank_gap, rank.gap);
  }
  void describe_task();
  void name_idle_rods();
  void add_mode(const std::string& about, const Posture& at, const Freedoms& freedoms,
                const std::vector<int>& active);
  [[nodiscard]] std::vector<std::vector<Transform>> animate(const Posture& at,
                                                            const std::vector<int>& active,
                                                            const Eigen::VectorXd& along) const;

  const Model& model_;
  const MobilityOptions& options_;
  std::mt19937_64 random_;
  std::vector<int> all_, passive_;
  Posture home_;
  Freedoms home_free_, home_locked_;
  std::vector<Branch> branches_;
  const Branch* main_ = nullptr;
  bool self_motion_ = false, branching_ = false;
  MobilityReport report_;
};

void Analysis::look_at_home() {
  report_.rank_gap = 1e16;
  home_free_ = freedoms_at(model_, home_, all_);
  home_locked_ = freedoms_at(model_, home_, passive_);
  note_gap(home_free_.rank);
  note_gap(home_locked_.rank);
  report_.home = home_free_.mobility;
  report_.platform_home_dof = home_free_.platform_rank.rank;
  report_.home_locked_platform = home_locked_.platform_rank.rank;
  report_.drives = static_cast<int>(model_.drives.size());
  report_.kutzbach =
      static_cast<int>(model_.freedoms.size()) - 6 * static_cast<int>(model_.loop_joints.size());
}

/// Walks until every walk agrees with home (regular), or until enough walks have
/// shown what branches leave a singular home.
void Analysis::explore_branches() {
  if (report_.home == 0) return;
  int walks = options_.walks;
  for (int i = 0; i < walks; ++i) {
    std::optional<Walk> walk = walk_from_home(model_, options_, random_);
    if (!walk) {
      walks = std::min(4 * options_.walks, 100);
      continue;
    }
    Kernel near = closure_kernel(model_, freedom_screws(model_, walk->near), all_);
    if (near.basis.cols() != report_.home) walks = 4 * options_.walks;
    auto branch = std::find_if(branches_.begin(), branches_.end(), [&](const Branch& known) {
      return known.near_kernel.cols() == near.basis.cols() &&
             separation(known.near_kernel, near.basis) < kOtherBranch;
    });
    if (branch == branches_.end())
      branch = branches_.insert(branch, Branch{std::move(near.basis), {}, {}, {}, {}, {}});
    branch->far.push_back(std::move(walk->far));
  }
  // A home that is as free as its surroundings is a smooth point: one branch only,
  // however far its tangent has turned on the first step.
  if (!branches_.empty() && branches_.front().near_kernel.cols() == report_.home) {
    for (std::size_t i = 1; i < branches_.size(); ++i)
      branches_.front().far.insert(branches_.front().far.end(), branches_[i].far.begin(),
                                   branches_[i].far.end());
    branches_.resize(1);
  }
  for (Branch& branch : branches_) measure(branch);
  branching_ = branches_.size() > 1;
}

void Analysis::measure(Branch& branch) {
  for (const Posture& posture : branch.far) {
    Freedoms free = freedoms_at(model_, posture, all_);
    Freedoms locked = freedoms_at(model_, posture, passive_);
    note_gap(free.rank);
    note_gap(locked.rank);
    const auto freedom_of = [](const Freedoms& all, const Freedoms& held) {
      return std::pair(all.mobility, held.mobility);
    };
    if (branch.at && freedom_of(free, locked) >= freedom_of(branch.free, branch.locked)) continue;
    branch.task = task_axes(free);
    branch.free = std::move(free);
    branch.locked = std::move(locked);
    branch.at = posture;
  }
}

void Analysis::choose_main_branch() {
  const auto key = [](const Branch& branch) {
    return std::tuple(branch.free.mobility, branch.task.translations,
                      branch.free.platform_rank.rank);
  };
  for (const Branch& branch : branches_) {
    if (!main_ || key(branch) > key(*main_)) main_ = &branch;
    report_.branches.push_back(
        {branch.free.mobility, pattern_name(branch.task.translations, branch.task.rotations)});
  }
  const Freedoms& locked = main_ ? main_->locked : home_locked_;
  report_.finite = main_ ? main_->free.mobility : 0;
  report_.platform_dof = main_ ? main_->free.platform_rank.rank : 0;
  if (main_) report_.task = main_->task;
  report_.redundant_constraints = report_.finite - report_.kutzbach;
  report_.idle = report_.finite - report_.platform_dof;
  report_.locked_mobility = main_ ? locked.mobility : 0;
  report_.locked_platform = main_ ? locked.platform_rank.rank : 0;
  report_.surplus = report_.drives - (report_.finite - report_.locked_mobility);
  report_.margin = locked.rank.largest > 0 ? locked.rank.smallest / locked.rank.largest : 0;
  describe_task();
}

/// Name, purity and fixed rotation axis of the task space, from finite motion.
void Analysis::describe_task() {
  TaskSpace& task = report_.task;
  task.characteristic_length = characteristic_length(model_);
  report_.pattern = pattern_name(task.translations, task.rotations);
  report_.axes = axes_name(task.axes);
  if (!main_) return;
  const int platform = model_.mechanism.platform;
  Eigen::Matrix<double, 6, 1> stray = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::MatrixXd turns(3, main_->far.size());
  for (std::size_t i = 0; i < main_->far.size(); ++i) {
    const Transform& body = main_->far[i].bodies[platform];
    const Eigen::AngleAxisd turn(body.linear());
    turns.col(static_cast<Eigen::Index>(i)) = turn.angle() * turn.axis();
    stray.head<3>() = stray.head<3>().cwiseMax(
        (body * model_.mechanism.tool - model_.mechanism.tool).cwiseAbs() / model_.size);
    stray.tail<3>() = stray.tail<3>().cwiseMax(turns.col(static_cast<Eigen::Index>(i)).cwiseAbs());
  }
  for (int axis : task.axes) stray[axis] = 0;
  task.pure = stray.maxCoeff() < 1e-8;
  if (task.rotations != 1) return;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(turns, Eigen::ComputeThinU);
  const bool fixed = turns.cols() < 2 || svd.singularValues()[1] < 1e-8;
  if (!fixed) return;
  task.rotation_axis = svd.matrixU().col(0);
  int largest = 0;
  task.rotation_axis.cwiseAbs().maxCoeff(&largest);
  if (task.rotation_axis[largest] < 0) task.rotation_axis = -task.rotation_axis;
}

/// Whether the platform can move finitely from home although all drives are held.
/// Generic postures do not show it: equal parallel legs, for example, let go at
/// home only.
void Analysis::look_for_self_motion() {
  if (report_.home_locked_platform == 0) return;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(home_locked_.platform, Eigen::ComputeFullV);
  const int count = report_.home_locked_platform;
  for (int attempt = 0; attempt < 2 * count + 8 && !self_motion_; ++attempt) {
    Eigen::VectorXd mix = Eigen::VectorXd::Zero(svd.matrixV().cols());
    if (attempt < 2 * count)
      mix[attempt / 2] = attempt % 2 == 0 ? 1 : -1;
    else
      mix.head(count) = random_direction(random_, count);
    const Eigen::VectorXd along = home_locked_.kernel * (svd.matrixV() * mix);
    Posture posture = home_;
    bool moving = true;
    for (int i = 0; i < 2 && moving; ++i)
      moving = step_along(model_, posture, passive_, tangent(model_, posture, passive_, along),
                          options_.step);
    self_motion_ =
        moving &&
        displacement(model_, home_, posture, model_.mechanism.platform) > kMoved * options_.step &&
        freedoms_at(model_, posture, passive_).platform_rank.rank > 0;
  }
}

void Analysis::decide() {
  auto& reasons = report_.reasons;
  if (report_.platform_dof == 0) {
    report_.verdict = Verdict::rigid;
    reasons.push_back(
        report_.home > 0
            ? fmt::format(
                  "The platform cannot move: the {} instantaneous freedom(s) at home do not "
                  "continue into a finite motion.",
                  report_.home)
            : "The platform cannot move: the loop-closure Jacobian at home has full column rank.");
  } else if (report_.locked_platform > 0) {
    report_.verdict = Verdict::uncertain;
    reasons.push_back(
        fmt::format("With all {} drives held the platform keeps {} freedom(s) at generic postures.",
                    report_.drives, report_.locked_platform));
  } else if (self_motion_) {
    report_.verdict = Verdict::uncertain;
    reasons.push_back(
        "With all drives held at home the platform can still move: a finite self-motion passes "
        "through home, although generic postures are held.");
  } else if (report_.home > report_.finite && branching_) {
    report_.verdict = Verdict::uncertain;
    reasons.push_back(
        fmt::format("Home is a constraint singularity: {} freedoms there, {} on the motion "
                    "branches, {} of which meet at home; "
                    "the drives do not decide which one is taken.",
                    report_.home, report_.finite, branches_.size()));
  } else if (report_.home_locked_platform > 0) {
    report_.verdict = Verdict::singular_home;
    reasons.push_back(
        fmt::format("Home is an actuation singularity: with the drives held the platform keeps {} "
                    "instantaneous freedom(s) there; generic postures are held.",
                    report_.home_locked_platform));
  } else if (report_.surplus > 0) {
    report_.verdict = Verdict::overdriven;
    reasons.push_back(
        fmt::format("{} drives control {} freedom(s): {} too many, which work against each other.",
                    report_.drives, report_.finite - report_.locked_mobility, report_.surplus));
  } else {
    report_.verdict = Verdict::determinate;
    reasons.push_back(
        fmt::format("The {} drives hold the platform's {} freedom(s) ({}) at home and at generic "
                    "postures.",
                    report_.drives, report_.platform_dof, report_.axes));
  }
  if (report_.redundant_constraints > 0)
    reasons.push_back(
        fmt::format("{} constraint(s) are redundant: the machine moves only as far as its axes are "
                    "exactly parallel or intersecting as drawn.",
                    report_.redundant_constraints));
  if (report_.rank_gap < kDoubtfulGap)
    reasons.push_back(
        fmt::format("A rank decision rests on a gap of only {:.3g}; treat the verdict with care.",
                    report_.rank_gap));
}

/// Finite motion where there is one, else the first-order one, for drawing.
std::vector<std::vector<Transform>> Analysis::animate(const Posture& at,
                                                      const std::vector<int>& active,
                                                      const Eigen::VectorXd& along) const {
  constexpr int kFrames = 10;
  constexpr double kStep = 0.04;
  std::deque<std::vector<Transform>> frames{at.bodies};
  for (int side : {1, -1}) {
    Posture posture = at;
    for (int i = 1; i <= kFrames; ++i) {
      if (!step_along(model_, posture, active, tangent(model_, posture, active, side * along),
                      kStep))
        break;
      if (displacement(model_, at, posture) < kMoved * kStep * i) break;
      if (side > 0)
        frames.push_back(posture.bodies);
      else
        frames.push_front(posture.bodies);
    }
  }
  if (frames.size() == 1) {
    // Infinitesimal only: show the first-order motion, loops slightly open.
    for (int i = 1; i <= kFrames; ++i)
      for (int side : {1, -1}) {
        Posture posture = at;
        Eigen::VectorXd increments =
            Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model_.freedoms.size()));
        increments(active) = side * i * kStep / 4 * along / along.cwiseAbs().maxCoeff();
        advance(model_, posture, increments.cwiseProduct(freedom_scale(model_)));
        if (side > 0)
          frames.push_back(posture.bodies);
        else
          frames.push_front(posture.bodies);
      }
  }
  return {frames.begin(), frames.end()};
}

void Analysis::add_mode(const std::string& about, const Posture& at, const Freedoms& freedoms,
                        const std::vector<int>& active) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(freedoms.platform, Eigen::ComputeFullV);
  for (int i = 0; i < freedoms.platform_rank.rank; ++i) {
    FreedomMode mode;
    const Eigen::VectorXd mix = svd.matrixV().col(i);
    const Eigen::VectorXd along = freedoms.kernel * mix;
    const Screw at_tool = freedoms.platform * mix;
    const Vector3 tool = at.bodies[model_.mechanism.platform] * model_.mechanism.tool;
    mode.twist.head<3>() = at_tool.head<3>();
    mode.twist.tail<3>() = at_tool.tail<3>() * model_.size - at_tool.head<3>().cross(tool);
    mode.about = about + describe_twist(mode.twist);
    mode.frames = animate(at, active, along);
    report_.modes.push_back(std::move(mode));
  }
}

void Analysis::collect_evidence() {
  if (!options_.evidence) return;
  if (report_.verdict == Verdict::uncertain || report_.verdict == Verdict::singular_home) {
    if (report_.home_locked_platform > 0)
      add_mode("with drives held at home: ", home_, home_locked_, passive_);
    else if (report_.locked_platform > 0)
      add_mode("with drives held at a generic posture: ", *main_->at, main_->locked, passive_);
    else
      add_mode("at home, where branches meet: ", home_, home_free_, all_);
  }
  if (main_ && report_.idle > 0) name_idle_rods();
}

/// Bodies that move although the platform rests: the kernel of the platform's
/// twist within the freedoms.
void Analysis::name_idle_rods() {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(main_->free.platform, Eigen::ComputeFullV);
  const Eigen::MatrixXd idle = freedom_scale(model_).asDiagonal() * main_->free.kernel *
                               svd.matrixV().rightCols(report_.idle);
  const Eigen::MatrixXd screws = freedom_screws(model_, *main_->at);
  for (int body = 0; body < static_cast<int>(model_.mechanism.bodies.size()); ++body)
    if ((body_jacobian(model_, screws, body) * idle).norm() > 1e-6)
      report_.idle_rods.push_back(model_.mechanism.bodies[body]);
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

MobilityReport analyse_mobility(const Model& model, const MobilityOptions& options) {
  Analysis analysis(model, options);
  analysis.look_at_home();
  analysis.explore_branches();
  analysis.choose_main_branch();
  analysis.look_for_self_motion();
  analysis.decide();
  analysis.collect_evidence();
  return analysis.take();
}

nlohmann::ordered_json to_json(const MobilityReport& report, const Mechanism& mechanism) {
  nlohmann::ordered_json json;
  json["name"] = mechanism.name;
  json["verdict"] = to_string(report.verdict);
  json["reasons"] = report.reasons;
  json["mobility"] = {{"home", report.home},
                      {"finite", report.finite},
                      {"kutzbach", report.kutzbach},
                      {"redundant_constraints", report.redundant_constraints},
                      {"idle", report.idle}};
  json["platform"] = {
      {"dof", report.platform_dof},           {"translations", report.task.translations},
      {"rotations", report.task.rotations},   {"pattern", report.pattern},
      {"home_dof", report.platform_home_dof}, {"axes", report.axes}};
  json["drives"] = {{"count", report.drives},
                    {"locked_mobility", report.locked_mobility},
                    {"locked_platform", report.locked_platform},
                    {"home_locked_platform", report.home_locked_platform},
                    {"surplus", report.surplus}};
  json["rank_gap"] = report.rank_gap;
  json["margin"] = report.margin;
  json["branches"] = nlohmann::ordered_json::array();
  for (const auto& branch : report.branches)
    json["branches"].push_back({{"dimension", branch.dimension}, {"pattern", branch.pattern}});
  json["idle_rods"] = report.idle_rods;
  json["modes"] = nlohmann::ordered_json::array();
  for (const FreedomMode& mode : report.modes)
    json["modes"].push_back({{"about", mode.about},
                             {"twist", std::vector<double>(mode.twist.begin(), mode.twist.end())}});
  return json;
}

}  // namespace polyglide
