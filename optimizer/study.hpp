#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "optimizer/run_options.hpp"
#include "optimizer/tune.hpp"

namespace polyglide {

/// One layout whose dimensions are to be improved ("polyglide/study/1").
struct Study {
  std::string name, title, about;
  std::string file;  ///< as the user gave it, for messages
  Layout machine;
  std::vector<std::string> turn;  ///< parameters
  std::vector<Constraint> constraints;
  Requirements requirements;
  int evaluations = 600;
  nlohmann::json document;
};

/// Reads a study and the machine it names: a catalog entry, or a file relative to the study's.
/// @throws InputError with every mistake: against the schema; a parameter that the
///         machine does not have (with the nearest) or that has no room between min and max;
///         an error in a constraint's expression; what read_requirements() refuses.
[[nodiscard]] Study load_study(const std::filesystem::path& file);

/// The same from a document in memory; `file` labels messages.
[[nodiscard]] Study parse_study(nlohmann::json document, const std::string& file);

/// What came out of a study.
struct StudyResult {
  Tuned tuned;                 ///< `initial` is the machine as it stands
  bool satisfied = false;      ///< the best covers the zone and keeps all constraints
  nlohmann::ordered_json run;  ///< the stored run (docs/run-format.md), kind "study"
};

/// Tunes the machine and compares it with how it stands, both under the same fine look.
/// Same result for any number of threads.
[[nodiscard]] StudyResult run_study(const Study& study, const RunOptions& options = {});

}  // namespace polyglide
