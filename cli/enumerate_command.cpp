#include <fmt/format.h>

#include <filesystem>
#include <iostream>

#include "cli/commands.hpp"
#include "cli/print.hpp"
#include "cli/progress.hpp"
#include "synthesis/enumerate.hpp"

namespace polyglide {
namespace {

void print_page(const nlohmann::ordered_json& result, const Enumeration& found) {
  std::cout << fmt::format("{} combinations, {} distinct layouts ({:.1f} s, {} newly checked)\n",
                           found.raw, found.candidates.size(), found.seconds, found.checked);
  std::vector<std::vector<std::string>> rows;
  for (const auto& [verdict, count] : result["by_verdict"].items())
    rows.push_back({"  " + verdict, count.dump()});
  std::cout << columns(rows) << "why the others are rejected:\n";
  rows.clear();
  for (const auto& [reason, count] : result["by_reason"].items())
    rows.push_back({"  " + count.dump(), reason});
  for (const auto& [reason, count] : result["unbuildable"].items())
    rows.push_back({"  " + count.dump(), "cannot be built: " + reason});
  std::cout << columns(rows);
  for (const auto& [name, id] : found.known)
    std::cout << fmt::format("  contains {} as {}\n", name, id);
  std::cout << "stored in " << found.store << "\n";
}

}  // namespace

int run_enumerate(CommandLine& line) {
  std::string file, store_file;
  line.options().add_option("SPACE", file, "Design-space file")->required()->type_name("");
  line.options().add_option("-o,--store", store_file,
                            "Store of finished verdicts (default: runs/SPACE.sqlite)");
  if (!line.parse()) return kDone;

  const Space space = load_space(file);
  // The default name carries the content, so that an edited space starts anew.
  if (store_file.empty())
    store_file = fmt::format("runs/{}-{}.sqlite", space.name, space.hash.substr(0, 8));
  Store store(store_file, campaign_identity(space, line.seed()));
  EnumerationOptions options;
  options.threads = line.threads();
  options.seed = line.seed();
  options.store = &store;
  Progress progress("enumerating " + space.name, line.quiet());
  options.progress = [&progress](const EnumerationProgress& at) {
    progress.update(static_cast<double>(at.done), static_cast<double>(at.total));
  };
  const Enumeration found = enumerate(space, options);
  const nlohmann::ordered_json result = to_json(found);
  if (line.json())
    print_json(result);
  else
    print_page(result, found);
  return kDone;
}

}  // namespace polyglide
