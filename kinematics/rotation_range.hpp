#pragma once

#include <optional>
#include <string>

#include "kinematics/evaluate.hpp"
#include "kinematics/region.hpp"

namespace polyglide {

/// How far a platform with one rotation turns.
struct RotationRange {
  char axis = 'A';               ///< about base x, y or z: A, B, C
  Vector3 at = Vector3::Zero();  ///< tool displacement from home [m]
  double min = 0, max = 0;       ///< [rad] about home orientation
  std::string min_limit,
      max_limit;  ///< what stops it there: a limit or "singularity"; "" at half a turn
};

/// The widest range of rotation over a coarse grid of places in `extent`, each
/// turned from home orientation both ways in steps of `step` [rad] until a limit or a
/// singularity stops it, at most half a turn each way. The ends of the widest are bisected.
/// nullopt for machines without exactly one rotation, or when no place is reachable.
/// @param poses counts the poses asked.
[[nodiscard]] std::optional<RotationRange> widest_rotation(const Evaluator& evaluator,
                                                           const Bounds& extent, double step,
                                                           std::size_t& poses);

}  // namespace polyglide
