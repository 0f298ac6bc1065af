#include "kinematics/mode_bounds.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/assembly_modes.hpp"
#include "kinematics/planar.hpp"

namespace polyglide {
namespace {

constexpr double kMeet = 1e-9;  // of the machine's size

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
      return (other - point).norm() < kMeet * machine.model.size;
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
      return (centre - joint.at).cross(joint.axes[0]).norm() < kMeet * size;
    });
  }
  return false;
}

bool all_are(const std::vector<const Joint*>& joints, JointType type) {
  return std::ranges::all_of(joints, [type](const Joint* joint) { return joint->type == type; });
}

bool parallel(const Joint& a, const Joint& b) { return a.axes[0].cross(b.axes[0]).norm() < kMeet; }

/// What a limb leaves to the platform when its drives are held.
using Held = std::vector<const Joint*>;

ModeBound of_two_limbs(const Mechanism& mechanism, const std::vector<Held>& limbs) {
  const bool hinges =
      all_are(limbs[0], JointType::revolute) && all_are(limbs[1], JointType::revolute);
  const bool one_and_two = std::min(limbs[0].size(), limbs[1].size()) == 1 &&
                           std::max(limbs[0].size(), limbs[1].size()) == 2;
  if (one_and_two && hinges && plane_of_motion(mechanism)) return {2, "two circles in a plane"};
  return {};
}

/// Limbs of a ball that a hinge carries. @param fixed whether no drive turns the hinges.
ModeBound of_balls_on_circles(const std::vector<Held>& limbs, bool fixed) {
  const bool alike = std::ranges::all_of(
      limbs, [&](const Held& limb) { return parallel(*limb[1], *limbs[0][1]); });
  if (alike && fixed) return {12, "three balls on circles about parallel axes"};
  return {16, "three balls on circles"};
}

/// Whether each limb only slides the platform in a plane and turns it about the plane's normal,
/// the normals being three.
bool are_planes(const Mechanism& mechanism, const std::vector<Held>& limbs) {
  Eigen::Matrix3d normals;
  for (int i = 0; i < 3; ++i) {
    const Held& limb = limbs[i];
    if (limb.size() != 3 || !all_are(limb, JointType::revolute) || !parallel(*limb[0], *limb[1]) ||
        !parallel(*limb[0], *limb[2]))
      return false;
    normals.col(i) = limb[0]->axes[0];
  }
  return std::abs(normals.determinant()) > 1e-6 &&
         std::ranges::all_of(mechanism.joints, [](const Joint& joint) {
           return joint.driven.empty() || joint.type == JointType::prismatic;
         });
}

}  // namespace

ModeBound most_modes(const Machine& machine) {
  if (const std::vector<int> legs = distance_legs(machine); !legs.empty())
    return of_six_legs(machine, legs);
  const Mechanism& mechanism = machine.model.mechanism;
  std::vector<Held> limbs;
  bool fixed = true;
  for (const std::vector<int>& limb : serial_limbs(mechanism)) {
    limbs.push_back(passive(mechanism, limb));
    fixed = fixed && mechanism.joints[limb.back()].driven.empty();
  }
  if (limbs.size() == 2) return of_two_limbs(mechanism, limbs);
  if (limbs.size() != 3) return {};
  if (are_planes(mechanism, limbs)) return {1, "three planes"};
  const bool two = std::ranges::all_of(limbs, [](const Held& limb) {
    return limb.size() == 2 && limb[1]->type == JointType::revolute;
  });
  if (!two) return {};
  const auto at_platform = [&](JointType type) {
    return std::ranges::all_of(limbs, [&](const Held& limb) { return limb[0]->type == type; });
  };
  if (at_platform(JointType::spherical)) return of_balls_on_circles(limbs, fixed);
  if (!at_platform(JointType::revolute)) return {};
  if (plane_of_motion(mechanism)) return {6, "three distances in a plane"};
  if (about_one_point(mechanism, machine.model.size)) return {8, "three arms about one point"};
  return {};
}

}  // namespace polyglide
