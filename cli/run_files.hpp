#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command_line.hpp"
#include "cli/progress.hpp"
#include "optimizer/run_options.hpp"

namespace polyglide {

/// Shows one progress line per stage of a run.
class StageProgress {
 public:
  explicit StageProgress(bool quiet) : quiet_(quiet) {}
  void update(const RunProgress& progress);

 private:
  bool quiet_;
  std::string stage_;
  std::unique_ptr<Progress> line_;
};

/// How a run is carried out, from the options all commands share. `progress` must
/// outlive the run.
[[nodiscard]] RunOptions run_options(const CommandLine& line, const std::string& command,
                                     const std::filesystem::path& out, StageProgress& progress);

/// Where a run's files go: as asked, else runs/<name>.
[[nodiscard]] std::filesystem::path run_folder(const std::string& asked, const std::string& name);

/// Writes run.json, summary.md, summary.json and report.html, each whole or not at all.
/// @return the report's path
std::filesystem::path write_run(const nlohmann::ordered_json& run,
                                const std::filesystem::path& folder);

}  // namespace polyglide
