#pragma once

#include <vector>

namespace polyglide::engines {

/// What an engine says about a mechanism at one posture. Plain numbers, because one of
/// the engines cannot share a source file with Eigen. Matrices are row by row.
struct ConstraintSystem {
  int rows = 0, columns = 0;
  std::vector<double> jacobian;        ///< rows × columns: constraint rates by velocities
  std::vector<double> residual;        ///< of every row
  std::vector<bool> row_is_length;     ///< measured in metres, else dimensionless
  std::vector<bool> column_is_length;  ///< velocity in m/s, else rad/s
  std::vector<bool> column_is_driven;  ///< velocity of a drive
  std::vector<double> platform;        ///< 6 × columns: its angular, then its linear velocity
};

}  // namespace polyglide::engines
