#pragma once

#include <array>
#include <string>
#include <vector>

#include "engines/constraint_system.hpp"

namespace polyglide::engines {

/// A joint in plain numbers, for a source file without Eigen.
struct PlainJoint {
  std::string kind;  ///< the word of the mechanism format
  int first = 0, second = 0;
  std::array<double, 3> at{}, axis{};
  std::array<double, 3> other{};  ///< universal: second axis; planar: first direction in the plane
  double pitch = 0;               ///< advance per radian
  std::vector<int> driven;
};

struct PlainMechanism {
  int bodies = 0, base = 0, platform = 0;
  std::array<double, 3> tool{};
  std::vector<PlainJoint> joints;
};

/// Builds the mechanism in Simbody, assembled at home, and asks for its constraints. The
/// spanning tree is Simbody's own: breadth first, joints in the order of the file.
[[nodiscard]] ConstraintSystem simbody_at_home(const PlainMechanism& mechanism);

}  // namespace polyglide::engines
