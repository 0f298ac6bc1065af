#include <fmt/format.h>

#include <iostream>

#include "catalog/catalog.hpp"
#include "cli/commands.hpp"
#include "cli/machines.hpp"
#include "cli/print.hpp"

namespace polyglide {
namespace {

using nlohmann::ordered_json;

/// Unit of a parameter as its file writes it; "" for a plain number.
std::string unit_of(const Parameter& parameter, const Units& units) {
  switch (parameter.quantity) {
    case Quantity::length:
      return units.length;
    case Quantity::angle:
      return units.angle;
    case Quantity::none:
      break;
  }
  return "";
}

std::vector<std::string> drive_names(const Mechanism& mechanism) {
  std::vector<std::string> names;
  for (const Joint& joint : mechanism.joints)
    names.insert(names.end(), joint.driven.size(), joint.name);
  return names;
}

ordered_json describe(const ChosenMachine& machine) {
  const auto& [layout, mechanism] = machine;
  ordered_json parameters = ordered_json::array();
  for (const Parameter& parameter : layout.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"value", parameter.value},
                          {"min", parameter.min},
                          {"max", parameter.max},
                          {"unit", unit_of(parameter, layout.units)},
                          {"about", parameter.about}});
  }
  ordered_json limits = ordered_json::array();
  for (const HalfSpaceLimit& limit : mechanism.limits) limits.push_back(limit.name);
  const std::vector<std::string> drives = drive_names(mechanism);
  return {{"name", layout.name},
          {"title", layout.title},
          {"source", layout.source},
          {"about", layout.about},
          {"drives", {{"count", drives.size()}, {"names", drives}}},
          {"bodies", mechanism.bodies.size()},
          {"joints", mechanism.joints.size()},
          {"limits", limits},
          {"parameters", parameters}};
}

void print_list(const std::vector<ChosenMachine>& machines) {
  std::vector<std::vector<std::string>> rows{{"NAME", "DRIVES", "TITLE", "PARAMETERS"}};
  for (const auto& [layout, mechanism] : machines) {
    std::string parameters;
    for (const Parameter& parameter : layout.parameters) {
      parameters += (parameters.empty() ? "" : " ") + parameter.name;
    }
    rows.push_back(
        {layout.name, std::to_string(drive_names(mechanism).size()), layout.title, parameters});
  }
  std::cout << columns(rows);
}

void print_entry(const ChosenMachine& machine) {
  const auto& [layout, mechanism] = machine;
  std::cout << layout.name << ": " << layout.title << "\n";
  if (!layout.source.empty()) std::cout << "source: " << layout.source << "\n";
  if (!layout.about.empty()) std::cout << layout.about << "\n";
  std::cout << fmt::format("bodies: {}, joints: {}, drives: {}\n", mechanism.bodies.size(),
                           mechanism.joints.size(), fmt::join(drive_names(mechanism), " "));
  std::vector<std::vector<std::string>> rows;
  for (const Parameter& parameter : layout.parameters) {
    rows.push_back({"  " + parameter.name,
                    fmt::format("{:g} {}", parameter.value, unit_of(parameter, layout.units)),
                    parameter.min < parameter.max
                        ? fmt::format("{:g} … {:g}", parameter.min, parameter.max)
                        : std::string("fixed"),
                    parameter.about});
  }
  std::cout << columns(rows);
}

}  // namespace

int run_catalog(CommandLine& line) {
  MachineOptions options;
  add_machine_options(line.options(), options, false);
  if (!line.parse()) return kDone;

  const bool list = options.names.empty();
  if (list) options.names = catalog_names();
  const std::vector<ChosenMachine> machines = load_machines(options);
  if (line.json()) {
    std::vector<ordered_json> documents;
    for (const ChosenMachine& machine : machines) documents.push_back(describe(machine));
    print_json(list ? ordered_json(documents) : one_or_all(documents));
  } else if (list) {
    print_list(machines);
  } else {
    for (const ChosenMachine& machine : machines) print_entry(machine);
  }
  return kDone;
}

}  // namespace polyglide
