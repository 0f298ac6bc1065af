#include <iostream>

#include "catalog/json_file.hpp"
#include "cli/commands.hpp"
#include "cli/machines.hpp"
#include "cli/print.hpp"

namespace polyglide {
namespace {

/// A format that machines can be written in.
struct ExportFormat {
  std::string name;
  nlohmann::ordered_json (*write)(const Mechanism&);
};

const std::vector<ExportFormat> kFormats{{"mechanism", to_json}};

const ExportFormat& find_format(const std::string& name) {
  std::vector<std::string> names;
  for (const ExportFormat& format : kFormats) {
    if (format.name == name) return format;
    names.push_back(format.name);
  }
  std::string known;
  for (const std::string& word : names) known += (known.empty() ? "" : ", ") + word;
  throw InputError(
      {wrong_argument(name, "--as takes one of: " + known, nearest_word(name, names))});
}

}  // namespace

int run_export(CommandLine& line) {
  MachineOptions options;
  std::string format_name, file;
  add_machine_options(line.options(), options);
  line.options()
      .add_option("--as", format_name, "Format: mechanism")
      ->required()
      ->type_name("FORMAT");
  line.options()
      .add_option("-o,--output", file, "Write to this file instead of standard output")
      ->type_name("FILE");
  if (!line.parse()) return kDone;

  const ExportFormat& format = find_format(format_name);
  std::vector<nlohmann::ordered_json> documents;
  for (const ChosenMachine& machine : load_machines(options)) {
    documents.push_back(format.write(machine.mechanism));
  }
  if (file.empty()) {
    print_json(one_or_all(documents));
    return kDone;
  }
  write_atomically(file, one_or_all(documents).dump(2) + "\n");
  if (line.json())
    print_json(nlohmann::ordered_json{{"written", file}});
  else if (!line.quiet())
    std::cerr << "wrote " << file << "\n";
  return kDone;
}

}  // namespace polyglide
