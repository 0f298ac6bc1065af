#include "kinematics/planar.hpp"

#include <algorithm>
#include <cmath>

namespace polyglide {

std::optional<Vector3> plane_of_motion(const Mechanism& mechanism) {
  constexpr double kAligned = 1e-9;
  const auto hinge = std::ranges::find(mechanism.joints, JointType::revolute, &Joint::type);
  if (hinge == mechanism.joints.end()) return std::nullopt;
  const Vector3 normal = hinge->axes[0];
  const bool planar = std::ranges::all_of(mechanism.joints, [&](const Joint& joint) {
    if (joint.type == JointType::revolute) return joint.axes[0].cross(normal).norm() < kAligned;
    return joint.type == JointType::prismatic && std::abs(joint.axes[0].dot(normal)) < kAligned;
  });
  return planar ? std::optional(normal) : std::nullopt;
}

}  // namespace polyglide
