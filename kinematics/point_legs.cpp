#include "kinematics/point_legs.hpp"

#include <algorithm>
#include <cmath>

namespace polyglide {
namespace {

constexpr double kSame = 1e-9;  // [rad], or of the machine's size

/// A hinge that nothing drives or limits.
bool swings(const Joint& joint) {
  return joint.type == JointType::revolute && joint.driven.empty() &&
         std::ranges::all_of(joint.range, [](const Range& range) {
           return std::isinf(range.min) && std::isinf(range.max);
         });
}

/// The joints of a body but one.
std::vector<int> others(const Mechanism& mechanism, int body, int joint) {
  std::vector<int> result;
  for (int j = 0; j < static_cast<int>(mechanism.joints.size()); ++j)
    if (j != joint && std::ranges::count(mechanism.joints[j].bodies, body) > 0) result.push_back(j);
  return result;
}

int other_body(const Joint& joint, int body) {
  return joint.bodies[0] == body ? joint.bodies[1] : joint.bodies[0];
}

/// The leg whose rod is `rod`, from the hinge at the tool to the base.
std::optional<Leg> leg_of(const Model& model, int rod, int tool_joint) {
  const Mechanism& mechanism = model.mechanism;
  const std::vector<int> ends = others(mechanism, rod, tool_joint);
  if (ends.size() != 1 || !swings(mechanism.joints[ends[0]])) return std::nullopt;
  const int carrier = other_body(mechanism.joints[ends[0]], rod);
  const std::vector<int> to_base = others(mechanism, carrier, ends[0]);
  if (to_base.size() != 1) return std::nullopt;
  const Joint& drive = mechanism.joints[to_base[0]];
  if (drive.driven.empty() || other_body(drive, carrier) != mechanism.base) return std::nullopt;
  Leg leg;
  leg.kind = drive.type == JointType::revolute ? Leg::Kind::crank_rod : Leg::Kind::guide_rod;
  leg.base_joint = ends[0];
  leg.platform_joint = tool_joint;
  const auto place = std::ranges::find(model.drives, model.first_freedom[to_base[0]]);
  leg.drive = static_cast<int>(place - model.drives.begin());
  const Vector3 normal = drive.type == JointType::revolute ? drive.axes[0] : Vector3::Zero();
  leg.direction = drive.bodies[0] == mechanism.base ? drive.axes[0] : Vector3(-drive.axes[0]);
  // All in the plane of the tool.
  const auto in_plane = [&](const Vector3& point) -> Vector3 {
    const Vector3& n = mechanism.joints[tool_joint].axes[0];
    return point - n.dot(point - mechanism.tool) * n;
  };
  leg.base_point = in_plane(mechanism.joints[ends[0]].at);
  leg.platform_point = mechanism.tool;
  leg.length = (leg.platform_point - leg.base_point).norm();
  if (!drive.range.empty()) leg.stroke = drive.range.front();
  Vector3 onward = leg.direction;
  if (leg.kind == Leg::Kind::crank_rod) {
    leg.centre = in_plane(drive.at);
    onward = normal.cross(leg.base_point - leg.centre) * leg.direction.dot(normal);
  }
  leg.side = (leg.platform_point - leg.base_point).dot(onward) > 0 ? -1 : 1;
  return leg.length > kSame * model.size ? std::optional(leg) : std::nullopt;
}

}  // namespace

std::optional<LegMachine> point_legs(const Model& model) {
  const Mechanism& mechanism = model.mechanism;
  if (mechanism.joints.size() != 5 || model.drives.size() != 2 || !mechanism.limits.empty())
    return std::nullopt;
  for (int j = 0; j < 5; ++j) {
    const Joint& joint = mechanism.joints[j];
    const Vector3 aside = (mechanism.tool - joint.at).cross(joint.axes[0]);
    if (!swings(joint) || aside.norm() > kSame * model.size ||
        std::ranges::count(joint.bodies, mechanism.platform) == 0)
      continue;
    const Vector3& normal = joint.axes[0];
    const bool planar = std::ranges::all_of(mechanism.joints, [&](const Joint& other) {
      return other.type == JointType::revolute ? other.axes[0].cross(normal).norm() < kSame
                                               : other.type == JointType::prismatic &&
                                                     std::abs(other.axes[0].dot(normal)) < kSame;
    });
    if (!planar) return std::nullopt;
    LegMachine machine;
    for (int rod : joint.bodies)
      if (const auto leg = leg_of(model, rod, j)) machine.legs.push_back(*leg);
    if (machine.legs.size() != 2) continue;
    machine.primary = machine.legs[0].drive == 0 ? std::vector<int>{0, 1} : std::vector<int>{1, 0};
    return machine;
  }
  return std::nullopt;
}

}  // namespace polyglide
