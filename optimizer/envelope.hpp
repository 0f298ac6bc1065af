#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "kinematics/solve.hpp"

namespace polyglide {

/// The space a machine takes up: the box, along base axes, around all its joint
/// points [m], where points on a carriage (a body that a driven slide joins to the
/// base) count at both ends of the stroke, and points on the platform, with the tool,
/// wherever `positions` and `turns` put it (tool displacements from home).
/// Strokes without an end count at home. A driven slide's own point is for drawing only
/// and does not count.
[[nodiscard]] Eigen::AlignedBox3d envelope(const Machine& machine,
                                           const std::vector<Vector3>& positions,
                                           const std::vector<Eigen::Quaterniond>& turns);

/// A box that holds every tool displacement from home [m] the machine can reach with
/// its platform unturned: the intersection over its legs of all places that a rod's
/// or strut's length and stroke allow. Empty when they leave none. Strokes without an
/// end, and machines without closed-form legs: twice the machine's size to each side.
[[nodiscard]] Eigen::AlignedBox3d reach_box(const Machine& machine);

}  // namespace polyglide
