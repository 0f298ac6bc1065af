#include "kinematics/point_machine.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/limits.hpp"
#include "kinematics/planar.hpp"

namespace polyglide {
namespace {

constexpr double kAtTool = 1e-9;  // [rad], or of the machine's size

/// The platform's hinge at the tool, -1 when there is none.
int tool_hinge(const Model& model) {
  const Mechanism& mechanism = model.mechanism;
  const auto joint = std::ranges::find_if(mechanism.joints, [&](const Joint& each) {
    return each.type == JointType::revolute &&
           std::ranges::count(each.bodies, mechanism.platform) > 0 &&
           (mechanism.tool - each.at).cross(each.axes[0]).norm() < kAtTool * model.size;
  });
  return joint == mechanism.joints.end() ? -1 : static_cast<int>(joint - mechanism.joints.begin());
}

/// The mechanism with a platform of its own between the two bodies of a hinge.
Mechanism split_at(Mechanism mechanism, int hinge) {
  const int rod = mechanism.platform;
  mechanism.platform = static_cast<int>(mechanism.bodies.size());
  mechanism.bodies.emplace_back("tool point");
  Joint& joint = mechanism.joints[hinge];
  std::ranges::replace(joint.bodies, rod, mechanism.platform);
  Joint other;
  other.name = joint.name + " of the tool point";
  other.type = JointType::revolute;
  other.bodies = {rod, mechanism.platform};
  other.at = joint.at;
  other.axes = joint.axes;
  mechanism.joints.push_back(std::move(other));
  return mechanism;
}

}  // namespace

std::optional<Machine> point_machine(const Machine& machine) {
  const Mechanism& mechanism = machine.model.mechanism;
  const auto normal = plane_of_motion(mechanism);
  if (machine.legs || !normal || !mechanism.limits.empty() || !late_limit_names(mechanism).empty())
    return std::nullopt;
  const int hinge = tool_hinge(machine.model);
  if (hinge < 0) return std::nullopt;
  TaskSpace task;
  task.pure = true;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs((*normal)[axis]) < kAtTool) task.axes.push_back(axis);
  task.translations = static_cast<int>(task.axes.size());
  if (task.translations != 2) return std::nullopt;
  Machine point = prepare(split_at(mechanism, hinge), task);
  const bool two = point.legs && point.legs->legs.size() == 2 && point.model.drives.size() == 2;
  return two ? std::optional(std::move(point)) : std::nullopt;
}

}  // namespace polyglide
