#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "catalog/layout.hpp"
#include "optimizer/indices.hpp"
#include "optimizer/search.hpp"

namespace polyglide {

/// What dimensions must keep beside their bounds: an expression over the layout's
/// parameters, in the file's units.
struct Constraint {
  std::string about, expression;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// Value of a constraint's expression at parameter values; those left out are the layout's.
/// @throws InputError when the expression has an error.
[[nodiscard]] double evaluate(const Constraint& constraint, const Layout& layout,
                              const ParameterValues& values);

/// A layout to be tuned.
struct TuneProblem {
  const Layout& layout;
  const TaskSpace& task;  ///< does not change with dimensions
  const Requirements& requirements;
  std::vector<std::string> turn;  ///< parameters that may change, each with min < max
  std::vector<Constraint> constraints;
  ParameterValues fixed = {};            ///< of other parameters, where they differ from the file
  std::function<void()> evaluated = {};  ///< called after every look at a design
};

/// The parameters of a layout that may be turned: those with min < max that it uses.
[[nodiscard]] std::vector<std::string> turnable(const Layout& layout);

/// One design: dimensions, where the zone lies in it, and what it is worth.
struct Design {
  ParameterValues values;            ///< of the turned and `fixed` parameters, file units
  Vector3 center = Vector3::Zero();  ///< of the zone [m]
  Measures measures;                 ///< at the fineness of the last look
  double score = 0;
};

/// The dimensions of the file, with the zone where it fits best.
[[nodiscard]] Design place_zone(const TuneProblem& problem, int evaluations, std::uint64_t seed,
                                const Fineness& fineness = kSearchFineness);

struct Tuned {
  Design initial, best;  ///< both looked at finely; the best is never worse
  SearchSummary search;  ///< of the main stage: history of the score, why it stopped
  std::size_t poses = 0;
};

/// Turns the parameters and the place of the zone until the score is best.
/// Starts at the file's dimensions. Designs that cannot be assembled or break a
/// constraint rank below all others, by how much they break. Runs on the calling
/// thread, isolated from other parallel work: same bits for any thread count.
/// Cost: evaluations × about 0.5 ms for four-limb layouts, and a final look of about 15 ms.
[[nodiscard]] Tuned tune(const TuneProblem& problem, int evaluations, std::uint64_t seed);

}  // namespace polyglide
