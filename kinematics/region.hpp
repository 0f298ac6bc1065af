#pragma once

#include <array>
#include <vector>

#include "kinematics/probe.hpp"

namespace polyglide {

/// A box that holds every place the tool can reach: for leg machines from
/// strokes and rod lengths, else by walking from home along the axes.
[[nodiscard]] Bounds search_bounds(const Probe& probe);

/// Cubic grid over a box; one node in directions the machine does not command.
struct NodeGrid {
  Vector3 origin = Vector3::Zero();
  double step = 0;
  std::array<int, 3> count{1, 1, 1};

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(count[0]) * count[1] * count[2];
  }
  [[nodiscard]] std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(count[0]) * (j + static_cast<std::size_t>(count[1]) * k);
  }
  [[nodiscard]] Vector3 at(int i, int j, int k) const { return origin + step * Vector3(i, j, k); }
};

/// The workspace on a grid: the connected part that holds home (the largest part
/// when home is outside).
struct Region {
  NodeGrid grid;
  std::vector<char> inside;  ///< per node
  std::vector<int> limit;    ///< per node; -1 = no limit, though perhaps of another part
  std::vector<double> inverse_condition;  ///< per node
  Bounds extent;                          ///< of the nodes inside
  bool empty = true;
};

/// Explores a box with about `nodes` nodes; fixes the probe's side when it is open.
[[nodiscard]] Region explore(Probe& probe, const Bounds& box, int nodes);

/// The same twice: coarsely over the search bounds, then over what was found and a margin, which
/// grows where the region ends at it.
[[nodiscard]] Region explore(Probe& probe, int nodes);

}  // namespace polyglide
