#include "kinematics/orientation_set.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinematics/solve.hpp"

namespace polyglide {
namespace {

using std::numbers::pi;

Eigen::Quaterniond of_angles(double a, double b, double c) {
  Eigen::Matrix<double, 6, 1> coordinates = Eigen::Matrix<double, 6, 1>::Zero();
  coordinates.tail<3>() << a, b, c;
  return pose_of(coordinates).rotation;
}

Eigen::Quaterniond about(const Vector3& axis, double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

}  // namespace

std::vector<int> rotations_of(const TaskSpace& task) {
  std::vector<int> rotations;
  std::copy_if(task.axes.begin(), task.axes.end(), std::back_inserter(rotations),
               [](int axis) { return axis >= 3; });
  return rotations;
}

Eigen::Quaterniond turned(const TaskSpace& task, double azimuth, double tilt, double torsion) {
  const std::vector<int> rotations = rotations_of(task);
  if (rotations.size() == 3)
    return about(Vector3::UnitZ(), azimuth) * about(Vector3::UnitY(), tilt) *
           about(Vector3::UnitZ(), torsion - azimuth);
  Vector3 angles = Vector3::Zero();
  if (rotations == std::vector<int>{3, 4}) {
    angles[0] = -std::asin(std::clamp(std::sin(tilt) * std::sin(azimuth), -1.0, 1.0));
    angles[1] = std::atan2(std::sin(tilt) * std::cos(azimuth), std::cos(tilt));
  } else if (rotations.size() == 2) {
    angles[rotations[0] - 3] = tilt * std::cos(azimuth);
    angles[rotations[1] - 3] = tilt * std::sin(azimuth);
  } else if (rotations.size() == 1) {
    angles[rotations[0] - 3] = std::cos(azimuth) < 0 ? -tilt : tilt;
  }
  return of_angles(angles[0], angles[1], angles[2]);
}

double greatest_tilt(const TaskSpace& task) {
  const std::vector<int> rotations = rotations_of(task);
  const bool ends = rotations.size() == 2 || rotations == std::vector<int>{4};
  return ends ? pi / 2 : pi;
}

std::vector<Eigen::Quaterniond> sample(const TaskSpace& task, const OrientationSet& set,
                                       int fineness) {
  const std::size_t rotations = rotations_of(task).size();
  const int azimuths = rotations == 1 ? 2 : 8 * fineness;
  const int rings = rotations == 1 ? 2 * fineness : fineness;
  std::vector<double> torsions{0};
  for (int i = fineness; rotations == 3 && set.torsion > 0 && i >= 1; --i)
    for (int sign : {1, -1}) torsions.push_back(sign * set.torsion * i / fineness);
  // The greatest torsions first: what stops most is best asked first.
  std::rotate(torsions.begin(), torsions.begin() + 1, torsions.end());
  std::vector<Eigen::Quaterniond> samples;
  for (int ring = rings; rotations > 0 && set.tilt > 0 && ring >= 1; --ring)
    for (int i = 0; i < azimuths; ++i)
      for (double torsion : torsions)
        samples.push_back(turned(task, 2 * pi * i / azimuths, set.tilt * ring / rings, torsion));
  for (double torsion : torsions) samples.push_back(turned(task, 0, 0, torsion));
  return samples;
}

}  // namespace polyglide
