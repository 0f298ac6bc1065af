#pragma once

#include <map>
#include <string>

#include "kinematics/region.hpp"

namespace polyglide {

/// The boundary where grid edges cross it, found by bisection.
struct Boundary {
  std::map<std::string, double> limits;  ///< share of crossings by the limit met first outside
  Bounds extent;                         ///< of the crossings
};
[[nodiscard]] Boundary find_boundary(const Probe& probe, const Region& region, int bisections);

}  // namespace polyglide
