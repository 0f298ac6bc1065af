#pragma once

#include <optional>
#include <vector>

#include "kinematics/solve.hpp"

namespace polyglide {

/// Forward kinematics where six distances place the platform: |R p_i + t - c_i| = r_i.
class DistancePlatform {
 public:
  /// @param legs indices, six of them.
  DistancePlatform(const Machine& machine, const std::vector<int>& legs,
                   const Eigen::VectorXd& drives);

  /// Newton from a random pose of the given number; nullopt when it does not arrive. Some µs.
  [[nodiscard]] std::optional<Pose> random_root(std::uint64_t seed, std::uint64_t number) const;

  /// Largest |distance - r|/size at a pose.
  [[nodiscard]] double residual(const Pose& pose) const;

  /// Sign of det J: rows [gap, arm × gap], scaled; 0 when |det| of unit rows is below 1e-12.
  [[nodiscard]] int side(const Pose& pose) const;

  /// Whether det J keeps its sign along the straight way between two poses (positions linearly,
  /// rotation about one axis), looked at in `samples` places.
  [[nodiscard]] bool regular_between(const Pose& a, const Pose& b, int samples) const;

 private:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  void linearise(const Eigen::Matrix3d& turn, const Vector3& position, Vector6& error,
                 Matrix6& jacobian) const;

  std::array<Vector3, 6> arms_, centres_;  // per size, from the tool
  std::array<double, 6> radii_;
  Vector3 middle_ = Vector3::Zero();
  double reach_ = 1, size_ = 1;
};

}  // namespace polyglide
