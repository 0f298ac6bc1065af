#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace polyglide {

/// What a stored run found, to be kept under version control: requirements,
/// counts, ranking with dimensions, why layouts were rejected, rank stability
/// and duel. Numbers have four significant digits and there are no times, so a
/// difference between two summaries is a difference in results.
/// @param run a stored run (docs/run-format.md); absent parts are left out.

/// As Markdown with tables.
[[nodiscard]] std::string summary_markdown(const nlohmann::json& run);

/// As JSON, "format": "polyglide/summary/1"; keys in reading order.
[[nodiscard]] nlohmann::ordered_json summary_json(const nlohmann::json& run);

}  // namespace polyglide
