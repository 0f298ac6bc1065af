#pragma once

#include <random>

#include "kinematics/motion.hpp"

namespace polyglide {

/// How far and how often to walk along the constraint manifold.
struct WalkOptions {
  int walks = 2;       ///< generic postures to reach on every branch
  int steps = 2;       ///< long steps to each of them
  double step = 0.25;  ///< length of a long step [rad, or length/size of the fastest joint]
  double closure =
      1e-10;      ///< loop error that is still closed; more for a drawing that is not exact
  int leaps = 8;  ///< members of a component tried where short steps show no way out
};

/// A posture that was reached, and the freedoms there with nothing held.
struct Place {
  Posture posture;
  Freedoms free;
};

/// One motion branch through a posture.
struct Branch {
  Eigen::MatrixXd near_kernel;  ///< tangent space a short step away, freedoms × dimension
  std::vector<Place> far;       ///< generic postures on it
  Eigen::MatrixXd span;  ///< where freedoms never continue: coordinates within near_kernel of
                         ///< those that do; far is then that near posture. Else empty.
  int excess = 0;  ///< instantaneous freedoms everywhere on it that never continue (shakiness)
};

/// The ways in which a mechanism can leave a posture.
struct Departure {
  bool smooth = false;   ///< every instantaneous freedom continues: one branch
  int obstructions = 0;  ///< independent second-order conditions on the freedoms, when not smooth
  std::vector<Branch> branches;  ///< empty: it cannot move
  bool refuted = false;          ///< second order leaves no way out: it cannot move
  bool blind = false;   ///< not smooth although second order sets no condition: found by chance
  bool cone = false;    ///< the directions of one branch at home form a curved cone, not a plane
  double residual = 0;  ///< worst loop-closure error left at a posture reached
};

/// Finds the motion branches through `home` by short pinned steps: along a random
/// freedom first, and where that does not continue straight on with as many freedoms as at
/// home, along the freedoms that second order allows.
/// @param kernel freedoms at home (scaled rates) that may be used
/// @param held whether the drives are held
/// Each component of the second-order solution is met by about a dozen random starts; a branch
/// that none meets is not seen.
[[nodiscard]] Departure leave(const Model& model, const Posture& home,
                              const Eigen::MatrixXd& kernel, bool held, const WalkOptions& options,
                              std::mt19937_64& random);

/// Goes on along random freedoms for `options.steps` steps, or as far as the branch is not in
/// doubt.
void walk_on(const Model& model, Place& place, const WalkOptions& options, std::mt19937_64& random);

}  // namespace polyglide
