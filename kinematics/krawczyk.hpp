#pragma once

#include "kinematics/solve.hpp"

namespace polyglide {

// Certificates of forward kinematics by Krawczyk's interval Newton operator: if it maps a box into
// its interior, the box holds exactly one root (Krawczyk 1969; Moore 1977). Proved for
// the numbers in memory; every rounding on the way is enclosed.

/// What is proved about an assembly mode: a box around the posture found that holds one
/// solution and no other.
struct ModeCertificate {
  bool proved = false;
  double radius = 0;  ///< half the box [rad, or length/size]; 0 unless proved
  /// Closure equations that follow from the others by the look of their rank: not in the proof, but
  /// below 1e-9 on the whole box.
  int redundant = 0;
};

/// For machines whose platform is placed by distances alone (see distance_legs): six legs and all
/// six pose coordinates, or three legs with `rotation` fixed.
[[nodiscard]] ModeCertificate certify_pose(const Machine& machine, const std::vector<int>& legs,
                                           const Eigen::VectorXd& drives, const Pose& pose,
                                           bool translations_only);

/// For any mechanism: loop closure with the drives held at the posture's, unknown are the passive
/// freedoms. Rows that vanish identically (planar and spherical mechanisms on exact axes) are
/// proved to and left out; idle freedoms stay where they are. With other redundant constraints, as
/// of parallelograms, a largest independent part of the equations is proved to have the root, and
/// the rest is enclosed on its box (`redundant`). Not proved when a rank is in doubt, or when the
/// platform is not held by the drives.
[[nodiscard]] ModeCertificate certify_closure(const Model& model, const Posture& posture);

}  // namespace polyglide
