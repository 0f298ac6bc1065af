#pragma once

#include <string>
#include <vector>

#include "catalog/write_urdf.hpp"
#include "engines/mujoco_oracle.hpp"

namespace polyglide::engines {

/// The loops of a URDF with its YAML, as rows over the velocities of the tree that MuJoCo
/// makes of it.
class UrdfLoops {
 public:
  explicit UrdfLoops(const UrdfFiles& files);

  /// With the velocities of the link that is the platform.
  [[nodiscard]] ConstraintSystem system(const std::string& platform);

 private:
  void add_row(bool length, double residual, const std::vector<double>& row);
  void close(const std::string& a, const std::string& b, bool rigid);
  void follow(const std::string& urdf);

  MujocoModel mujoco_;
  int columns_;
  ConstraintSystem system_;
};

}  // namespace polyglide::engines
