#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "kinematics/task.hpp"

namespace polyglide {

/// Orientations that a tool is to have wherever it goes: tilts up to `tilt` in every direction that
/// the machine commands, each with a torsion of up to `torsion` either way.
struct OrientationSet {
  double tilt = 0;     ///< [rad] of the direction that is vertical at home
  double torsion = 0;  ///< [rad] three rotations only
};

/// The commanded rotations, ascending: 3, 4, 5 = A, B, C.
[[nodiscard]] std::vector<int> rotations_of(const TaskSpace& task);

/// The platform's rotation for a tilt towards `azimuth` and a torsion [rad].
///
/// Three rotations: Rz(azimuth)·Ry(tilt)·Rz(torsion − azimuth), the vertical tilts towards azimuth
/// without turning about itself (tilt and torsion angles: Bonev, Zlatanov, Gosselin 2002).
/// A and B: the same direction of the vertical with c = 0. Other pairs: azimuth is a
/// direction in the plane of the two angles, (cos, sin) × tilt. One: the angle itself is tilt, to
/// the side of the sign of cos(azimuth). None: no rotation.
[[nodiscard]] Eigen::Quaterniond turned(const TaskSpace& task, double azimuth, double tilt,
                                        double torsion = 0);

/// How far `turned` can be followed [rad]: π, or π/2 with two rotations and where B stands alone,
/// whose coordinates end there.
[[nodiscard]] double greatest_tilt(const TaskSpace& task);

/// Samples of a set: rings of tilts from the widest inwards, 8·fineness azimuths on each, and home
/// last; with three rotations each at 2·fineness + 1 torsions. Machines with one
/// rotation: 4·fineness + 1 angles. Never empty.
/// @param fineness >= 1
[[nodiscard]] std::vector<Eigen::Quaterniond> sample(const TaskSpace& task,
                                                     const OrientationSet& set, int fineness);

}  // namespace polyglide
