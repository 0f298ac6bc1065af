#pragma once

#include <optional>
#include <vector>

#include "kinematics/solve.hpp"

namespace polyglide {

/// The range of a joint freedom; a side without limit ends where a drawing stays
/// sensible: 0.6 of the machine's size, or 60°.
[[nodiscard]] Range drawing_range(const Model& model, int joint, int index);

/// Where all bodies are for combinations of drive values.
struct PoseTable {
  std::vector<Range> ranges;                 ///< per drive, what the samples span [m, rad]
  std::vector<std::vector<double>> samples;  ///< per drive, ascending, home among them
  /// Per combination, last drive fastest: displacement of every body, nullopt where
  /// the machine cannot be assembled.
  std::vector<std::optional<std::vector<Transform>>> bodies;
};

/// Tabulates forward kinematics on a grid of at most `nodes` combinations, equally
/// many per drive, spreading from home to neighbours so that every pose continues home's assembly
/// mode. The grid spans the largest part of the drives' ranges in which they can be
/// set independently (nine in ten corners can be assembled), at least a tenth.
/// Without drives: one entry, home.
[[nodiscard]] PoseTable tabulate_poses(const Machine& machine, int nodes);

}  // namespace polyglide
