#include "kinematics/region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinematics/singular_wall.hpp"

namespace polyglide {
namespace {

NodeGrid make_grid(const Probe& probe, const Bounds& box, int nodes) {
  NodeGrid grid;
  const Vector3 extent = box.upper - box.lower;
  double product = 1;
  const double smallest = std::max(extent.maxCoeff() * 1e-3, 1e-9);
  for (int k = 0; k < 3; ++k)
    if (probe.active()[k]) product *= std::max(extent[k], smallest);
  const int dimensions = probe.dimensions();
  grid.origin = box.lower;
  if (dimensions == 0) return grid;
  // In fewer than three dimensions the same fineness needs fewer nodes.
  grid.step = std::pow(product, 1.0 / dimensions) / std::cbrt(static_cast<double>(nodes));
  for (int k = 0; k < 3; ++k) {
    if (!probe.active()[k]) continue;
    grid.count[k] = 2 + static_cast<int>(extent[k] / grid.step);
    grid.origin[k] -= (grid.step * (grid.count[k] - 1) - extent[k]) / 2;
  }
  return grid;
}

Points nodes_of(const NodeGrid& grid) {
  Points points;
  points.reserve(grid.size());
  for (int k = 0; k < grid.count[2]; ++k)
    for (int j = 0; j < grid.count[1]; ++j)
      for (int i = 0; i < grid.count[0]; ++i) points.add(grid.at(i, j, k));
  return points;
}

/// Connected parts of the nodes inside, over faces and with equal orientation.
/// Returns the part of each node, -1 outside, and the parts' sizes.
std::vector<int> label(const NodeGrid& grid, const Probe::Answers& answers,
                       std::vector<int>& sizes) {
  std::vector<int> part(grid.size(), -1);
  std::vector<std::array<int, 3>> queue;
  const auto visit = [&](int i, int j, int k, int number, int orientation) {
    const std::size_t at = grid.index(i, j, k);
    if (part[at] >= 0 || !answers.inside(at) || answers.orientation[at] != orientation) return;
    part[at] = number;
    ++sizes[number];
    queue.push_back({i, j, k});
  };
  for (int k = 0; k < grid.count[2]; ++k)
    for (int j = 0; j < grid.count[1]; ++j)
      for (int i = 0; i < grid.count[0]; ++i) {
        const std::size_t start = grid.index(i, j, k);
        if (part[start] >= 0 || !answers.inside(start)) continue;
        const int number = static_cast<int>(sizes.size()), orientation = answers.orientation[start];
        sizes.push_back(0);
        visit(i, j, k, number, orientation);
        while (!queue.empty()) {
          const std::array<int, 3> node = queue.back();
          queue.pop_back();
          for (int axis = 0; axis < 3; ++axis)
            for (int way : {-1, 1}) {
              std::array<int, 3> next = node;
              next[axis] += way;
              if (next[axis] < 0 || next[axis] >= grid.count[axis]) continue;
              visit(next[0], next[1], next[2], number, orientation);
            }
        }
      }
  return part;
}

/// The part at a corner of home's cell, else the largest; -1 when there is none.
int choose_part(const NodeGrid& grid, const std::vector<int>& part, const std::vector<int>& sizes) {
  int chosen = -1;
  const auto consider = [&](int number) {
    if (number >= 0 && (chosen < 0 || sizes[number] > sizes[chosen])) chosen = number;
  };
  std::array<int, 3> low{};
  bool covered = true;
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.count[axis] == 1) continue;
    low[axis] = static_cast<int>(std::floor(-grid.origin[axis] / grid.step));
    covered = covered && low[axis] >= 0 && low[axis] < grid.count[axis] - 1;
  }
  for (int corner = 0; covered && corner < 8; ++corner) {
    std::array<int, 3> at = low;
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = std::min(low[axis] + (corner >> axis & 1), grid.count[axis] - 1);
    consider(part[grid.index(at[0], at[1], at[2])]);
  }
  if (chosen >= 0 || sizes.empty()) return chosen;
  return static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
}

