#include "kinematics/branches.hpp"

#include <algorithm>

#include "kinematics/manifold.hpp"
#include "kinematics/second_order.hpp"

namespace polyglide {
namespace {

constexpr double kShort = 0.03;       // first step: tangents still tell branches apart
constexpr double kStraight = 0.3;     // of a step: a smooth manifold leaves its tangent no further
constexpr double kSameBranch = 0.35;  // sine of the angle between tangent spaces, 20 degrees
constexpr double kExplained = 0.26;   // sine of the angle from a direction to a known branch
constexpr int kMostFailures = 6;      // directions allowed by second order that lead nowhere

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
  void go_on(Posture& posture, Eigen::MatrixXd kernel);

 private:
  /// A step along scaled rates of all freedoms. How far the manifold was left of the
  /// straight way, as part of the step; negative when there was no way.
  double step(Posture& posture, const Eigen::VectorXd& rates, double length);
  [[nodiscard]] Eigen::MatrixXd kernel_at(const Posture& posture) const;
  bool leave_smoothly(const Eigen::MatrixXd& kernel);
  void leave_by_second_order(const Eigen::MatrixXd& kernel);
  void meet(Posture near);
  double wander(Posture& posture, const Eigen::MatrixXd& kernel, double length);
  bool is_shaky(Branch& branch, const Posture& near);
  void walk_far(Branch& branch, const Posture& near);

  const Model& model_;
  const Posture& home_;
  bool held_;
  const WalkOptions& options_;
  std::mt19937_64& random_;
  std::vector<int> active_;
  Departure result_;
};

double Explorer::step(Posture& posture, const Eigen::VectorXd& rates, double length) {
  const Eigen::VectorXd along = tangent(model_, posture, active_, rates(active_));
  if (along.isZero()) return -1;
  Posture straight = posture;
  Eigen::VectorXd increments = Eigen::VectorXd::Zero(rates.size());
  increments(active_) = length * along;
  advance(model_, straight, increments.cwiseProduct(freedom_scale(model_)));
  const Projection projection = step_along(model_, posture, active_, along, length);
  if (!projection.closed) return -1;
  result_.residual = std::max(result_.residual, projection.residual);
  return displacement(model_, straight, posture) / length;
}

Eigen::MatrixXd Explorer::kernel_at(const Posture& posture) const {
  const Freedoms free = freedoms_at(model_, posture);
  return held_ ? hold_drives(model_, free).kernel : free.kernel;
}

/// The freedoms of a branch that continue, where fewer do than there are at every posture of it.
void find_span(Branch& branch, const std::vector<Eigen::VectorXd>& directions) {
  Eigen::MatrixXd all(branch.near_kernel.cols(), directions.size());
  for (std::size_t i = 0; i < directions.size(); ++i)
    all.col(static_cast<Eigen::Index>(i)) = directions[i];
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(all, Eigen::ComputeThinU);
  const int rank = static_cast<int>((svd.singularValues().array() > 1e-3).count());
  branch.excess = static_cast<int>(branch.near_kernel.cols()) - rank;
  if (branch.excess > 0) branch.span = svd.matrixU().leftCols(rank);
}

/// A step along a random freedom, shortened when the long one leaves what closes.
double Explorer::wander(Posture& posture, const Eigen::MatrixXd& kernel, double length) {
  const Eigen::VectorXd rates = kernel * random_direction(random_, kernel.cols());
  double bend = step(posture, rates, length);
  for (int halving = 0; bend < 0 && halving < 3; ++halving)
    bend = step(posture, rates, length /= 2);
  return bend;
}

/// Where a random step does not go straight on, some freedoms are never more than instantaneous,
/// and second order counts the rest.
bool Explorer::is_shaky(Branch& branch, const Posture& near) {
  Posture posture = near;
  const double bend = wander(posture, branch.near_kernel, 2 * kShort);
  if (bend >= 0 && bend < kStraight) return false;
  const SecondOrder allowed = second_order(model_, near, branch.near_kernel, active_, random_);
  if (!allowed.directions.empty()) find_span(branch, allowed.directions);
  if (branch.excess > 0) branch.far = {near};
  return branch.excess > 0;
}

/// From a short step away to generic postures.
void Explorer::walk_far(Branch& branch, const Posture& near) {
  for (int walk = 0; walk < options_.walks; ++walk) {
    branch.far.push_back(near);
    go_on(branch.far.back(), branch.near_kernel);
  }
}

void Explorer::go_on(Posture& posture, Eigen::MatrixXd kernel) {
  for (int i = 0; i < options_.steps; ++i) {
    if (wander(posture, kernel, options_.step) < 0) return;
    if (i + 1 < options_.steps) kernel = kernel_at(posture);
  }
}

bool Explorer::leave_smoothly(const Eigen::MatrixXd& kernel) {
  for (const double length : {kShort, kShort / 4}) {
    Posture near = home_;
    const Eigen::VectorXd rates = kernel * random_direction(random_, kernel.cols());
    const double bend = step(near, rates, length);
    if (bend < 0 || bend > kStraight) continue;
    Eigen::MatrixXd near_kernel = kernel_at(near);
    if (near_kernel.cols() != kernel.cols()) return false;
    Branch branch{std::move(near_kernel), {}, {}, 0};
    walk_far(branch, near);
    result_.branches.push_back(std::move(branch));
    return true;
  }
  return false;
}

void Explorer::meet(Posture near) {
  Eigen::MatrixXd kernel = kernel_at(near);
  const bool known = std::ranges::any_of(result_.branches, [&](const Branch& branch) {
    return branch.near_kernel.cols() == kernel.cols() &&
           separation(branch.near_kernel, kernel) < kSameBranch;
  });
  if (known) return;
  Branch branch{std::move(kernel), {}, {}, 0};
  if (!is_shaky(branch, near)) walk_far(branch, near);
  result_.branches.push_back(std::move(branch));
}

void Explorer::leave_by_second_order(const Eigen::MatrixXd& kernel) {
  const SecondOrder allowed = second_order(model_, home_, kernel, active_, random_);
  result_.obstructions = allowed.obstructions;
  int failures = 0;
  for (const Eigen::VectorXd& direction : allowed.directions)
    for (const int side : {1, -1}) {
      const Eigen::VectorXd rates = side * (kernel * direction);
      const bool explained = std::ranges::any_of(result_.branches, [&](const Branch& branch) {
        return separation(rates, branch.near_kernel) < kExplained;
      });
      if (explained || failures >= kMostFailures) continue;
      Posture near = home_;
      if (step(near, rates, kShort) < 0)
        ++failures;
      else
        meet(std::move(near));
    }
}

Departure Explorer::leave(const Eigen::MatrixXd& kernel) {
  if (kernel.cols() == 0) return {};
  result_.smooth = leave_smoothly(kernel);
  if (!result_.smooth) {
    result_.branches.clear();
    leave_by_second_order(kernel);
  }
  return std::move(result_);
}

}  // namespace

Departure leave(const Model& model, const Posture& home, const Eigen::MatrixXd& kernel, bool held,
                const WalkOptions& options, std::mt19937_64& random) {
  return Explorer(model, home, held, options, random).leave(kernel);
}

void walk_on(const Model& model, Posture& posture, const WalkOptions& options,
             std::mt19937_64& random) {
  Explorer(model, posture, false, options, random)
      .go_on(posture, freedoms_at(model, posture).kernel);
}

}  // namespace polyglide
