#include "catalog/engine_tree.hpp"

#include <algorithm>
#include <cmath>

#include "catalog/spanning_tree.hpp"

namespace polyglide {
namespace {

/// Seen from bodies[1] the joint's freedoms come in the other order, each the other way
/// round; turning the axis keeps the coordinate.
std::vector<EngineMotion> motions_of(const Joint& joint, bool reversed) {
  std::vector<EngineMotion> motions;
  for (const ElementaryMotion& motion : elementary_motions(joint)) {
    const int index = static_cast<int>(motions.size());
    const bool driven =
        std::find(joint.driven.begin(), joint.driven.end(), index) != joint.driven.end();
    motions.push_back({index, motion, joint.range.empty() ? Range{} : joint.range[index], driven});
  }
  if (!reversed) return motions;
  std::reverse(motions.begin(), motions.end());
  for (EngineMotion& motion : motions) motion.motion.axis = -motion.motion.axis;
  return motions;
}

}  // namespace

EngineTree engine_tree(const Mechanism& mechanism) {
  const SpanningTree spanning = spanning_tree(mechanism);
  EngineTree tree;
  std::vector<int> link_of(mechanism.bodies.size(), -1);
  for (int body : spanning.body_order) {
    EngineLink link;
    link.body = body;
    link.joint = spanning.parent_joint[body];
    if (link.joint >= 0) {
      const Joint& joint = mechanism.joints[link.joint];
      link.parent = link_of[parent_body(mechanism, spanning, body)];
      link.origin = joint.at;
      link.motions = motions_of(joint, body == joint.bodies[0]);
    }
    link_of[body] = static_cast<int>(tree.links.size());
    tree.links.push_back(std::move(link));
  }
  for (int j : spanning.loop_joints) {
    const Joint& joint = mechanism.joints[j];
    const int first = link_of[joint.bodies[0]], second = link_of[joint.bodies[1]];
    const bool point = joint.type == JointType::spherical && joint.driven.empty();
    if (point || joint.type == JointType::weld) {
      tree.closures.push_back({joint.name, first, second, joint.at, !point});
      continue;
    }
    const int cut = static_cast<int>(tree.links.size());
    tree.links.push_back({-1, first, j, joint.at, motions_of(joint, false)});
    tree.closures.push_back({joint.name, cut, second, joint.at, true});
  }
  return tree;
}

std::vector<StickFigure> stick_figures(const Mechanism& mechanism, const EngineTree& tree) {
  std::vector<StickFigure> figures(tree.links.size());
  const double shortest = bar_radius(mechanism);
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    const EngineLink& link = tree.links[i];
    if (link.body < 0 || link.body == mechanism.base) continue;
    const auto draw = [&](const Vector3& point) {
      if ((point - link.origin).norm() > shortest) figures[i].ends.push_back(point - link.origin);
    };
    for (std::size_t j = 0; j < mechanism.joints.size(); ++j) {
      const auto& bodies = mechanism.joints[j].bodies;
      if (static_cast<int>(j) != link.joint && (bodies[0] == link.body || bodies[1] == link.body))
        draw(mechanism.joints[j].at);
    }
    if (link.body == mechanism.platform) draw(mechanism.tool);
  }
  return figures;
}

double bar_radius(const Mechanism& mechanism) {
  Vector3 low = mechanism.tool, high = mechanism.tool;
  for (const Joint& joint : mechanism.joints) {
    low = low.cwiseMin(joint.at);
    high = high.cwiseMax(joint.at);
  }
  const double extent = (high - low).norm();
  return extent > 0 ? extent / 100 : 0.01;
}

double bar_density(const Mechanism& mechanism) {
  return 2700 * std::max(1.0, std::pow(0.05 / (100 * bar_radius(mechanism)), 5));
}

std::string freedom_name(const Joint& joint, int freedom) {
  return freedoms(joint.type) == 1 ? joint.name : joint.name + '.' + std::to_string(freedom + 1);
}

}  // namespace polyglide
