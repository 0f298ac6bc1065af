#pragma once

#include <array>
#include <functional>
#include <map>
#include <vector>

namespace polyglide {

/// Border between two classes of nodes on a grid of squares, as chains of points in node units.
struct Contour {
  std::vector<std::array<double, 2>> points;
  bool closed = false;
};

/// An edge of the grid with a border on it, as its two nodes; the first is of class 1.
struct CrossedEdge {
  std::array<double, 2> one{}, other{};
};

/// Marching squares (Lorensen, Cline 1987, in the plane). Classes: 0, 1, or anything else for
/// nodes that are not known; a cell with one of those is passed over. Where a cell is crossed twice
/// its two class 1 corners are kept apart.
/// @param classes row by row, `width` nodes each
/// @param locate moves the points: `one` of each edge to the border. Called once with all edges.
[[nodiscard]] std::vector<Contour> contours(
    const std::vector<signed char>& classes, int width,
    const std::function<void(std::vector<CrossedEdge>&)>& locate);

/// Two neighbouring nodes of a grid, by their numbers row by row; the first is the lesser.
using GridEdge = std::array<std::size_t, 2>;

/// Chains of points that are known on edges: the points of a cell with two of them belong
/// together, and of one with four those of its first two sides and those of the others.
/// @param points on edges, in node units
[[nodiscard]] std::vector<Contour> contours_through(
    const std::map<GridEdge, std::array<double, 2>>& points, int width, int height);

}  // namespace polyglide
