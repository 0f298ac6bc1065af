#pragma once

#include <array>
#include <functional>
#include <vector>

// Where something that is never negative touches zero: 1/κ on a singular surface across which det J
// keeps its sign.
namespace polyglide {

/// Whether four values on a line look like the two sides of a V whose bottom, at zero, is between
/// the second and the third. @param steps between those two, where one between the others.
/// Straight falls meet in a point; that they bend by half a step is allowed.
[[nodiscard]] bool is_dip(double before, double near, double far, double beyond, double steps = 1);

struct Bottom {
  double at = 0;      ///< part of the way, in [0, 1]
  double height = 0;  ///< the least that was met
};

/// The lowest points of functions on [0, 1] that fall and then rise, by golden sections of all
/// together. @param heights of two ways for each function. Cost: 60 calls.
[[nodiscard]] std::vector<Bottom> bottoms(
    std::size_t count,
    const std::function<std::vector<double>(const std::vector<double>& ways)>& heights);

/// Two neighbouring nodes of a grid, by their numbers row by row; the first is the lesser.
using GridEdge = std::array<std::size_t, 2>;

/// Edges of a grid with a dip and no change of sign. @param heights row by row, `width` each; not a
/// number where there is none.
[[nodiscard]] std::vector<GridEdge> dips_of(const std::vector<double>& heights,
                                            const std::vector<signed char>& signs, int width);

/// Classes 0 and 1 of the nodes of a grid, different over the edges that are `crossed` and equal
/// over the others; 2 where there is no height.
[[nodiscard]] std::vector<signed char> classes_apart(const std::vector<double>& heights, int width,
                                                     const std::vector<GridEdge>& crossed);

}  // namespace polyglide
