#pragma once

#include <functional>
#include <vector>

// Where something that is never negative touches zero: 1/κ on a singular surface across which det J
// keeps its sign.
namespace polyglide {

/// Whether four values on a line look like the two sides of a V whose bottom, at zero, is between
/// the second and the third. @param steps between those two, where one between the others.
/// Straight falls meet in a point; that they bend by half a step is allowed. A parabola that
/// touches zero counts, too: its root is such a V.
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

}  // namespace polyglide
