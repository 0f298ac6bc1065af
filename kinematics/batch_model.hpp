#pragma once

#include <string>
#include <vector>

#include "kinematics/batch_kernels.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {

/// A leg machine with a pure task space, in the words of the batch kernel. Immutable.
///
/// With t the tool displacement, a rod's platform joint against its carriage joint
/// at home is v = a + t. A rod of length L on a guide g needs the carriage at
///   s = v·g + side·h,  h = sqrt(L² - |v - (v·g) g|²),
/// and gives the row  g - side (v - (v·g) g)/h  of the Jacobian; a strut of length
/// L at home needs s = |v| - L and gives the row v/|v|. A rod on a crank of radius ρ
/// needs its angle θ with |v - ρ (cos θ u + sin θ w)| = L and gives the row
/// n/(n · ρ (cos θ w - sin θ u)), n along the rod. Rotational columns are
/// (r × row)/characteristic length, r from the tool to the platform joint.
class BatchModel {
 public:
  /// @param machine with legs, a pure task space and at most batch::kMostDrives drives.
  BatchModel(const Machine& machine, const std::vector<std::string>& ignored);

  /// Leg by leg "reach …", "stroke … min", "stroke … max", "cone …"; then
  /// half-space limits; late_limit_names(), which the kernel does not know; "motion"; "not finite".
  [[nodiscard]] const std::vector<std::string>& limit_names() const { return limit_names_; }

  /// For poses with rotations of their own.
  [[nodiscard]] const batch::KernelModel& turning() const { return turning_; }

  /// For poses that share one rotation.
  [[nodiscard]] batch::KernelModel turned(const Eigen::Quaterniond& rotation) const;

  /// Whether a common rotation is one that the machine can command.
  [[nodiscard]] bool commands(const Eigen::Quaterniond& rotation) const;

 private:
  int add_name(std::string name);
  void add_leg(const Machine& machine, const Leg& leg, bool primary,
               const std::vector<std::string>& ignored);
  void add_cone(const Machine& machine, const Leg& leg, int joint, bool on_platform,
                const std::vector<std::string>& ignored);
  void add_limit(const Machine& machine, const HalfSpaceLimit& limit,
                 const std::vector<std::string>& ignored);

  std::vector<std::string> limit_names_;
  batch::KernelModel all_;      ///< every leg, turning
  batch::KernelModel turning_;  ///< without legs that repeat others at every rotation
};

}  // namespace polyglide
