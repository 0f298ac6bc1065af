#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "catalog/json_file.hpp"

namespace polyglide::fixtures {

/// A small stored run that has every part.
inline nlohmann::json sample() {
  return read_json(std::filesystem::path(POLYGLIDE_SOURCE_DIR) / "tests/report/sample_run.json");
}

}  // namespace polyglide::fixtures
