#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinematics/model.hpp"

namespace polyglide {

/// How far a way through joints lets a point of the platform be from a point of the base: their
/// distance, or its part across a direction fixed in the base, is at most that of the links
/// stretched out; the part along it lies in a range.
struct ReachBound {
  Vector3 base, platform;        ///< the two points at home [m]
  std::optional<Vector3> along;  ///< unit; what is left out of the distance
  double most = 0;               ///< [m], slack of 1e-9 m per link included
  Range span;                    ///< along the direction [m], slack included; infinite without one
};

/// What the links along a way of joints from base to platform allow; empty where slides without an
/// end leave nothing to say.
/// @param ignored limits that do not count: slides are endless then
[[nodiscard]] std::vector<ReachBound> reach_bounds(const Model& model,
                                                   const std::vector<LoopStep>& way,
                                                   const std::vector<std::string>& ignored);

}  // namespace polyglide
