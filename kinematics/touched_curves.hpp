#pragma once

#include "kinematics/contours.hpp"

namespace polyglide {

/// Places of a grid, in node units, and what a function that is never negative is there.
using HeightsAt =
    std::function<std::vector<double>(const std::vector<std::array<double, 2>>& nodes)>;

/// Curves on which a function touches zero without a change of sign: on the lines of the grid,
/// where it falls to zero from both sides (dips), joined cell by cell. Curves that run along the
/// ends of what is known, closer than two nodes, are not seen there.
/// @param heights row by row, `width` each; not a number where there is none
/// @param signs of the nodes: dips between different ones are crossings, not touches
/// @param ask more heights. Cost: 120 of them for each dip.
[[nodiscard]] std::vector<Contour> touched_curves(const std::vector<double>& heights,
                                                  const std::vector<signed char>& signs, int width,
                                                  const HeightsAt& ask);

}  // namespace polyglide
