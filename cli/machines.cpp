#include "cli/machines.hpp"

#include <utility>

#include "catalog/catalog.hpp"

namespace polyglide {
namespace {

/// Runs `step` and keeps what is wrong with the user's input for later.
void collect_mistakes(std::vector<Diagnostic>& mistakes, const auto& step) {
  try {
    step();
  } catch (const InputError& error) {
    mistakes.insert(mistakes.end(), error.diagnostics().begin(), error.diagnostics().end());
  }
}

std::pair<std::string, double> parse_setting(const std::string& setting) {
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError({wrong_argument(setting, "--set takes parameter=value")});
  }
  const std::string name = setting.substr(0, equals);
  const std::vector<double> value = parse_numbers(setting.substr(equals + 1), "--set " + name);
  if (value.size() != 1) {
    throw InputError({wrong_argument(setting, "--set takes one number for a parameter")});
  }
  return {name, value.front()};
}

}  // namespace

void add_machine_options(CLI::App& app, MachineOptions& options, bool required) {
  app.add_option("NAME", options.names, "Catalog entry, or a mechanism or layout file")
      ->type_name("")
      ->required(required);
  app.add_option("--set", options.settings, "Give a parameter another value, in the file's units")
      ->type_name("PARAMETER=VALUE")
      ->expected(1)
      ->take_all();
}

std::vector<ChosenMachine> load_machines(const MachineOptions& options) {
  std::vector<Diagnostic> mistakes;
  ParameterValues values;
  for (const std::string& setting : options.settings) {
    collect_mistakes(mistakes, [&] {
      const auto [name, value] = parse_setting(setting);
      values[name] = value;
    });
  }
  std::vector<ChosenMachine> machines;
  for (const std::string& name : options.names) {
    collect_mistakes(mistakes, [&] {
      Layout layout = find_layout(name);
      Mechanism mechanism = expand(layout, values);
      machines.push_back({std::move(layout), std::move(mechanism)});
    });
  }
  if (!mistakes.empty()) throw InputError(std::move(mistakes));
  return machines;
}

}  // namespace polyglide
