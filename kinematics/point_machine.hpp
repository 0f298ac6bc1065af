#pragma once

#include <optional>

#include "kinematics/solve.hpp"

namespace polyglide {

/// A five-bar as a machine that moves a point: two rods on driven cranks or carriages, in one plane
/// along base axes, that meet in a hinge at the tool. One of the rods is the platform, which turns
/// as it must, so the machine as such has no pure task space. Here the platform is a body of its
/// own in that hinge, whose rotation is idle and is not counted: with it the rods are legs of a
/// closed form, and the task axes are the two of the plane. For workspaces; its poses say nothing
/// of the rotation. nullopt for any other machine, and where limits concern more than the drives.
[[nodiscard]] std::optional<Machine> point_machine(const Machine& machine);

}  // namespace polyglide
