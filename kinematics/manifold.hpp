#pragma once

#include <functional>
#include <vector>

#include "kinematics/model.hpp"

namespace polyglide {

/// [sizes of the machine, or rad] No posture is sought farther than this: the steps to it have an
/// end.
constexpr double kFarthestWay = 1e4;

/// Newton's method gives up after so many iterations.
constexpr int kMostIterations = 40;

/// How far drives are from other positions: the most moved one counts [sizes of the machine, or
/// rad].
[[nodiscard]] double drive_distance(const Model& model, const Eigen::VectorXd& from,
                                    const Eigen::VectorXd& to);

/// Freedoms that may move: all of them, or all but the drives.
[[nodiscard]] std::vector<int> all_freedoms(const Model& model);
[[nodiscard]] std::vector<int> passive_freedoms(const Model& model);

/// The columns of `matrix` that belong to `active` freedoms.
[[nodiscard]] Eigen::MatrixXd columns(const Eigen::MatrixXd& matrix,
                                      const std::vector<int>& active);

/// Why a projection stopped and what it left.
struct Projection {
  bool closed = false;
  double residual = 0;  ///< largest closure error [rad, or length/size]
  int iterations = 0;
  bool linear = false;  ///< it crept up on the end: a double zero, or noise of a drawing
};

/// A demand beside loop closure: appends its scaled residual and the rows of its
/// derivative by all freedoms (scaled), given the screws of the posture.
struct Demand {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
};
using Goal = std::function<Demand(const Posture& posture, const Eigen::MatrixXd& screws)>;

/// Pulls a posture back onto the constraint manifold by moving `active`
/// freedoms as little as possible: Newton with damped normal equations
/// (J Jᵀ + λ) y = -r, δ = Jᵀ y, which redundant constraints do not disturb
/// because Jᵀ annihilates whatever λ cannot resolve.
/// Closed means to 1e-7, which is what a nine-digit drawing with redundant constraints allows;
/// exact data closes to rounding. Gives up after 40 iterations.
/// With a goal: onto the part of the manifold where the goal holds too.
[[nodiscard]] Projection project(const Model& model, Posture& posture,
                                 const std::vector<int>& active, const Goal& goal = {});

/// Takes a closed posture as near to a double zero of the loops' closure as rounding allows
/// (1e-8 where the closure error is 1e-16): Newton's method comes nearer by halves only, and leaves
/// the rank there in doubt. Returns the closure error left.
double polish(const Model& model, Posture& posture, const std::vector<int>& active);

/// The part of `direction` (scaled, one entry per active freedom) that keeps the
/// loops closed to first order, with its largest entry scaled to 1; zero when
/// nothing of it does.
[[nodiscard]] Eigen::VectorXd tangent(const Model& model, const Posture& posture,
                                      const std::vector<int>& active,
                                      const Eigen::VectorXd& direction);

/// Moves `length` along a tangent [rad, or length/size of the fastest joint] and pulls back
/// onto the manifold across it, so that the way made along the tangent stays made: a
/// freedom that does not continue ends unclosed instead of back where it began.
/// The posture is unchanged when the loops cannot be closed again within so many iterations at
/// `most`.
[[nodiscard]] Projection step_along(const Model& model, Posture& posture,
                                    const std::vector<int>& active, const Eigen::VectorXd& tangent,
                                    double length, int most = kMostIterations);

/// Largest displacement between two postures, of any body or of one:
/// rotation [rad] or translation/size.
[[nodiscard]] double displacement(const Model& model, const Posture& a, const Posture& b);
[[nodiscard]] double displacement(const Model& model, const Posture& a, const Posture& b, int body);

}  // namespace polyglide
