#pragma once

#include <nlohmann/json.hpp>

#include "optimizer/brief.hpp"
#include "optimizer/run_options.hpp"

namespace polyglide {

/// What a design job found.
struct DesignResult {
  bool satisfied = false;      ///< some layout does what the brief asks
  nlohmann::ordered_json run;  ///< the stored run (docs/run-format.md), kind "design"; holds
                               ///< the nearest misses under `nearest` when nothing satisfies
};

/// The main job: from a brief to ranked layouts with dimensions.
///
/// 1. Every distinct layout of the space is found and checked.
/// 2. Those that cannot do what is asked are rejected, with their reasons.
/// 3. Twins with the same kinematics make one family; every family is looked at with the
///    dimensions of the file.
/// 4. The most promising families are tuned, those of known layouts and the best of both
///    sides of a duel in any case.
/// 5. Tuned families that cover the zone and are still determinate at their new
///    dimensions are ranked by score; the best are shown in full.
/// 6. The ranking is held against other weights, and the duel is fought.
///
/// With options.out, verdicts and tunings are kept in options.out/campaign.sqlite as they
/// finish: the same job started again goes on from there. Same result for any number of
/// threads and however often it was interrupted, provenance apart.
/// @throws InputError a space with mistakes, a duel it does not know, a store of another job.
[[nodiscard]] DesignResult run_design(const Brief& brief, const RunOptions& options = {});

}  // namespace polyglide