void measure_extent(Region& region) {
  const double huge = std::numeric_limits<double>::infinity();
  region.extent = {Vector3::Constant(huge), Vector3::Constant(-huge)};
  for (int k = 0; k < region.grid.count[2]; ++k)
    for (int j = 0; j < region.grid.count[1]; ++j)
      for (int i = 0; i < region.grid.count[0]; ++i) {
        if (!region.inside[region.grid.index(i, j, k)]) continue;
        const Vector3 at = region.grid.at(i, j, k);
        region.extent.lower = region.extent.lower.cwiseMin(at);
        region.extent.upper = region.extent.upper.cwiseMax(at);
      }
}

/// Moves the sides of the box that the region touches outward, within `widest`. False when none is
/// moved.
bool make_room(Bounds& box, const Region& region, const Bounds& widest, double by) {
  const NodeGrid& grid = region.grid;
  const Vector3 first = grid.at(0, 0, 0),
                last = grid.at(grid.count[0] - 1, grid.count[1] - 1, grid.count[2] - 1);
  const Bounds before = box;
  for (int k = 0; k < 3; ++k) {
    if (grid.count[k] == 1) continue;
    if (region.extent.lower[k] <= first[k])
      box.lower[k] = std::max(widest.lower[k], box.lower[k] - by);
    if (region.extent.upper[k] >= last[k])
      box.upper[k] = std::min(widest.upper[k], box.upper[k] + by);
  }
  return box.lower != before.lower || box.upper != before.upper;
}

}  // namespace

Region explore(Probe& probe, const Bounds& box, int nodes) {
  Region region;
  region.grid = make_grid(probe, box, nodes);
  Probe::Answers answers = probe.ask(nodes_of(region.grid));
  if (!probe.wall())
    if (const auto wall = find_singular_wall(probe, region.grid, answers)) {
      probe.set_wall(*wall);
      answers = probe.ask(nodes_of(region.grid));
    }
  std::vector<int> sizes;
  const std::vector<int> part = label(region.grid, answers, sizes);
  const int chosen = choose_part(region.grid, part, sizes);
  region.empty = chosen < 0;
  region.inside.assign(region.grid.size(), 0);
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (chosen < 0 || part[i] != chosen) continue;
    region.inside[i] = 1;
    probe.set_side(answers.orientation[i]);
  }
  // What was tolerated on the other side while the side was open is singular now.
  for (std::size_t i = 0; i < part.size(); ++i)
    if (answers.inside(i) && probe.side() != 0 && answers.orientation[i] != probe.side())
      answers.limit[i] = probe.singularity();
  region.limit = std::move(answers.limit);
  region.inverse_condition = std::move(answers.inverse_condition);
  if (!region.empty) measure_extent(region);
  return region;
}

Region explore(Probe& probe, int nodes) {
  const int coarse = probe.evaluator().closed_form() ? 10000 : 500;
  const Bounds widest = search_bounds(probe);
  Bounds box = widest;
  Region found = explore(probe, box, std::min(nodes, coarse));
  // A small workspace falls between the nodes of a wide box: look nearer to home.
  Points home;
  home.add(Vector3::Zero());
  for (int look = 0; found.empty && look < 8 && probe.all_inside(home); ++look) {
    const Vector3 half = box.lower.cwiseAbs().cwiseMax(box.upper.cwiseAbs()) / 4;
    box = {box.lower.cwiseMax(-half), box.upper.cwiseMin(half)};
    found = explore(probe, box, std::min(nodes, coarse));
  }
  if (found.empty) return found;
  // Search bounds can be far too wide: close in.
  double margin = 0;
  for (int look = 0; look < 2; ++look) {
    margin = found.grid.step;
    const Vector3 before = box.upper - box.lower;
    for (int k = 0; k < 3; ++k) {
      if (!probe.active()[k]) continue;
      box.lower[k] = std::max(box.lower[k], found.extent.lower[k] - margin);
      box.upper[k] = std::min(box.upper[k], found.extent.upper[k] + margin);
    }
    if (look == 1 || ((box.upper - box.lower) - 0.5 * before).maxCoeff() >= 0) break;
    found = explore(probe, box, std::min(nodes, coarse));
    if (found.empty) return found;
  }
  // What bulges between coarse nodes, or hangs on by a neck that they miss, may pass the margin:
  // leave more where the region ends at it, and twice as much each time.
  constexpr int kMostLooks = 6;
  for (int look = 1;; ++look, margin *= 2) {
    found = explore(probe, box, nodes);
    if (found.empty || look == kMostLooks || !make_room(box, found, widest, margin)) return found;
  }
}

}  // namespace polyglide
