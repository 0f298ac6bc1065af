#include "kinematics/branches.hpp"

#include <algorithm>
#include <optional>

#include "kinematics/manifold.hpp"
#include "kinematics/second_order.hpp"

namespace polyglide {
namespace {

constexpr double kShort = 0.03;     // first step: tangents still tell branches apart
constexpr double kStraight = 0.15;  // of a step: a smooth manifold leaves its tangent no further
constexpr int kQuick = 10;  // Newton iterations; more after a short step mean that it ended where
                            // a freedom that does not continue is still instantaneous
constexpr double kClear = 1e5;         // a rank gap below it tells no shaky freedoms
constexpr double kPolished = 0.1;      // of a closure error: less is left at a double zero only
constexpr double kCrossed = 0.4;       // of a long step
constexpr double kTurned = 0.6;        // sine of the angle a tangent space turns on a long step
constexpr double kNearSingular = 0.1;  // of the smallest pivot one step before
constexpr double kSameBranch = 0.35;   // sine of the angle between tangent spaces, 20 degrees
constexpr double kLong = 0.2;          // a leap, where short steps show nothing
constexpr double kNearlyClosed = 1e-7;
constexpr double kLeapt = 0.3;     // of a leap: a posture nearer to home has fallen back
constexpr std::size_t kTries = 3;  // members of a component of directions that are tried

/// What a step may be like: any that closes, one that does not bend much, or one as on smooth
/// manifolds, straight and with Newton's method back at once.
enum class Way { any, gentle, straight };

/// Whether the sine of the largest angle from the smaller space to the larger is above a limit.
bool apart(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double limit) {
  const Eigen::MatrixXd small = orthonormal(a.cols() <= b.cols() ? a : b);
  const Eigen::MatrixXd large = orthonormal(a.cols() <= b.cols() ? b : a);
  const Eigen::MatrixXd rest = small - large * (large.transpose() * small);
  // The norm of all bounds the largest singular value, and mostly settles it.
  return rest.norm() > limit && singular_values(rest)[0] > limit;
}

/// A random mixture of all columns in which none is weak, so that a freedom that does not continue
/// is felt.
Eigen::VectorXd even_mixture(const Eigen::MatrixXd& kernel, std::mt19937_64& random) {
  Eigen::VectorXd weights = random_direction(random, kernel.cols());
  for (double& weight : weights) weight = std::copysign(0.5 + std::abs(weight) / 2, weight);
  return kernel * weights;
}

class Explorer {
 public:
  Explorer(const Model& model, const Posture& home, bool held, const WalkOptions& options,
           std::mt19937_64& random)
      : model_(model),
        home_(home),
        held_(held),
        options_(options),
        random_(random),
        active_(held ? passive_freedoms(model) : all_freedoms(model)) {}

  Departure leave(const Eigen::MatrixXd& kernel);
  bool go_on(Place& place);

 private:
  /// The active freedoms' part of scaled rates that keep the loops closed, the fastest 1; zero
  /// when there is none.
  [[nodiscard]] Eigen::VectorXd paced(const Eigen::VectorXd& rates) const;
  /// A step along scaled rates of all freedoms, out of the kernel there; false, and the posture
  /// unchanged, when there is no such way.
  bool step(Posture& posture, const Eigen::VectorXd& rates, double length, Way way);
  bool closes(const Projection& projection);
  [[nodiscard]] Place screened(Posture posture) const;
  [[nodiscard]] Eigen::MatrixXd kernel_of(const Freedoms& free) const;
  bool wander(Place& place, double length, Certainty certainty);
  bool leap(Posture& posture, const Eigen::VectorXd& rates);
  bool leave_smoothly(const Eigen::MatrixXd& kernel);
  [[nodiscard]] std::vector<Eigen::VectorXd> translations(const Eigen::MatrixXd& kernel);
  std::optional<Place> near_home(const Eigen::VectorXd& rates);
  void leave_along(const Eigen::MatrixXd& kernel, const std::vector<Eigen::VectorXd>& component);
  void leap_along(const Eigen::MatrixXd& kernel, const std::vector<Eigen::VectorXd>& component);
  void leave_by_second_order(const Eigen::MatrixXd& kernel);
  void meet(const Place& near);
  bool is_shaky(Branch& branch, const Place& near);
  bool walk_far(Branch& branch, const Place& near);

