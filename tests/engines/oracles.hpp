#pragma once

#include "engines/counts.hpp"

namespace polyglide::engines {

/// What MuJoCo says at home, given the MJCF, with every equality active.
[[nodiscard]] Counts mujoco_counts(const Model& model);

/// What MuJoCo says at home, given the URDF, about the loops that its YAML lists.
[[nodiscard]] Counts urdf_counts(const Model& model);

/// What Simbody says at home, given the joint graph.
[[nodiscard]] Counts simbody_counts(const Model& model);

/// What MuJoCo says at any posture, given the MJCF.
[[nodiscard]] Counts mujoco_counts_at(const Model& model, const Posture& posture);

/// Loops closed to 1e-9 of the machine's size, and equal counts.
void expect_closed_and_equal(const Counts& found, const Counts& ours);

/// MuJoCo's counts at a posture must be those of our ranks there. Returns them.
Counts expect_agreement_at(const Model& model, const Posture& posture);

/// Some steps from home along the constraint manifold. False when the mechanism has not
/// moved: a step along an infinitesimal freedom cannot be closed again.
[[nodiscard]] bool walk(const Model& model, Posture& posture);

}  // namespace polyglide::engines
