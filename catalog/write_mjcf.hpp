#pragma once

#include <string>

#include "catalog/mechanism.hpp"

namespace polyglide {

/// The mechanism as a MuJoCo model (MJCF, understood by MuJoCo 2.2 and later), assembled
/// at home, in metres and radians.
///
/// Bodies hang on the spanning tree, each at its joint's point and parallel to the base
/// frame. A revolute joint becomes a hinge, prismatic a slide, spherical a ball, universal
/// two hinges, cylindrical a hinge and a slide, planar two slides and a hinge, helical a
/// hinge and a slide coupled by an equality, weld nothing. Loops are closed by `connect` at passive
/// balls, elsewhere by `weld` to an extra body `<joint>.cut` that carries the joint's own
/// freedoms, so the rank of the constraints is that of the mechanism. Joints keep their
/// names (`<joint>.1`, `<joint>.2` where there are several freedoms) and ranges from home;
/// cones and half-space limits have no counterpart and are left out. Drives are position
/// actuators; the tool is the site `tool`. Masses are those of aluminium bars along the
/// lines between joints: good for a first simulation, not data of the machine. Nothing collides.
/// @throws std::invalid_argument when a body is not connected to the base.
[[nodiscard]] std::string to_mjcf(const Mechanism& mechanism);

}  // namespace polyglide
