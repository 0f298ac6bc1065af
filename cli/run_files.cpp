#include "cli/run_files.hpp"

#include "catalog/json_file.hpp"
#include "report/html.hpp"
#include "report/summary.hpp"

namespace polyglide {

void StageProgress::update(const RunProgress& progress) {
  if (progress.stage != stage_) {
    line_.reset();  // wipes the old line before the new one is drawn
    line_ = std::make_unique<Progress>(progress.stage, quiet_);
    stage_ = progress.stage;
  }
  line_->update(progress.done, progress.total);
}

RunOptions run_options(const CommandLine& line, const std::string& command,
                       const std::filesystem::path& out, StageProgress& progress) {
  RunOptions options;
  options.seed = line.seed();
  options.threads = line.threads();
  options.out = out;
  options.version = POLYGLIDE_VERSION;
  options.command = "polyglide " + command + " --seed " + std::to_string(line.seed());
  options.progress = [&progress](const RunProgress& state) { progress.update(state); };
  return options;
}

std::filesystem::path run_folder(const std::string& asked, const std::string& name) {
  return asked.empty() ? std::filesystem::path("runs") / name : std::filesystem::path(asked);
}

std::filesystem::path write_run(const nlohmann::ordered_json& run,
                                const std::filesystem::path& folder) {
  const nlohmann::json plain = run;
  write_atomically(folder / "run.json", run.dump() + '\n');
  write_atomically(folder / "summary.json", summary_json(plain).dump(2) + '\n');
  write_atomically(folder / "summary.md", summary_markdown(plain));
  const auto report = folder / "report.html";
  write_html(plain, report);
  return report;
}

}  // namespace polyglide
