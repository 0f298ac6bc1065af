#pragma once

#include <random>

#include "kinematics/model.hpp"

namespace polyglide {

/// What second order says about instantaneous freedoms at a posture.
struct SecondOrder {
  int obstructions = 0;  ///< independent quadratic conditions on the freedoms; 0 at a regular point
  /// Unit vectors over the freedoms given that satisfy all conditions, by solution
  /// component: one for each family of directions that turn into each other. Empty: none continues.
  std::vector<std::vector<Eigen::VectorXd>> components;
};

/// Looks for instantaneous freedoms that continue to second order.
///
/// Around a loop of screws S_i passed in turn, rates q̇ need accelerations q̈ with
/// Σ S_i q̈_i + Σ_{i<j} [S_i, S_j] q̇_i q̇_j = 0. They exist when the bracket sum vanishes on every
/// wrench that the loops' screws cannot resist (the left kernel of the Jacobian), which
/// gives as many quadratic forms in q̇. The zeros of a single form are known in closed form: two
/// planes or one cone. The common zeros of several are found by
/// Gauss-Newton from random starts: generic members of every solution component. Two belong to
/// one component when a way within the solutions leads from one to the other and the tangent
/// space turns with it, instead of jumping where components cross.
/// @param kernel freedoms × k, scaled rates: the instantaneous freedoms
/// @param active the freedoms that may accelerate (all, or the passive ones)
/// Source: Kieffer 1994, Differential analysis of bifurcations and isolated singularities for
/// robots and mechanisms; Wohlhart 1999, degrees of shakiness.
/// Cost: about 30 µs for 18×20 with at most one form, 0.1 ms or more with several.
[[nodiscard]] SecondOrder second_order(const Model& model, const Posture& posture,
                                       const Eigen::MatrixXd& kernel,
                                       const std::vector<int>& active, std::mt19937_64& random);

/// Entries uniform in [-1, 1]; own generator, so that a seed means the same everywhere.
[[nodiscard]] Eigen::VectorXd random_direction(std::mt19937_64& random, Eigen::Index size);

}  // namespace polyglide
