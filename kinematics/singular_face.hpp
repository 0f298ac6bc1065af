#pragma once

#include "kinematics/box_limits.hpp"

namespace polyglide {

/// The sign that det J must have as a limit that is cut by a plane, at places of a cuboid, with
/// the angles zero: where a bound of the value is <= 0, det J is not zero and its sign is `side`.
///
/// With the singular vectors of J in the middle as U and V, UᵀJV is nearly diagonal; where its
/// last entry alone may be zero, elimination of the others leaves one number of the sign of det J,
/// and its slope. Square J. Needs UpwardRounding.
/// nullopt where more than one singular value may be zero, or a rod be at the end of its reach, or
/// how J changes is not known.
[[nodiscard]] std::optional<PlaneBound> singular_face(const BoxLimits& limits, const PoseBox& box,
                                                      const Cuboid& cuboid, int side);

}  // namespace polyglide
