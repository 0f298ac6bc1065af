#include <fmt/format.h>

#include <iostream>

#include "cli/commands.hpp"
#include "cli/print.hpp"
#include "cli/run_files.hpp"
#include "optimizer/study.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

Json side_json(const Json& entry) {
  return {{"score", entry.at("score")},
          {"objectives", entry.at("objectives")},
          {"parameters", entry.at("parameters")}};
}

Json study_json(const Json& run, const std::string& report) {
  const Json &best = run.at("ranking").at(0), &given = run.at("ranking").at(1);
  const double before = given.at("score"), after = best.at("score");
  return {{"name", run.at("name")},
          {"best", side_json(best)},
          {"baseline", side_json(given)},
          {"gain", before > 0 ? Json(after / before - 1) : Json(nullptr)},
          {"requirements", run.at("requirements")},
          {"statement", run.at("answer")},
          {"report", report},
          {"seconds", run.at("provenance").at("seconds")}};
}

void print_study(const Json& run, const std::string& report) {
  std::cout << run.at("answer").get<std::string>() << "\n\n";
  std::vector<std::vector<std::string>> rows{{"dimension", "as it stands", "tuned"}};
  const Json &best = run.at("ranking").at(0), &given = run.at("ranking").at(1);
  for (const auto& [name, value] : best.at("parameters").items())
    rows.push_back({name, fmt::format("{:.6g}", given.at("parameters").at(name).get<double>()),
                    fmt::format("{:.6g}", value.get<double>())});
  std::cout << columns(rows) << '\n';
  for (const Json& row : run.at("requirements"))
    std::cout << fmt::format("{}: {} — {} ({})\n", row.at("verdict").get<std::string>(),
                             row.at("name").get<std::string>(), row.at("asked").get<std::string>(),
                             row.at("note").get<std::string>());
  std::cout << "\nReport: " << report
            << fmt::format(" ({:.1f} s)\n", run.at("provenance").at("seconds").get<double>());
}

}  // namespace

int run_optimize(CommandLine& line) {
  std::string file, out;
  line.options()
      .add_option("STUDY", file, "Study file: which machine, and what to turn")
      ->required();
  line.options().add_option("-o,--out", out,
                            "Folder for the results (default runs/<name of the study>)");
  if (!line.parse()) return kDone;

  const Study study = load_study(file);
  StageProgress progress(line.quiet());
  const auto folder = run_folder(out, study.name);
  const StudyResult result =
      run_study(study, run_options(line, "optimize " + file, folder, progress));
  const std::string report = write_run(result.run, folder).string();
  if (line.json())
    print_json(study_json(result.run, report));
  else
    print_study(result.run, report);
  return result.satisfied ? kDone : kNothingSatisfies;
}

}  // namespace polyglide
