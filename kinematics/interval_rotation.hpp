#pragma once

#include <Eigen/Geometry>

#include "kinematics/interval.hpp"

namespace polyglide {

// Rotations of intervals; all need UpwardRounding.

using IntervalRotation = std::array<IntervalVector, 3>;  ///< rows

[[nodiscard]] inline IntervalVector vector_of(const Eigen::Vector3d& v) {
  return {v[0], v[1], v[2]};
}

[[nodiscard]] inline IntervalVector turned(const IntervalRotation& r, const IntervalVector& v) {
  return {dot(r[0], v), dot(r[1], v), dot(r[2], v)};
}

[[nodiscard]] inline IntervalRotation product(const IntervalRotation& a,
                                              const IntervalRotation& b) {
  IntervalRotation result;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      result[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  return result;
}

[[nodiscard]] inline IntervalRotation no_rotation() {
  IntervalRotation result;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) result[i][j] = i == j ? 1.0 : 0.0;
  return result;
}

/// The rotation of a quaternion of any length.
[[nodiscard]] inline IntervalRotation rotation_of(const Eigen::Quaterniond& q) {
  const Interval w = q.w(), x = q.x(), y = q.y(), z = q.z();
  const Interval scale = 2.0 / (square(w) + square(x) + square(y) + square(z));
  IntervalRotation r;
  r[0] = {1.0 - scale * (square(y) + square(z)), scale * (x * y - w * z), scale * (x * z + w * y)};
  r[1] = {scale * (x * y + w * z), 1.0 - scale * (square(x) + square(z)), scale * (y * z - w * x)};
  r[2] = {scale * (x * z - w * y), scale * (y * z + w * x), 1.0 - scale * (square(x) + square(y))};
  return r;
}

/// Rotation by the angle of cosine `c` and sine `s` about a unit axis, which may be an enclosure.
[[nodiscard]] inline IntervalRotation rotation_about(const IntervalVector& axis, const Interval& c,
                                                     const Interval& s) {
  const Interval rest = 1.0 - c;
  IntervalRotation r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      // 1 + (1 - c)(a² - 1) on the diagonal keeps an axis exactly where it is.
      if (i == j)
        r[i][j] = 1.0 + rest * (square(axis[i]) - 1.0);
      else
        r[i][j] = rest * axis[i] * axis[j];
    }
  r[0][1] -= s * axis[2], r[1][0] += s * axis[2];
  r[0][2] += s * axis[1], r[2][0] -= s * axis[1];
  r[1][2] -= s * axis[0], r[2][1] += s * axis[0];
  return r;
}

[[nodiscard]] inline IntervalRotation rotation_about(const IntervalVector& axis,
                                                     const Interval& angle) {
  return rotation_about(axis, cosine(angle), sine(angle));
}

/// A rotation by three angles, and the axes about which each of them turns it.
struct TurnByAngles {
  IntervalRotation rotation;
  std::array<IntervalVector, 3> axes;
};

/// Rz(c)·Ry(b)·Rx(a) of the angles {a, b, c}.
[[nodiscard]] inline TurnByAngles turn_by(const IntervalVector& angles) {
  const IntervalVector x = vector_of(Eigen::Vector3d::UnitX()),
                       y = vector_of(Eigen::Vector3d::UnitY()),
                       z = vector_of(Eigen::Vector3d::UnitZ());
  const IntervalRotation rz = rotation_about(z, angles[2]);
  const IntervalRotation zy = product(rz, rotation_about(y, angles[1]));
  return {product(zy, rotation_about(x, angles[0])), {turned(zy, x), turned(rz, y), z}};
}

}  // namespace polyglide
