#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinematics/solve.hpp"

namespace polyglide {

/// What yields under load: drives, and the rods in series with them; the rest is rigid.
struct Springs {
  /// Of every drive, or one number for all [N/m, N·m/rad]; 1: the stiffness per drive stiffness.
  std::vector<double> drives{1.0};
  /// Of all rods of one drive together, along them [N/m]; absent: rigid. Struts are their own
  /// rods.
  std::optional<double> rods;
  /// Rotations count as the way at this length, in singular values [m]; the machine's own when not
  /// given.
  std::optional<double> characteristic_length;
};

/// Least and greatest stiffness over the directions of one kind of motion.
struct StiffnessRange {
  double least = 0, greatest = 0;  ///< [N/m] of translations, [N·m/rad] of rotations
};

/// Jacobian, conditioning and stiffness at one pose, about the tool point and the base axes.
struct PoseIndices {
  /// Drive rates = J · task rates, in SI: m or rad of the drive per m or rad of the task axis.
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd singular_values;  ///< of J with rotations divided by the characteristic length
  /// Largest by smallest of them; infinite where singular: beyond 1e12, or with fewer drives than
  /// task axes.
  double condition = 0;
  double characteristic_length = 0;
  std::vector<double> drive_stiffness;  ///< as given, one per drive [N/m, N·m/rad]
  /// Wrench on the platform per displacement, K = Jᵀ diag(k) J; task axes only [N/m, N, N·m/rad].
  /// With rods of stiffness k_r along the unit vector u, 1/k = 1/k_drive + (1/k_r)/(u·b)², where b
  /// is the motion of the rod's end per drive.
  Eigen::MatrixXd stiffness;
  /// Force per displacement of the tool along it, the rotations of the task free to follow:
  /// eigenvalues of K_tt - K_tr K_rr⁺ K_rt. Absent without translations. The same of moments.
  std::optional<StiffnessRange> translation, rotation;
};

/// Indices at a posture of the whole mechanism, or, where the legs have closed forms and the task
/// space is pure, at a pose with the drives that its legs have there. Limits do not count. nullopt
/// where neither is known, or the platform's rates do not fix the drives'. Cost: some µs.
/// @param drives from home.
/// @throws std::invalid_argument for springs of another number than the drives, or not positive;
/// for rods where they are not known (no closed form).
[[nodiscard]] std::optional<PoseIndices> indices_at(const Machine& machine, const Pose& pose,
                                                    const Eigen::VectorXd& drives,
                                                    const std::optional<Posture>& posture,
                                                    const Springs& springs = {});

/// Why indices_at() gives nothing, in words; arguments as there.
[[nodiscard]] std::string why_no_indices(const Machine& machine,
                                         const std::optional<Posture>& posture);

/// Whether springs can have rods: the legs have closed forms and the task space is pure.
[[nodiscard]] bool knows_rods(const Machine& machine);

}  // namespace polyglide
