#include "kinematics/manifold.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

#include "kinematics/rank.hpp"

namespace polyglide {
namespace {

constexpr double kClosed = 1e-12;      // aim; Newton's last step usually lands far below
constexpr double kCloseEnough = 1e-7;  // when Newton has stagnated: loops of a nine-digit drawing
                                       // with redundant constraints close no better
constexpr double kNear = 1e-6;  // residual from which the last linearisation takes Newton home
constexpr int kPolishes = 6;
constexpr double kSettled = 0.5;   // of the error before: polishing gains no more
constexpr double kNudge = 0.01;    // a polishing step: more is a drawing's noise taken for meaning
constexpr double kWeakest = 1e-9;  // of the largest pivot: less is rounding
constexpr double kLate = 1e-3;     // residual below which Newton at a regular posture at least
constexpr double kLinear = 0.05;   // divides it by twenty each time
constexpr int kPatience = 3;       // iterations without progress before Newton gives up
constexpr double kProgress = 0.7;  // part of the best residual so far that counts as progress
constexpr double kLongestStep = 0.6;  // [rad] of the fastest joint, keeps Newton on its branch

/// (J Jᵀ + λ)⁻¹ with λ far below any singular value that matters.
class DampedInverse {
 public:
  explicit DampedInverse(const Eigen::MatrixXd& jacobian) {
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(jacobian.rows(), jacobian.rows());
    gram.selfadjointView<Eigen::Lower>().rankUpdate(jacobian);  // all that the factor reads
    const double scale = gram.trace() / std::max<double>(1, static_cast<double>(gram.rows()));
    gram.diagonal().array() += 1e-11 * std::max(scale, 1e-6);
    factor_.compute(gram);
  }
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const {
    return factor_.solve(right);
  }

 private:
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

void move(const Model& model, Posture& posture, const std::vector<int>& active,
          const Eigen::VectorXd& scaled) {
  Eigen::VectorXd increments =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.freedoms.size()));
  for (std::size_t i = 0; i < active.size(); ++i)
    increments[active[i]] = scaled[static_cast<Eigen::Index>(i)] *
                            (model.freedoms[active[i]].translational ? model.size : 1);
  advance(model, posture, increments);
}

Demand loops_and(const Goal& goal, const Model& model, const Posture& posture) {
  const Eigen::MatrixXd screws = freedom_screws(model, posture);
  Demand loops{closure_residual(model, posture), closure_jacobian(model, screws)};
  if (!goal) return loops;
  const Demand more = goal(posture, screws);
  Demand both;
  both.residual.resize(loops.residual.size() + more.residual.size());
  both.residual << loops.residual, more.residual;
  both.jacobian.resize(both.residual.size(), screws.cols());
  both.jacobian << loops.jacobian, more.jacobian;
  return both;
}

/// A demand's derivative by the active freedoms only, with a row for none of their motion along
/// `pin`.
Eigen::MatrixXd restricted(Eigen::MatrixXd jacobian, const std::vector<int>& active,
                           const Eigen::VectorXd* pin) {
  if (static_cast<Eigen::Index>(active.size()) < jacobian.cols())
    jacobian = columns(jacobian, active);
  if (pin == nullptr) return jacobian;
  jacobian.conservativeResize(jacobian.rows() + 1, Eigen::NoChange);
  jacobian.bottomRows<1>() = pin->transpose();
  return jacobian;
}

/// One linearisation of what is demanded: the way of least motion that meets a residual.
class Linearised {
 public:
  explicit Linearised(Eigen::MatrixXd jacobian)
      : jacobian_(std::move(jacobian)), inverse_(jacobian_) {}
  [[nodiscard]] Eigen::VectorXd step_for(const Eigen::VectorXd& residual) const {
    return -jacobian_.transpose() * inverse_.solve(residual);
  }

 private:
  Eigen::MatrixXd jacobian_;
  DampedInverse inverse_;
};

/// Newton by damped normal equations; with a pin only across it.
Projection pull_back(const Model& model, Posture& posture, const std::vector<int>& active,
                     const Goal& goal, const Eigen::VectorXd* pin, int most = kMostIterations) {
  Projection result;
  if (model.loop_joints.empty() && !goal) return {true, 0, 0};
  double best = std::numeric_limits<double>::infinity(), last = best;
  int idle = 0;
  std::optional<Linearised> linearised;
  for (;; ++result.iterations) {
    Demand demand =
        goal ? loops_and(goal, model, posture) : Demand{closure_residual(model, posture), {}};
    result.residual = demand.residual.lpNorm<Eigen::Infinity>();  // 0 when nothing is asked
    if (result.residual < kClosed || result.iterations == most || !(result.residual < 1e3)) break;
    result.linear = last < kLate && result.residual > kLinear * last;
    last = result.residual;
    idle = result.residual < kProgress * best ? 0 : idle + 1;
    best = std::min(best, result.residual);
    if (idle >= kPatience && (pin != nullptr || goal || best < kCloseEnough)) break;
    if (!linearised || result.residual > kNear || idle > 0) {
      if (!goal) demand.jacobian = closure_jacobian(model, posture);
      linearised.emplace(restricted(std::move(demand.jacobian), active, pin));
    }
    demand.residual.conservativeResize(demand.residual.size() + (pin != nullptr ? 1 : 0));
    if (pin != nullptr) demand.residual.tail<1>().setZero();
    Eigen::VectorXd step = linearised->step_for(demand.residual);
    const double fastest = step.size() > 0 ? step.cwiseAbs().maxCoeff() : 0;
    if (!(fastest > 1e-16)) break;
    if (fastest > kLongestStep) step *= kLongestStep / fastest;
    move(model, posture, active, step);
  }
  result.closed = result.residual < kCloseEnough;
  return result;
}

}  // namespace

