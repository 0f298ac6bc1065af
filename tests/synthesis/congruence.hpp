#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "catalog/mechanism.hpp"

namespace polyglide::testing {

namespace detail {

inline constexpr double kNear = 1e-7;  // [m]

using Motion = Eigen::Isometry3d;  // or a reflection

inline bool same_line(const Vector3& a, const Vector3& b) { return a.cross(b).norm() < kNear; }

inline bool has_point(const Joint& joint) { return joint.type != JointType::prismatic; }

inline Vector3 centre(const Mechanism& mechanism) {
  Vector3 sum = Vector3::Zero();
  int count = 0;
  for (const Joint& joint : mechanism.joints)
    if (has_point(joint)) sum += joint.at, ++count;
  return count > 0 ? Vector3(sum / count) : mechanism.tool;
}

// Assigns joints of `a` (moved) to joints of `b` one after the other, and bodies with them.
class Matching {
 public:
  Matching(const Mechanism& a, const Mechanism& b, const Motion& motion)
      : a_(a), b_(b), motion_(motion), body_(a.bodies.size(), -1), taken_(b.joints.size()) {}

  bool exists() {
    return bind(a_.base, b_.base) && bind(a_.platform, b_.platform) &&
           (motion_ * a_.tool - b_.tool).norm() < kNear && match(0);
  }

 private:
  bool match(std::size_t i) {
    if (i == a_.joints.size()) return true;
    for (std::size_t j = 0; j < b_.joints.size(); ++j)
      for (const bool swapped : {false, true}) {
        if (taken_[j] || !fits(a_.joints[i], b_.joints[j], swapped)) continue;
        const std::vector<int> before = body_;
        const auto& [first, second] = b_.joints[j].bodies;
        if (bind(a_.joints[i].bodies[0], swapped ? second : first) &&
            bind(a_.joints[i].bodies[1], swapped ? first : second)) {
          taken_[j] = true;
          if (match(i + 1)) return true;
          taken_[j] = false;
        }
        body_ = before;
      }
    return false;
  }
  bool fits(const Joint& a, const Joint& b, bool swapped) const {
    if (a.type != b.type || a.driven.size() != b.driven.size()) return false;
    if (has_point(a) && (motion_ * a.at - b.at).norm() > kNear) return false;
    if (a.type == JointType::spherical) return true;
    const int axes = a.type == JointType::universal ? 2 : 1;
    for (int k = 0; k < axes; ++k)
      if (!same_line(motion_.linear() * a.axes[k], b.axes[axes == 2 && swapped ? 1 - k : k]))
        return false;
    return true;
  }
  bool bind(int a, int b) {
    if (body_[a] >= 0) return body_[a] == b;
    for (const int other : body_)
      if (other == b) return false;
    body_[a] = b;
    return true;
  }

  const Mechanism& a_;
  const Mechanism& b_;
  Motion motion_;
  std::vector<int> body_;
  std::vector<bool> taken_;
};

}  // namespace detail

/// Whether one mechanism is carried onto the other by a rotation about the
/// vertical, a reflection in a vertical plane, a translation and renumbering:
/// tried out on coordinates, motion by motion and joint by joint. Slow, and
/// independent of canonical_form(), which it judges.
/// For revolute, prismatic, universal and spherical joints.
inline bool congruent(const Mechanism& a, const Mechanism& b) {
  using namespace detail;
  if (a.bodies.size() != b.bodies.size() || a.joints.size() != b.joints.size()) return false;
  const Vector3 centre_a = centre(a), centre_b = centre(b);
  // Any motion brings the first joint point off the vertical axis onto one of the other's.
  const Joint* first = nullptr;
  for (const Joint& joint : a.joints)
    if (!first && has_point(joint) && (joint.at - centre_a).head<2>().norm() > kNear)
      first = &joint;
  if (!first) return false;
  const auto azimuth = [](const Vector3& v) { return std::atan2(v.y(), v.x()); };
  for (const Joint& joint : b.joints)
    for (const bool mirrored : {false, true}) {
      const Eigen::Vector3d mirror(1, mirrored ? -1 : 1, 1);
      const double angle =
          azimuth(joint.at - centre_b) - azimuth(mirror.asDiagonal() * (first->at - centre_a));
      Motion motion = Motion::Identity();
      motion.linear() =
          Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix() * mirror.asDiagonal();
      motion.translation() = centre_b - motion.linear() * centre_a;
      if (Matching(a, b, motion).exists()) return true;
    }
  return false;
}

}  // namespace polyglide::testing
