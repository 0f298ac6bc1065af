#include <filesystem>
#include <iostream>

#include "catalog/json_file.hpp"
#include "catalog/write_mjcf.hpp"
#include "catalog/write_urdf.hpp"
#include "cli/commands.hpp"
#include "cli/machines.hpp"
#include "cli/print.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

/// What a machine becomes: a JSON document, or texts that JSON only wraps.
struct Exported {
  Json document;          ///< what --json prints
  std::string text;       ///< what goes to standard output or into the file asked for
  std::string beside;     ///< a second text for a file beside it; may be empty
  std::string extension;  ///< of that second file
};

Exported as_mechanism(const Mechanism& mechanism) {
  const Json document = to_json(mechanism);
  return {document, document.dump(2) + "\n", "", ""};
}

Exported as_mjcf(const Mechanism& mechanism) {
  const std::string xml = to_mjcf(mechanism);
  return {{{"mjcf", xml}}, xml, "", ""};
}

Exported as_urdf(const Mechanism& mechanism) {
  const UrdfFiles files = to_urdf(mechanism);
  return {{{"urdf", files.urdf}, {"yaml", files.loops}}, files.urdf, files.loops, ".yaml"};
}

/// A format that machines can be written in.
struct ExportFormat {
  std::string name;
  bool is_json;  ///< several machines make an array
  Exported (*write)(const Mechanism&);
};

const std::vector<ExportFormat> kFormats{
    {"mechanism", true, as_mechanism}, {"mjcf", false, as_mjcf}, {"urdf", false, as_urdf}};

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

/// The file for the second text: the name asked for with the other extension.
std::filesystem::path file_beside(const std::filesystem::path& file, const Exported& exported) {
  std::filesystem::path beside = file;
  beside.replace_extension(exported.extension);
  if (beside == file)
    throw InputError({wrong_argument(file.string(),
                                     "-o names the first of two files; the other "
                                     "one ends in " +
                                         exported.extension)});
  return beside;
}

void write_files(const CommandLine& line, const std::filesystem::path& file,
                 const Exported& exported) {
  Json written{{"written", file.string()}};
  std::string list = file.string();
  if (!exported.beside.empty()) {
    const std::filesystem::path beside = file_beside(file, exported);
    write_atomically(beside, exported.beside);
    written["beside"] = beside.string();
    list += " and " + beside.string();
  }
  write_atomically(file, exported.text);
  if (line.json())
    print_json(written);
  else if (!line.quiet())
    std::cerr << "wrote " << list << "\n";
}

}  // namespace

int run_export(CommandLine& line) {
  MachineOptions options;
  std::string format_name, file;
  add_machine_options(line.options(), options);
  line.options()
      .add_option("--as", format_name, "Format: mechanism, mjcf (MuJoCo) or urdf")
      ->required()
      ->type_name("FORMAT");
  line.options()
      .add_option("-o,--output", file,
                  "Write to this file instead of standard output; urdf also writes the loops "
                  "to a .yaml beside it")
      ->type_name("FILE");
  if (!line.parse()) return kDone;

  const ExportFormat& format = find_format(format_name);
  if (!format.is_json && options.names.size() > 1 && (!line.json() || !file.empty()))
    throw InputError({wrong_argument(options.names[1],
                                     "--as " + format.name + " writes one machine at a time")});
  std::vector<Exported> machines;
  for (const ChosenMachine& machine : load_machines(options))
    machines.push_back(format.write(machine.mechanism));

  std::vector<Json> documents;
  for (const Exported& machine : machines) documents.push_back(machine.document);
  if (!file.empty()) {
    Exported& first = machines.front();
    if (machines.size() > 1) first.text = one_or_all(documents).dump(2) + "\n";
    write_files(line, file, first);
  } else if (line.json() || format.is_json) {
    print_json(one_or_all(std::move(documents)));
  } else {
    std::cout << machines.front().text;
    if (!machines.front().beside.empty() && !line.quiet())
      std::cerr << "this is the tree alone; with -o FILE the closed loops are written beside it\n";
  }
  return kDone;
}

}  // namespace polyglide