  const Model& model_;
  const Posture& home_;
  bool held_;
  WalkOptions options_;
  std::mt19937_64& random_;
  std::vector<int> active_;
  Eigen::Index at_home_ = 0;  ///< instantaneous freedoms there
  bool slow_ = false;    ///< a step ended where a freedom that does not continue is instantaneous
  bool nearly_ = false;  ///< a way was turned down that closes nearly
  Departure result_;
};

Eigen::VectorXd Explorer::paced(const Eigen::VectorXd& rates) const {
  const Eigen::VectorXd along = rates(active_);
  const double fastest = along.size() > 0 ? along.cwiseAbs().maxCoeff() : 0;
  if (fastest < 1e-7) return Eigen::VectorXd::Zero(along.size());
  return along / fastest;
}

bool Explorer::step(Posture& posture, const Eigen::VectorXd& rates, double length, Way way) {
  const Eigen::VectorXd along = paced(rates);
  if (along.isZero()) return false;
  Posture straight = posture;
  Eigen::VectorXd increments = Eigen::VectorXd::Zero(rates.size());
  increments(active_) = length * along;
  advance(model_, straight, increments.cwiseProduct(freedom_scale(model_)));
  Posture there = posture;
  const int patience = way == Way::straight ? kQuick + 1 : kMostIterations;
  const Projection projection = step_along(model_, there, active_, along, length, patience);
  bool slow = projection.iterations > kQuick;
  if (!closes(projection) || (slow && way == Way::straight)) return false;
  const double most = way == Way::straight ? kStraight : kCrossed;
  if (way != Way::any && displacement(model_, straight, there) > most * length) return false;
  if (slow || projection.linear)
    slow = polish(model_, there, active_) < kPolished * projection.residual || slow;
  if (slow && way == Way::straight) return false;
  slow_ = slow_ || slow;
  posture = std::move(there);
  result_.residual = std::max(result_.residual, projection.residual);
  return true;
}

bool Explorer::closes(const Projection& projection) {
  const bool closed = projection.residual <= options_.closure;
  nearly_ = nearly_ || (!closed && projection.residual < kNearlyClosed);
  return closed;
}

Place Explorer::screened(Posture posture) const {
  Freedoms free = freedoms_at(model_, posture, Certainty::screened);
  return {std::move(posture), std::move(free)};
}

Eigen::MatrixXd Explorer::kernel_of(const Freedoms& free) const {
  return held_ ? hold_drives(model_, free).kernel : free.kernel;
}

Eigen::MatrixXd side_by_side(const std::vector<Eigen::VectorXd>& directions) {
  Eigen::MatrixXd all(directions.front().size(), directions.size());
  for (std::size_t i = 0; i < directions.size(); ++i)
    all.col(static_cast<Eigen::Index>(i)) = directions[i];
  return all;
}

constexpr double kInSpan = 1e-3;  // of a unit direction: less is the softness of double zeros

Eigen::Index span_of(const std::vector<Eigen::VectorXd>& directions) {
  return (singular_values(side_by_side(directions)).array() > kInSpan).count();
}

/// The freedoms of a branch that continue, where fewer do than there are at every posture of it.
void find_span(Branch& branch, const std::vector<Eigen::VectorXd>& directions) {
  const Svd svd = svd_of(side_by_side(directions));
  const int rank = static_cast<int>((svd.values.array() > kInSpan).count());
  branch.excess = static_cast<int>(branch.near_kernel.cols()) - rank;
  if (branch.excess > 0) branch.span = svd.u.leftCols(rank);
}

/// A step along a random freedom, shortened where the long one leaves what closes or may
/// have crossed to another branch: there the way bends or the tangent space turns at once, or has
/// another dimension. Keeps away from singular postures, where branches meet and counts waver.
bool Explorer::wander(Place& place, double length, Certainty certainty) {
  const Eigen::MatrixXd kernel = kernel_of(place.free);
  const Eigen::VectorXd rates = kernel * random_direction(random_, kernel.cols());
  for (int halving = 0; halving < 4; ++halving, length /= 2) {
    Posture posture = place.posture;
    if (!step(posture, rates, length, Way::gentle)) continue;
    Freedoms free = freedoms_at(model_, posture, certainty);
    if (free.pivot < kNearSingular * place.free.pivot) continue;
    const Eigen::MatrixXd there = kernel_of(free);
    if (there.cols() != kernel.cols() || apart(kernel, there, kTurned)) continue;
    place = {std::move(posture), std::move(free)};
    return true;
  }
  return false;
}

/// Where a random step does not go straight on, some freedoms are never more than instantaneous,
/// and second order counts the rest.
bool Explorer::is_shaky(Branch& branch, const Place& near) {
  if (near.free.rank.gap < kClear) return false;
  Posture posture = near.posture;
  if (step(posture, even_mixture(branch.near_kernel, random_), kShort, Way::straight)) return false;
  const SecondOrder allowed =
      second_order(model_, near.posture, branch.near_kernel, active_, random_);
  std::vector<Eigen::VectorXd> directions;
  for (const auto& component : allowed.components)
    directions.insert(directions.end(), component.begin(), component.end());
  if (!directions.empty()) find_span(branch, directions);
  if (branch.excess > 0) branch.far = {{near.posture, freedoms_at(model_, near.posture)}};
  return branch.excess > 0;
}

/// From a short step away to generic postures; whether any walk got on. A freedom that does not
/// continue may show only far from home, where Newton's method then creeps up on the postures.
bool Explorer::walk_far(Branch& branch, const Place& near) {
  bool moved = false;
  slow_ = false;
  for (int walk = 0; walk < options_.walks; ++walk) {
    branch.far.push_back(near);
    moved = go_on(branch.far.back()) || moved;
  }
  if (!slow_) return moved;
  const Place& last = branch.far.back();
  Branch shaky{kernel_of(last.free), {}, {}, 0};
  if (is_shaky(shaky, last)) branch = std::move(shaky);
  return moved;
}

/// Postures on the way are screened; the counts of the last are confirmed.
bool Explorer::go_on(Place& place) {
  int left = options_.steps;
  while (left > 0 &&
         wander(place, options_.step, left == 1 ? Certainty::confirmed : Certainty::screened))
    --left;
  if (left > 0) place.free = freedoms_at(model_, place.posture);
  return left < options_.steps || options_.steps == 0;
}

bool Explorer::leave_smoothly(const Eigen::MatrixXd& kernel) {
  for (const double length : {kShort, kShort / 4}) {
    Posture posture = home_;
    if (!step(posture, even_mixture(kernel, random_), length, Way::straight)) continue;
    const Place near = screened(std::move(posture));
    Branch branch{kernel_of(near.free), {}, {}, 0};
    if (branch.near_kernel.cols() != kernel.cols()) return false;
    // One mixture may happen to hold little of a freedom that does not continue.
    for (int more = 1; more < options_.walks; ++more) {
      Posture other = home_;
      if (!step(other, even_mixture(kernel, random_), length, Way::straight)) return false;
    }
    // Where no walk gets on, a condition of higher order was too small to be seen so close.
    if (!walk_far(branch, near)) return false;
    if (slow_) return false;
    result_.branches.push_back(std::move(branch));
    return true;
  }
  return false;
}

void Explorer::meet(const Place& near) {
  Branch branch{kernel_of(near.free), {}, {}, 0};
  const bool known = std::ranges::any_of(result_.branches, [&](const Branch& other) {
    return other.near_kernel.cols() == branch.near_kernel.cols() &&
           !apart(other.near_kernel, branch.near_kernel, kSameBranch);
  });
  if (known) return;
  const bool moves = is_shaky(branch, near) || walk_far(branch, near);
  // Closed by chance where home is singular to a high order, with counts that say nothing: were
  // there a branch with all of home's freedoms, walks would get on.
  const bool all = branch.near_kernel.cols() == at_home_;
  if (!moves && (all || near.free.rank.gap < kClear)) return;
  result_.branches.push_back(std::move(branch));
}

/// A long step whose end is pulled back onto the manifold wherever that is nearest: a way out
/// where conditions of higher order hide the direction of it.
bool Explorer::leap(Posture& posture, const Eigen::VectorXd& rates) {
  const Eigen::VectorXd along = paced(rates);
  if (along.isZero()) return false;
  Eigen::VectorXd increments = Eigen::VectorXd::Zero(rates.size());
  increments(active_) = kLong * along;
  Posture there = posture;
  advance(model_, there, increments.cwiseProduct(freedom_scale(model_)));
  const Projection projection = project(model_, there, active_);
  if (!closes(projection)) return false;
  if (projection.linear) polish(model_, there, active_);
  if (displacement(model_, posture, there) < kLeapt * kLong) return false;
  posture = std::move(there);
  return true;
}

/// Directions in which the platform does not turn. Where conditions of higher order hide the ways
/// out, a translation is the one that random directions hardly meet.
std::vector<Eigen::VectorXd> Explorer::translations(const Eigen::MatrixXd& kernel) {
  const Eigen::MatrixXd turning = platform_motion(model_, home_, kernel).topRows(3);
  const Eigen::MatrixXd basis = polyglide::kernel_of(turning, 1).basis;
  std::vector<Eigen::VectorXd> directions;
  for (std::size_t i = 0; i < kTries && basis.cols() > 0; ++i)
    directions.push_back((basis * random_direction(random_, basis.cols())).normalized());
  return directions;
}

/// A posture a short way off home in a direction. Where Newton's method only creeps up on it, the
/// conditions that stop a freedom are too weak there to be met well, and it is looked for farther
/// out.
std::optional<Place> Explorer::near_home(const Eigen::VectorXd& rates) {
  Posture near = home_, farther = home_;
  slow_ = false;
  if (!step(near, rates, kShort, Way::any)) return std::nullopt;
  if (slow_ && leap(farther, rates)) near = std::move(farther);
  return screened(std::move(near));
}

/// Along a few members of a component, each way, until one leads off: a cusp, for example, can be
/// left one way only.
void Explorer::leave_along(const Eigen::MatrixXd& kernel,
                           const std::vector<Eigen::VectorXd>& component) {
  for (std::size_t i = 0; i < std::min(kTries, component.size()); ++i) {
    for (const int side : {1, -1}) {
      const std::optional<Place> near = near_home(side * (kernel * component[i]));
      if (!near) continue;
      if (span_of(component) > kernel_of(near->free).cols()) result_.cone = true;
      return meet(*near);
    }
  }
}

void Explorer::leap_along(const Eigen::MatrixXd& kernel,
                          const std::vector<Eigen::VectorXd>& component) {
  for (std::size_t i = 0; i < std::min<std::size_t>(options_.leaps, component.size()); ++i)
    for (const int side : {1, -1}) {
      Posture near = home_;
      if (!leap(near, side * (kernel * component[i]))) continue;
      result_.blind = true;
      meet(screened(std::move(near)));
    }
}

/// Tries every component of the second-order solution. Where that sets no condition although home
/// is not smooth, or leads nowhere, conditions of higher order are at work and leaps have to find
/// the way.
void Explorer::leave_by_second_order(const Eigen::MatrixXd& kernel) {
  SecondOrder allowed = second_order(model_, home_, kernel, active_, random_);
  result_.obstructions = allowed.obstructions;
  result_.refuted = allowed.components.empty();
  if (slow_) allowed.components.push_back(translations(kernel));
  if (allowed.obstructions > 0)
    for (const auto& component : allowed.components) leave_along(kernel, component);
  if (!result_.branches.empty()) return;
  for (const auto& component : allowed.components) leap_along(kernel, component);
}

Departure Explorer::leave(const Eigen::MatrixXd& kernel) {
  if (kernel.cols() == 0) return {};
  at_home_ = kernel.cols();
  result_.smooth = leave_smoothly(kernel);
  if (!result_.smooth) {
    result_.branches.clear();
    leave_by_second_order(kernel);
  }
  // Second order leaves ways open, none of which closes well: nearly a motion. Better a doubtful
  // motion that is said to be so than a machine called rigid.
  const bool open = result_.branches.empty() && !result_.refuted;
  if (open && nearly_ && options_.closure < kNearlyClosed) {
    options_.closure = kNearlyClosed;
    result_ = leave(kernel);
    result_.smooth = false;
    result_.blind = true;
  }
  return std::move(result_);
}

}  // namespace

Departure leave(const Model& model, const Posture& home, const Eigen::MatrixXd& kernel, bool held,
                const WalkOptions& options, std::mt19937_64& random) {
  return Explorer(model, home, held, options, random).leave(kernel);
}

void walk_on(const Model& model, Place& place, const WalkOptions& options,
             std::mt19937_64& random) {
  const Posture start = place.posture;
  Explorer(model, start, false, options, random).go_on(place);
}

}  // namespace polyglide
