#include <fmt/format.h>

#include <iostream>

#include "cli/commands.hpp"
#include "cli/print.hpp"
#include "cli/run_files.hpp"
#include "optimizer/design.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kShownRows = 10;

Json design_json(const Json& run, const std::string& report) {
  Json ranking = Json::array();
  for (const Json& entry : run.at("ranking")) {
    Json row;
    for (const char* key : {"rank", "layout", "known_as", "score", "objectives", "parameters"})
      row[key] = entry.at(key);
    ranking.push_back(std::move(row));
  }
  Json json{{"ranking", std::move(ranking)},
            {"rejected", run.at("counts").at("rejected")},
            {"report", report},
            {"seconds", run.at("provenance").at("seconds")}};
  if (run.contains("nearest")) json["nearest"] = run.at("nearest");
  return json;
}

void print_ranking(const Json& run) {
  std::vector<std::vector<std::string>> rows{{"rank", "layout", "score", "workspace", "mean 1/κ",
                                              "worst 1/κ", "covered", "twins", "choices"}};
  const Json& entries = run.at(run.contains("nearest") ? "nearest" : "ranking");
  for (const Json& entry : entries) {
    if (rows.size() > kShownRows) break;
    const Json& values = entry.at("objectives");
    const Json& known = entry.at("known_as");
    rows.push_back({entry.at("rank").dump(), known.is_null() ? entry.at("layout") : known,
                    fmt::format("{:.4f}", entry.at("score").get<double>()),
                    fmt::format("{:.1f} %", 100 * values.at("workspace").get<double>()),
                    fmt::format("{:.3f}", values.at("conditioning").get<double>()),
                    fmt::format("{:.3f}", values.at("worst_conditioning").get<double>()),
                    fmt::format("{:.1f} %", 100 * values.at("coverage").get<double>()),
                    std::to_string(entry.at("twins").size()), entry.at("title")});
  }
  std::cout << columns(rows);
  if (entries.size() > kShownRows)
    std::cout << fmt::format("{} more in the report\n", entries.size() - kShownRows);
}

void print_design(const Json& run, const std::string& report) {
  const Json& counts = run.at("counts");
  std::cout << run.at("answer").get<std::string>() << "\n\n"
            << fmt::format(
                   "{} combinations, {} distinct layouts, {} families with the motion asked, {} "
                   "tuned, {} satisfy the brief\n\n",
                   counts.at("raw").dump(), counts.at("distinct").dump(),
                   counts.at("families").dump(), counts.at("tuned").dump(),
                   counts.at("satisfying").dump());
  if (run.contains("nearest")) std::cout << "Nearest misses:\n";
  print_ranking(run);
  std::cout << "\nRejected:\n";
  std::vector<std::vector<std::string>> rows;
  for (const auto& [reason, count] : counts.at("rejected").items())
    rows.push_back({"  " + count.dump(), reason});
  std::cout << columns(rows) << '\n'
            << run.at("stability").at("statement").get<std::string>() << '\n';
  if (run.contains("duel")) std::cout << run.at("duel").at("statement").get<std::string>() << '\n';
  std::cout << "\nReport: " << report
            << fmt::format(" ({:.1f} s)\n", run.at("provenance").at("seconds").get<double>());
}

}  // namespace

int run_design(CommandLine& line) {
  std::string file, out;
  line.options().add_option("BRIEF", file, "Brief file: what the machine is for")->required();
  line.options().add_option("-o,--out", out,
                            "Folder for the results (default runs/<name of the brief>)");
  if (!line.parse()) return kDone;

  const Brief brief = load_brief(file);
  StageProgress progress(line.quiet());
  const auto folder = run_folder(out, brief.name);
  const DesignResult result =
      run_design(brief, run_options(line, "design " + file, folder, progress));
  const std::string report = write_run(result.run, folder).string();
  if (line.json())
    print_json(design_json(result.run, report));
  else
    print_design(result.run, report);
  return result.satisfied ? kDone : kNothingSatisfies;
}

}  // namespace polyglide
