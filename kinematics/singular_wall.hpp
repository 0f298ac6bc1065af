#pragma once

#include "kinematics/region.hpp"

namespace polyglide {

/// A plane that separates without a change of sign: det J is not negative on both sides of where
/// two of its factors vanish at once, as when all rods of a machine that can tilt lie flat. Found,
/// not proved: in places spread over the grid, along its lines, 1/κ falls to zero on both sides
/// and those places lie in one plane, on which J is singular wherever else it was asked. nullopt
/// where they do not (as with two such planes), where there are fewer than eight, with fewer than
/// two translations, or where J is not square. @param answers of the nodes. Cost: some 1e4 poses
/// where there may be one, without closed form some 1e3; else nothing.
[[nodiscard]] std::optional<SingularWall> find_singular_wall(const Probe& probe,
                                                             const NodeGrid& grid,
                                                             const Probe::Answers& answers);

}  // namespace polyglide
