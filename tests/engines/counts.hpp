#pragma once

#include <iosfwd>

#include "engines/constraint_system.hpp"
#include "kinematics/mobility.hpp"

namespace polyglide::engines {

/// What an engine finds, in the words of our report.
struct Counts {
  double residual = 0;  ///< largest, lengths by the machine's size
  int mobility = 0, held_mobility = 0;
  int platform = 0, held_platform = 0;

  /// The residual does not count.
  friend bool operator==(const Counts& a, const Counts& b);
  friend std::ostream& operator<<(std::ostream& out, const Counts& counts);
};

/// Ranks of a system whose lengths are measured in `size`.
[[nodiscard]] Counts counts_of(const ConstraintSystem& system, double size);

/// polyglide's report, without evidence.
[[nodiscard]] MobilityReport report_of(const Model& model);

/// polyglide's counts at home.
[[nodiscard]] Counts counts_of(const Model& model);

}  // namespace polyglide::engines
