#include <iostream>

#include "catalog/json_file.hpp"
#include "cli/commands.hpp"
#include "cli/print.hpp"
#include "report/html.hpp"

namespace polyglide {
namespace {

/// The stored run in a file or in a folder. @throws InputError when it is none.
nlohmann::json load_run(const std::filesystem::path& file) {
  nlohmann::json run = read_json(file);
  if (!run.is_object() || run.value("format", nlohmann::json()) != "polyglide/run/1")
    throw InputError({{file.string(), "/format", "",
                       "must be \"polyglide/run/1\": a run that design or optimize stored", ""}});
  return run;
}

}  // namespace

int run_report(CommandLine& line) {
  std::string run, out;
  line.options()
      .add_option("RUN", run, "Stored run: run.json, or the folder it lies in")
      ->required();
  line.options().add_option("-o,--out", out,
                            "The page's file (default: report.html beside the run)");
  if (!line.parse()) return kDone;

  std::filesystem::path file = run;
  if (std::filesystem::is_directory(file)) file /= "run.json";
  const std::filesystem::path page =
      out.empty() ? file.parent_path() / "report.html" : std::filesystem::path(out);
  write_html(load_run(file), page);
  if (line.json())
    print_json({{"report", page.string()}});
  else
    std::cout << page.string() << '\n';
  return kDone;
}

}  // namespace polyglide
