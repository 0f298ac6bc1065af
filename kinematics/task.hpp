#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "kinematics/model.hpp"

namespace polyglide {

/// The independent motions of a platform near home: which of X Y Z A B C a user
/// may command (A, B, C = rotation about base x, y, z).
struct TaskSpace {
  std::vector<int> axes;  ///< ascending; 0..2 = X Y Z, 3..5 = A B C
  int translations = 0, rotations = 0;
  bool pure =
      false;  ///< the other coordinates stay zero (Schoenflies, planar, translational, 6-dof)
  Vector3 rotation_axis =
      Vector3::Zero();               ///< unit, when rotations == 1 and its direction stays fixed
  double characteristic_length = 1;  ///< [m]: RMS distance of platform joints from the tool point
};

}  // namespace polyglide
