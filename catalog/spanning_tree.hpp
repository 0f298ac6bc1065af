#pragma once

#include <vector>

#include "catalog/mechanism.hpp"

namespace polyglide {

/// Which joints carry the bodies and which close loops. Every body but the base hangs
/// on one tree joint; every other joint closes one loop.
struct SpanningTree {
  std::vector<int> parent_joint;  ///< per body: its tree joint towards the base, -1 for the base
  std::vector<int> body_order;    ///< all bodies from the base outwards, the base first
  std::vector<int> loop_joints;   ///< joints outside the tree, in the order of the file
};

/// Chooses the tree: driven joints and those with few freedoms first, so that loops are
/// closed by passive joints with many freedoms, which leave the fewest equations.
/// The same for the same mechanism; equal joints join in the order of the file.
/// A mechanism of the base alone has an empty tree.
/// @throws std::invalid_argument when a body is not connected to the base.
[[nodiscard]] SpanningTree spanning_tree(const Mechanism& mechanism);

/// The body that `body` hangs on; -1 for the base.
[[nodiscard]] int parent_body(const Mechanism& mechanism, const SpanningTree& tree, int body);

}  // namespace polyglide
