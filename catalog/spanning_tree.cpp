#include "catalog/spanning_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace polyglide {
namespace {

/// Joints in the order in which they should join the tree.
std::vector<int> tree_preference(const Mechanism& mechanism) {
  std::vector<int> order(mechanism.joints.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int j) {
    return std::pair(mechanism.joints[j].driven.empty(), freedoms(mechanism.joints[j].type));
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  return order;
}

/// Spanning tree of the bodies by Kruskal's rule: is each joint part of it?
std::vector<bool> choose_tree(const Mechanism& mechanism) {
  std::vector<int> group(mechanism.bodies.size());
  std::iota(group.begin(), group.end(), 0);
  std::vector<bool> in_tree(mechanism.joints.size(), false);
  for (int j : tree_preference(mechanism)) {
    const auto [first, second] = mechanism.joints[j].bodies;
    const int from = group[second], to = group[first];
    if (from == to) continue;
    in_tree[j] = true;
    std::replace(group.begin(), group.end(), from, to);
  }
  return in_tree;
}

}  // namespace

SpanningTree spanning_tree(const Mechanism& mechanism) {
  const int bodies = static_cast<int>(mechanism.bodies.size());
  const int joints = static_cast<int>(mechanism.joints.size());
  const std::vector<bool> in_tree = choose_tree(mechanism);
  SpanningTree tree;
  tree.parent_joint.assign(bodies, -1);
  std::vector<bool> seen(bodies, false);
  tree.body_order = {mechanism.base};
  seen[mechanism.base] = true;
  for (std::size_t next = 0; next < tree.body_order.size(); ++next) {
    const int body = tree.body_order[next];
    for (int j = 0; j < joints; ++j) {
      const auto [first, second] = mechanism.joints[j].bodies;
      if (!in_tree[j] || (first != body && second != body)) continue;
      const int other = first == body ? second : first;
      if (seen[other]) continue;
      seen[other] = true;
      tree.parent_joint[other] = j;
      tree.body_order.push_back(other);
    }
  }
  for (int b = 0; b < bodies; ++b)
    if (!seen[b])
      throw std::invalid_argument(fmt::format(
          "spanning_tree: body \"{}\" is not connected to the base", mechanism.bodies[b]));
  for (int j = 0; j < joints; ++j)
    if (!in_tree[j]) tree.loop_joints.push_back(j);
  return tree;
}

int parent_body(const Mechanism& mechanism, const SpanningTree& tree, int body) {
  const int joint = tree.parent_joint[body];
  if (joint < 0) return -1;
  const auto [first, second] = mechanism.joints[joint].bodies;
  return first == body ? second : first;
}

}  // namespace polyglide
