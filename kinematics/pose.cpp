#include <algorithm>
#include <cmath>

#include "kinematics/solve.hpp"

namespace polyglide {

Pose pose_of(const Eigen::Matrix<double, 6, 1>& coordinates) {
  using Eigen::AngleAxisd;
  return {coordinates.head<3>(), AngleAxisd(coordinates[5], Vector3::UnitZ()) *
                                     AngleAxisd(coordinates[4], Vector3::UnitY()) *
                                     AngleAxisd(coordinates[3], Vector3::UnitX())};
}

Eigen::Matrix<double, 6, 1> coordinates_of(const Pose& pose) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  Eigen::Matrix<double, 6, 1> coordinates;
  coordinates << pose.position, std::atan2(r(2, 1), r(2, 2)),
      std::asin(std::clamp(-r(2, 0), -1.0, 1.0)), std::atan2(r(1, 0), r(0, 0));
  return coordinates;
}

Transform platform_transform(const Model& model, const Pose& pose) {
  Transform platform = Transform::Identity();
  platform.linear() = pose.rotation.toRotationMatrix();
  const Vector3& tool = model.mechanism.tool;
  platform.translation() = tool + pose.position - platform.linear() * tool;
  return platform;
}

Pose platform_pose(const Model& model, const Transform& platform) {
  const Vector3& tool = model.mechanism.tool;
  return {platform * tool - tool, Eigen::Quaterniond(platform.linear())};
}

Eigen::VectorXd drive_positions(const Model& model, const Posture& posture) {
  return posture.q(model.drives);
}

}  // namespace polyglide
