#include "kinematics/point_machine.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/limits.hpp"

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

/// The hinge at the tool when everything moves in the plane across it.
int tool_hinge(const Model& model) {
  const Mechanism& mechanism = model.mechanism;
  for (int j = 0; j < static_cast<int>(mechanism.joints.size()); ++j) {
    const Joint& joint = mechanism.joints[j];
    const Vector3& normal = joint.axes[0];
    const bool planar = std::ranges::all_of(mechanism.joints, [&](const Joint& other) {
      if (other.type == JointType::revolute) return other.axes[0].cross(normal).norm() < kSame;
      return other.type == JointType::prismatic && std::abs(other.axes[0].dot(normal)) < kSame;
    });
    const double aside = (mechanism.tool - joint.at).cross(normal).norm();
    if (swings(joint) && planar && aside < kSame * model.size &&
        std::ranges::count(joint.bodies, mechanism.platform) > 0)
      return j;
  }
  return -1;
}

}  // namespace

std::optional<Machine> point_machine(const Machine& machine) {
  const Model& model = machine.model;
  const Mechanism& mechanism = model.mechanism;
  if (machine.legs || mechanism.joints.size() != 5 || model.drives.size() != 2 ||
      !mechanism.limits.empty() || !late_limit_names(mechanism).empty())
    return std::nullopt;
  const int hinge = tool_hinge(model);
  if (hinge < 0) return std::nullopt;
  LegMachine legs;
  for (int rod : mechanism.joints[hinge].bodies)
    if (const auto leg = leg_of(model, rod, hinge)) legs.legs.push_back(*leg);
  if (legs.legs.size() != 2 || legs.legs[0].drive == legs.legs[1].drive) return std::nullopt;
  legs.primary = legs.legs[0].drive == 0 ? std::vector<int>{0, 1} : std::vector<int>{1, 0};
  Machine point = machine;
  point.legs = std::move(legs);
  point.task = TaskSpace{};
  point.task.pure = true;
  point.task.translations = 2;
  point.task.characteristic_length = machine.task.characteristic_length;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(mechanism.joints[hinge].axes[0][axis]) < kSame) point.task.axes.push_back(axis);
  return point.task.axes.size() == 2 ? std::optional(std::move(point)) : std::nullopt;
}

}  // namespace polyglide
