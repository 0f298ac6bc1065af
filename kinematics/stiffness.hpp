#pragma once

#include <optional>
#include <vector>

#include "kinematics/solve.hpp"

namespace polyglide {

/// What yields under load: drives, and the rods in series with them; the rest is rigid.
struct Springs {
  /// Of every drive, or one number for all [N/m, N·m/rad]; 1: the stiffness per drive stiffness.
  std::vector<double> drives{1.0};
  /// Of all rods of one drive together, along them [N/m]; infinite: rigid. Struts are their own
  /// rods.
  std::optional<double> rods;
  /// Rotations count as the way at this length, in singular values [m]; the machine's own when not
  /// given.
  std::optional<double> characteristic_length;
};

/// Jacobian, conditioning and stiffness at one pose, about the tool point and the base axes.
struct PoseIndices {
  /// Drive rates = J · task rates, in SI: m or rad of the drive per m or rad of the task axis.
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd singular_values;  ///< of J with rotations divided by the characteristic length
  double condition = 0;             ///< largest by smallest of them; infinite where singular
  double characteristic_length = 0;
  /// Wrench on the platform per displacement, K = Jᵀ diag(k) J; task axes only [N/m, N, N·m/rad].
  /// With rods of stiffness k_r along the unit vector u, 1/k = 1/k_drive + (1/k_r) |row|², where
  /// row is J's part for the three translations, u/(u·g).
  Eigen::MatrixXd stiffness;
};

/// nullopt where the pose cannot be taken or does not fix the drives' rates. Limits do not count.
/// @throws std::invalid_argument for springs of another number than the drives, or not positive;
/// for rods where they are not known (no closed form, or fewer than three translations).
[[nodiscard]] std::optional<PoseIndices> indices_at(const Machine& machine, const Pose& pose,
                                                    const Springs& springs = {});

}  // namespace polyglide
