#pragma once

#include <optional>

#include "kinematics/legs.hpp"

namespace polyglide {

/// The two legs of a five-bar: rods on driven cranks or carriages, in one plane, that meet in a hinge at
/// the tool. One of the rods is the platform, so this is no LegMachine for poses; but where the
/// tool gets is decided by its legs alone. nullopt for any other machine, and where limits concern
/// more than the drives.
[[nodiscard]] std::optional<LegMachine> point_legs(const Model& model);

}  // namespace polyglide
