#pragma once

#include <optional>

#include "catalog/mechanism.hpp"

namespace polyglide {

/// The unit normal of the plane in which a mechanism moves: every joint is a hinge about it or a
/// slide across it. nullopt for other mechanisms, and for those without a hinge.
[[nodiscard]] std::optional<Vector3> plane_of_motion(const Mechanism& mechanism);

}  // namespace polyglide
