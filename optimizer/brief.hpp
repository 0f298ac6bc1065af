#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "optimizer/indices.hpp"

namespace polyglide {

/// Two arrangements to be held against each other.
struct DuelRequest {
  std::string a, b;  ///< catalog names
  std::vector<std::string>
      by;  ///< choices of the space that make an arrangement; empty: the layouts themselves
};

/// What a machine is wanted for, and where to look for it ("polyglide/brief/1").
struct Brief {
  std::string name, title, about;
  std::string file;                     ///< as the user gave it, for messages
  std::filesystem::path space;          ///< file of the design space
  std::string motion;                   ///< letters of X Y Z A B C, ascending
  int translations = 0, rotations = 0;  ///< of that motion
  int drives = 0;
  Requirements requirements;
  int tune_candidates = 24, tune_evaluations = 300, report_layouts = 6;
  std::optional<DuelRequest> duel;
  nlohmann::json document;
};

/// Reads a brief.
/// @throws InputError with every mistake: against the schema; a motion that is none
///         (with the nearest), a tilt for a motion without rotation, an objective that is
///         no index (with the nearest), a zone without or with two shapes.
[[nodiscard]] Brief load_brief(const std::filesystem::path& file);

/// The same from a document in memory; `file` labels messages, and the space's path is
/// relative to it.
[[nodiscard]] Brief parse_brief(nlohmann::json document, const std::string& file);

/// "3T1R about a horizontal axis (XYZA)".
[[nodiscard]] std::string motion_text(const Brief& brief);

}  // namespace polyglide
