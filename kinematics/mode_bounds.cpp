#include "kinematics/mode_bounds.hpp"

#include <algorithm>

#include "kinematics/assembly_modes.hpp"

namespace polyglide {
namespace {

constexpr double kSame = 1e-9;  // of the machine's size

/// Joints of a serial limb from a platform joint to the base; empty for any other limb.
std::vector<int> limb_from(const Mechanism& mechanism, int platform_joint) {
  std::vector<int> limb{platform_joint};
  int body = mechanism.platform;
  for (std::size_t i = 0; i < mechanism.joints.size(); ++i) {
    const auto& bodies = mechanism.joints[limb.back()].bodies;
    body = bodies[0] == body ? bodies[1] : bodies[0];
    if (body == mechanism.base) return limb;
    std::vector<int> next;
    for (int j = 0; j < static_cast<int>(mechanism.joints.size()); ++j)
      if (j != limb.back() && std::ranges::count(mechanism.joints[j].bodies, body) > 0)
        next.push_back(j);
    if (body == mechanism.platform || next.size() != 1) return {};
    limb.push_back(next.front());
  }
  return {};
}

/// Serial limbs that together are the whole mechanism.
std::vector<std::vector<int>> serial_limbs(const Mechanism& mechanism) {
  std::vector<std::vector<int>> limbs;
  std::size_t joints = 0;
  for (int j = 0; j < static_cast<int>(mechanism.joints.size()); ++j) {
    if (std::ranges::count(mechanism.joints[j].bodies, mechanism.platform) == 0) continue;
    limbs.push_back(limb_from(mechanism, j));
    if (limbs.back().empty()) return {};
    joints += limbs.back().size();
  }
  return joints == mechanism.joints.size() ? limbs : std::vector<std::vector<int>>{};
}

/// Joints of a limb that turn or slide by themselves when the drives are held.
std::vector<const Joint*> passive(const Mechanism& mechanism, const std::vector<int>& limb) {
  std::vector<const Joint*> joints;
  for (int j : limb) {
    const Joint& joint = mechanism.joints[j];
    if (static_cast<int>(joint.driven.size()) < freedoms(joint.type)) joints.push_back(&joint);
  }
  return joints;
}

ModeBound of_six_legs(const Machine& machine, const std::vector<int>& legs) {
  std::vector<int> meeting;  // sizes of the groups of platform joints that coincide
  std::vector<Vector3> points;
  for (int index : legs) {
    const Vector3& point = machine.legs->legs[index].platform_point;
    const auto known = std::ranges::find_if(points, [&](const Vector3& other) {
      return (other - point).norm() < kSame * machine.model.size;
    });
    if (known != points.end()) {
      ++meeting[known - points.begin()];
    } else {
      points.push_back(point);
      meeting.push_back(1);
    }
  }
  std::ranges::sort(meeting);
  if (meeting == std::vector<int>{2, 2, 2}) return {16, "six legs to three points of the platform"};
  if (meeting == std::vector<int>{1, 2, 3}) return {8, "six legs to three points, 3-2-1"};
  return {40, "six legs"};
}

/// Whether all joints are hinges with axes through one point.
bool about_one_point(const Mechanism& mechanism, double size) {
  const auto& joints = mechanism.joints;
  if (!std::ranges::all_of(joints, [](const Joint& j) { return j.type == JointType::revolute; }))
    return false;
  for (const Joint& other : joints) {
    const Vector3 &a = joints[0].axes[0], &b = other.axes[0];
    const Vector3 normal = a.cross(b);
    if (normal.norm() < 1e-6) continue;
    const Vector3 between = other.at - joints[0].at;
    const Vector3 centre = joints[0].at + between.cross(b).dot(normal) / normal.squaredNorm() * a;
    return std::ranges::all_of(joints, [&](const Joint& joint) {
      return (centre - joint.at).cross(joint.axes[0]).norm() < kSame * size;
    });
  }
  return false;
}

bool in_one_plane(const Mechanism& mechanism) {
  const auto hinge = std::ranges::find(mechanism.joints, JointType::revolute, &Joint::type);
  if (hinge == mechanism.joints.end()) return false;
  return std::ranges::all_of(mechanism.joints, [&](const Joint& joint) {
    if (joint.type == JointType::revolute)
      return joint.axes[0].cross(hinge->axes[0]).norm() < kSame;
    return joint.type == JointType::prismatic &&
           std::abs(joint.axes[0].dot(hinge->axes[0])) < kSame;
  });
}

}  // namespace

ModeBound most_modes(const Machine& machine) {
  if (const std::vector<int> legs = distance_legs(machine); !legs.empty())
    return of_six_legs(machine, legs);
  const Mechanism& mechanism = machine.model.mechanism;
  const auto limbs = serial_limbs(mechanism);
  if (limbs.size() != 3) return {};
  const auto are = [&](std::size_t count, JointType rest, JointType at_platform) {
    return std::ranges::all_of(limbs, [&](const std::vector<int>& limb) {
      const auto joints = passive(mechanism, limb);
      return joints.size() == count && joints.front()->type == at_platform &&
             std::all_of(joints.begin() + 1, joints.end(),
                         [&](const Joint* joint) { return joint->type == rest; });
    });
  };
  if (are(2, JointType::revolute, JointType::spherical)) {
    std::vector<Vector3> axes;
    for (const auto& limb : limbs) axes.push_back(passive(mechanism, limb)[1]->axes[0]);
    const bool parallel = std::ranges::all_of(
        axes, [&](const Vector3& axis) { return axis.cross(axes[0]).norm() < kSame; });
    // The circles turn with their drives where these come before the hinge.
    const bool fixed = std::ranges::all_of(limbs, [&](const std::vector<int>& limb) {
      return mechanism.joints[limb.back()].driven.empty();
    });
    if (parallel && fixed) return {12, "three balls on circles about parallel axes"};
    return {16, "three balls on circles"};
  }
  if (!are(2, JointType::revolute, JointType::revolute)) return {};
  if (in_one_plane(mechanism)) return {6, "three distances in a plane"};
  if (about_one_point(mechanism, machine.model.size)) return {8, "three arms about one point"};
  return {};
}

}  // namespace polyglide
