#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <iostream>

#include "catalog/architecture.hpp"
#include "catalog/catalog.hpp"
#include "cli/catalog_search.hpp"
#include "cli/commands.hpp"
#include "cli/machines.hpp"
#include "cli/print.hpp"
#include "kinematics/mobility.hpp"

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

/// The motion of every machine, which takes a rank decision or a few for each.
std::vector<CatalogRow> rows_of(std::vector<ChosenMachine> machines, std::uint64_t seed) {
  std::vector<CatalogRow> rows(machines.size());
  tbb::parallel_for(std::size_t{0}, machines.size(), [&](std::size_t i) {
    MobilityOptions how;
    how.seed = seed;
    how.evidence = false;
    const Mechanism& mechanism = machines[i].mechanism;
    const MobilityReport report = analyse_mobility(compile(mechanism), how);
    rows[i].motion = report.pattern;
    rows[i].axes = report.axes;
    rows[i].architecture = architecture(mechanism);
    rows[i].machine = std::move(machines[i]);
  });
  return rows;
}

ordered_json describe(const CatalogRow& row) {
  const auto& [layout, mechanism] = row.machine;
  ordered_json parameters = ordered_json::array();
  for (const Parameter& parameter : layout.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"value", parameter.value},
                          {"min", parameter.min},
                          {"max", parameter.max},
                          {"unit", unit_of(parameter, layout.units)},
                          {"about", parameter.about}});
  }
  const std::vector<std::string> drives = drive_names(mechanism);
  return {
      {"name", layout.name},
      {"title", layout.title},
      {"source", layout.source},
      {"about", layout.about},
      {"motion", row.motion},
      {"axes", row.axes},
      {"architecture", row.architecture},
      {"drives", {{"count", drives.size()}, {"names", drives}, {"kinds", drive_kinds(mechanism)}}},
      {"bodies", mechanism.bodies.size()},
      {"joints", mechanism.joints.size()},
      {"limits", listed_limits(mechanism)},
      {"parameters", parameters}};
}

void print_list(const std::vector<CatalogRow>& machines) {
  std::vector<std::vector<std::string>> rows{{"NAME", "MOTION", "DRIVES", "ARCHITECTURE", "TITLE"}};
  for (const CatalogRow& row : machines)
    rows.push_back({row.machine.layout.name, row.motion,
                    std::to_string(drive_kinds(row.machine.mechanism).size()), row.architecture,
                    row.machine.layout.title});
  std::cout << columns(rows);
}

void print_entry(const CatalogRow& row) {
  const auto& [layout, mechanism] = row.machine;
  std::cout << layout.name << ": " << layout.title << "\n";
  if (!layout.source.empty()) std::cout << "source: " << layout.source << "\n";
  if (!layout.about.empty()) std::cout << layout.about << "\n";
  std::cout << fmt::format("architecture: {}, motion: {}{}\n", row.architecture, row.motion,
                           row.axes.empty() ? "" : " (" + row.axes + ")");
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
  CatalogQuery query;
  add_machine_options(line.options(), options, false);
  add_search_options(line.options(), query);
  if (!line.parse()) return kDone;

  check_query(query);
  const bool list = options.names.empty();
  if (list) options.names = catalog_names();
  const std::vector<CatalogRow> all = rows_of(load_machines(options), line.seed());
  std::vector<CatalogRow> found;
  for (const CatalogRow& row : all)
    if (matches(query, row)) found.push_back(row);
  if (found.empty() && !line.quiet()) std::cerr << "polyglide: " << no_match(query, all) << "\n";

  if (line.json()) {
    std::vector<ordered_json> documents;
    for (const CatalogRow& row : found) documents.push_back(describe(row));
    print_json(list || found.empty() ? ordered_json(documents) : one_or_all(documents));
  } else if (list) {
    if (!found.empty()) print_list(found);
  } else {
    for (const CatalogRow& row : found) print_entry(row);
  }
  return kDone;
}

}  // namespace polyglide
