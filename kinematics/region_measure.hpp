#pragma once

#include <cstdint>
#include <vector>

#include "kinematics/region.hpp"

namespace polyglide {

/// How finely the boundary of a region is resolved.
struct RegionFineness {
  int nodes = 200000;   ///< of the grid
  int probes = 8;       ///< places tried in each cell beside the boundary
  int split = 4;        ///< boundary cells are cut into split³ for the bounds
  int strata = 3;       ///< and sampled in strata³ jittered places per round
  int rounds = 8;       ///< most rounds
  int bisections = 12;  ///< per grid edge through the boundary
};

/// RegionFineness for an accuracy [relative, of the volume], for poses in closed form
/// (cheap) or not.
[[nodiscard]] RegionFineness region_fineness(double accuracy, bool closed_form);

/// Size and conditioning of a region.
struct RegionMeasure {
  double value = 0;                      ///< [m³], or [m²], [m] in fewer directions; 1 in none
  double lower = 0, upper = 0;           ///< sub-cells wholly in; not wholly out
  double standard_error = 0;             ///< of value, from the scatter between rounds
  double mean = 0, worst = 0, best = 0;  ///< 1/κ
  std::vector<double> layers;            ///< value per layer of cells along z
};

/// Cells with all corners inside count whole. Cells that the boundary crosses, and
/// their neighbours where a probe disagrees with the corners, are sampled in
/// jittered strata until the standard error falls below accuracy × value, so that
/// faces parallel to the grid do no harm.
[[nodiscard]] RegionMeasure measure_region(const Probe& probe, const Region& region,
                                           const RegionFineness& fineness, double accuracy);

}  // namespace polyglide
