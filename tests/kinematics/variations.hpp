#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "kinematics/mobility.hpp"

// The same machine written in other ways: what must not change a verdict.
namespace polyglide::variations {

/// An own generator of numbers in [-1, 1], the same on every machine.
inline double uniform(std::mt19937_64& random) {
  return 2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1;
}

inline Vector3 uniform_vector(std::mt19937_64& random) {
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

inline Eigen::Isometry3d random_frame(std::mt19937_64& random, double distance) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  const Vector3 axis = uniform_vector(random).normalized();
  frame.linear() = Eigen::AngleAxisd(3 * uniform(random), axis).toRotationMatrix();
  frame.translation() = distance * uniform_vector(random);
  return frame;
}

/// In another unit and another frame.
inline Mechanism moved(Mechanism mechanism, const Eigen::Isometry3d& frame, double scale) {
  mechanism.tool = frame * (scale * mechanism.tool);
  for (Joint& joint : mechanism.joints) {
    joint.at = frame * (scale * joint.at);
    for (Vector3& axis : joint.axes) axis = frame.linear() * axis;
    joint.pitch *= scale;
  }
  return mechanism;
}

/// A seeded permutation of 0..count-1, the same on every machine.
inline std::vector<int> shuffled(std::size_t count, std::mt19937_64& random) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  return order;
}

/// Joints and bodies in another order.
inline Mechanism renumbered(const Mechanism& mechanism, std::mt19937_64& random) {
  Mechanism other = mechanism;
  const std::vector<int> order = shuffled(mechanism.joints.size(), random);
  for (std::size_t i = 0; i < order.size(); ++i) other.joints[i] = mechanism.joints[order[i]];
  const std::vector<int> place = shuffled(mechanism.bodies.size(), random);
  for (std::size_t i = 0; i < place.size(); ++i) other.bodies[place[i]] = mechanism.bodies[i];
  other.base = place[mechanism.base];
  other.platform = place[mechanism.platform];
  for (Joint& joint : other.joints)
    for (int& body : joint.bodies) body = place[body];
  return other;
}

/// Some joints with their two bodies exchanged, a universal's axes and its drives with them.
inline Mechanism swapped(Mechanism mechanism, std::mt19937_64& random) {
  for (Joint& joint : mechanism.joints) {
    if (random() % 2 == 0) continue;
    std::swap(joint.bodies[0], joint.bodies[1]);
    if (joint.type != JointType::universal) continue;
    std::swap(joint.axes[0], joint.axes[1]);
    for (int& driven : joint.driven) driven = 1 - driven;
    std::ranges::sort(joint.driven);
  }
  return mechanism;
}

inline double rounded(double value, int digits) {
  if (value == 0) return 0;
  const double unit = std::pow(10.0, digits - 1 - std::floor(std::log10(std::abs(value))));
  return std::round(value * unit) / unit;
}

/// As a drawing holds it: every number of a point or a direction with so many digits.
inline Mechanism drawn(Mechanism mechanism, int digits) {
  const auto round = [&](Vector3& v) {
    for (double& value : v) value = rounded(value, digits);
  };
  round(mechanism.tool);
  for (Joint& joint : mechanism.joints) {
    round(joint.at);
    for (Vector3& axis : joint.axes) {
      round(axis);
      axis.normalize();
    }
    joint.pitch = rounded(joint.pitch, digits);
  }
  return mechanism;
}

/// Described at another posture.
inline Mechanism taken_at(const Model& model, const Posture& posture) {
  Mechanism mechanism = model.mechanism;
  mechanism.tool = posture.bodies[mechanism.platform] * mechanism.tool;
  for (Joint& joint : mechanism.joints) {
    const auto [first, second] = joint.bodies;
    joint.at = posture.bodies[first] * joint.at;
    joint.axes[0] = posture.bodies[first].linear() * joint.axes[0];
    joint.axes[1] = posture.bodies[second].linear() * joint.axes[1];
  }
  return mechanism;
}

}  // namespace polyglide::variations
