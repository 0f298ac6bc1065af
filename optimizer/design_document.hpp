#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "optimizer/brief.hpp"
#include "optimizer/families.hpp"
#include "optimizer/run_options.hpp"
#include "optimizer/screening.hpp"

namespace polyglide {

/// Everything a finished design job knows; views into what it holds.
struct DesignFindings {
  const Brief& brief;
  const RunOptions& options;
  const Space& space;
  const Enumeration& enumeration;
  const Rejections& rejections;
  const std::vector<Family>& families;    ///< with the motion asked and a determinate verdict
  std::vector<const Family*> tuned;       ///< best first
  std::vector<const Family*> satisfying;  ///< of the tuned: those that do what is asked, best first
};

/// The stored run of a design job, without its provenance. Shown in full are the best
/// layouts, as many as the brief asks, and both sides of the duel; when nothing
/// satisfies, the nearest misses. Same result for any number of threads.
/// Cost: about a second per layout shown in full.
[[nodiscard]] nlohmann::ordered_json design_document(const DesignFindings& findings);

}  // namespace polyglide
