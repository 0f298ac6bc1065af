#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace polyglide {

/// A function of several variables to be maximised inside a box. Knows nothing of robots.
struct SearchProblem {
  std::vector<double> lower, upper;  ///< bounds; equal where a variable is fixed
  std::vector<double> start;         ///< evaluated first; clamped to the bounds
  /// To be maximised. A value that is not finite means "worst of all". Called by the
  /// searching thread only, and must not depend on earlier calls.
  std::function<double(const std::vector<double>&)> value;
};

struct SearchOptions {
  int evaluations = 300;      ///< calls of the function, never exceeded; at least 1
  std::uint64_t seed = 1;     ///< of the global stage
  double global_share = 0.8;  ///< part of the evaluations for the global stage, 0..1
  double tolerance = 1e-4;    ///< the local stage stops at steps below this part of each range
};

/// What a search found and why it ended.
struct SearchSummary {
  std::vector<double> best;
  double value = 0;     ///< at `best`, never below that at the start
  int evaluations = 0;  ///< calls made
  std::vector<std::pair<int, double>>
      history;          ///< (calls so far, best value), one entry per improvement
  std::string stopped;  ///< "converged", "evaluations used up" or "nothing to turn"
  bool usable = false;  ///< some value was finite; else `best` is the start
};

/// Maximises: a global stage (controlled random search with local mutation, from the
/// start and a seeded population), then a local one from its best (Subplex).
///
/// Runs on the calling thread alone, and the generator of the global stage belongs to
/// that thread and is seeded here: the same problem and options give the same bits
/// whatever else runs. Where value() waits for parallel work, isolate the search
/// (tbb::this_task_arena::isolate), or the waiting thread may run another one inside it.
/// An exception of value() ends the search and is passed on.
/// @throws std::invalid_argument bounds or start that do not fit each other.
/// Source: Kaelo & Ali, JOTA 130 (2006), for the global; Rowan (1990), for the local
/// stage; both as in NLopt (GN_CRS2_LM, LN_SBPLX).
[[nodiscard]] SearchSummary maximise(const SearchProblem& problem,
                                     const SearchOptions& options = {});

}  // namespace polyglide