double drive_distance(const Model& model, const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
  double farthest = 0;
  for (Eigen::Index d = 0; d < to.size(); ++d) {
    const double scale = model.freedoms[model.drives[d]].translational ? model.size : 1;
    farthest = std::max(farthest, std::abs(to[d] - from[d]) / scale);
  }
  return farthest;
}

std::vector<int> all_freedoms(const Model& model) {
  std::vector<int> active(model.freedoms.size());
  std::iota(active.begin(), active.end(), 0);
  return active;
}

std::vector<int> passive_freedoms(const Model& model) {
  std::vector<int> active;
  for (int f : all_freedoms(model))
    if (std::find(model.drives.begin(), model.drives.end(), f) == model.drives.end())
      active.push_back(f);
  return active;
}

Eigen::MatrixXd columns(const Eigen::MatrixXd& matrix, const std::vector<int>& active) {
  return matrix(Eigen::all, active);
}

Projection project(const Model& model, Posture& posture, const std::vector<int>& active,
                   const Goal& goal) {
  return pull_back(model, posture, active, goal, nullptr);
}

namespace {

/// The least motion of the active freedoms that meets the loops' closure error to first order, weak
/// directions included, which the damped normal equations leave out.
Eigen::VectorXd undamped_step(const Model& model, const Posture& posture,
                              const std::vector<int>& active) {
  return -least_squares(columns(closure_jacobian(model, posture), active),
                        closure_residual(model, posture), kWeakest);
}

}  // namespace

double polish(const Model& model, Posture& posture, const std::vector<int>& active) {
  if (model.loop_joints.empty()) return 0;
  double least = closure_residual(model, posture).cwiseAbs().maxCoeff();
  Posture trial = posture;
  for (int i = 0; i < kPolishes; ++i) {
    // Plain steps meet what Newton's method meets at once, doubled ones the double zeros.
    for (const double times : {1.0, 2.0, 1.0}) {
      const Eigen::VectorXd step = times * undamped_step(model, trial, active);
      if (!(step.norm() < kNudge)) return least;
      move(model, trial, active, step);
    }
    const double residual = closure_residual(model, trial).cwiseAbs().maxCoeff();
    if (!(residual < least)) break;
    const bool settled = residual > kSettled * least;
    least = residual;
    posture = trial;
    if (settled) break;
  }
  return least;
}

Eigen::VectorXd tangent(const Model& model, const Posture& posture, const std::vector<int>& active,
                        const Eigen::VectorXd& direction) {
  Eigen::VectorXd along = direction;
  if (!model.loop_joints.empty()) {
    const Eigen::MatrixXd jacobian = columns(closure_jacobian(model, posture), active);
    const DampedInverse inverse(jacobian);
    // Twice: the second pass removes what rounding and λ left of the first.
    for (int pass = 0; pass < 2; ++pass)
      along -= jacobian.transpose() * inverse.solve(jacobian * along);
  }
  const double fastest = along.size() > 0 ? along.cwiseAbs().maxCoeff() : 0;
  if (fastest < 1e-7 * direction.norm()) return Eigen::VectorXd::Zero(direction.size());
  return along / fastest;
}

Projection step_along(const Model& model, Posture& posture, const std::vector<int>& active,
                      const Eigen::VectorXd& tangent, double length, int most) {
  Posture trial = posture;
  move(model, trial, active, length * tangent);
  const Eigen::VectorXd pin = tangent.normalized();
  const Projection projection = pull_back(model, trial, active, {}, &pin, most);
  if (projection.closed) posture = std::move(trial);
  return projection;
}

double displacement(const Model& model, const Posture& a, const Posture& b, int body) {
  const Transform relative = a.bodies[body].inverse() * b.bodies[body];
  const Vector3 centre = a.bodies[body].inverse() * model.centre;
  return std::max(Eigen::AngleAxisd(relative.linear()).angle(),
                  (relative * centre - centre).norm() / model.size);
}

double displacement(const Model& model, const Posture& a, const Posture& b) {
  double largest = 0;
  for (int body = 0; body < static_cast<int>(model.mechanism.bodies.size()); ++body)
    largest = std::max(largest, displacement(model, a, b, body));
  return largest;
}

}  // namespace polyglide
