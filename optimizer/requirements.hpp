#pragma once

#include <nlohmann/json.hpp>

#include "catalog/problems.hpp"
#include "optimizer/indices.hpp"

namespace polyglide {

/// Reads what briefs and studies have in common: `zone`, `limits`, `envelope` and
/// the weights under `weights_key`. Lengths in mm, angles in degrees.
/// Mistakes go to `problems`: a zone with no or with two shapes, an objective that is
/// no weighable index (with the nearest word), weights that are all zero.
[[nodiscard]] Requirements read_requirements(const nlohmann::json& document,
                                             const char* weights_key, Problems& problems);

/// A name becomes a folder: letters, digits, '-', '_' and '.', not leading with a dot.
void check_name(const nlohmann::json& document, Problems& problems);

/// Member of an object, or what it is when absent.
[[nodiscard]] inline std::string text_or(const nlohmann::json& object, const char* key,
                                         const std::string& otherwise) {
  return object.contains(key) && object.at(key).is_string() ? object.at(key).get<std::string>()
                                                            : otherwise;
}

/// The requirements as words, for a stored run: {name, asked}.
[[nodiscard]] nlohmann::ordered_json requirements_json(const Requirements& requirements);

}  // namespace polyglide
