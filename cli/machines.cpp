#include "cli/machines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <utility>

#include "catalog/catalog.hpp"
#include "kinematics/evaluate.hpp"

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
  try {
    const std::vector<double> value = parse_numbers(setting.substr(equals + 1), "--set");
    if (value.size() == 1) return {name, value.front()};
  } catch (const InputError&) {  // said below, with the whole word
  }
  throw InputError({wrong_argument(setting, "--set takes one finite number for a parameter")});
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

void remark_unknown_limits(const std::vector<std::string>& ignored, const Machine& machine) {
  for (const std::string& word : ignored) {
    std::vector<std::string> names = Evaluator(machine).limit_names();
    names.emplace_back("singularity");
    const bool known = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return name == word || name.substr(0, name.find(' ')) == word;
    });
    if (!known)
      std::cerr << fmt::format("{} has no limit {}: {} is not ignored\n",
                               machine.model.mechanism.name, word, word);
  }
}

}  // namespace polyglide
