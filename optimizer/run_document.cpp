#include "optimizer/run_document.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cmath>
#include <thread>

#include "catalog/catalog.hpp"
#include "catalog/json_file.hpp"
#include "kinematics/mobility.hpp"
#include "kinematics/scene.hpp"
#include "kinematics/workspace.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kVolumeAccuracy = 2e-3;

double value_of(const Parameter& parameter, const ParameterValues& values) {
  const auto found = values.find(parameter.name);
  return found == values.end() ? parameter.value : found->second;
}

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

Json table_json(const Layout& layout, const ParameterValues& values) {
  const std::set<std::string> used = used_names(layout.document);
  Json table = Json::array();
  for (const Parameter& parameter : layout.parameters)
    if (used.contains(parameter.name))
      table.push_back({{"name", parameter.name},
                       {"value", value_of(parameter, values)},
                       {"initial", parameter.value},
                       {"min", parameter.min},
                       {"max", parameter.max},
                       {"unit", unit_of(parameter, layout.units)},
                       {"about", parameter.about}});
  return table;
}

Json triple(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

/// Edges of the zone along base axes.
Vector3 zone_extent(const Zone& zone, const TaskSpace& task) {
  Eigen::AlignedBox3d box;
  for (const Vector3& position : zone_positions(zone, task.rotation_axis, 9, 2))
    box.extend(position);
  return box.sizes();
}

Json workspace_json(const Machine& machine, const Zone& zone, const Vector3& center) {
  WorkspaceOptions options;
  options.accuracy = kVolumeAccuracy;
  Json json = to_json(compute_workspace(machine, options));
  json["zone"] = {{"size", triple(zone_extent(zone, machine.task))}, {"center", triple(center)}};
  json.erase("seconds");  // a stored run is the same whenever it is made, its provenance apart
  return json;
}

}  // namespace

Json layout_json(const ShownLayout& shown, const Zone& zone, std::uint64_t seed) {
  Mechanism mechanism = expand(shown.layout, shown.design.values);
  mechanism.name = shown.id;
  const Machine machine = machine_for(mechanism, shown.task, zone);
  MobilityOptions options;
  options.seed = seed;
  const MobilityReport report = analyse_mobility(machine.model, options);

  Json json;
  json["id"] = shown.id;
  json["known_as"] = name_or_null(shown.known_as);
  json["title"] = shown.title;
  json["choices"] = shown.choices;
  json["check"] = to_json(report, mechanism);
  json["parameters"] = table_json(shown.layout, shown.design.values);
  json["scene"] = scene_of(machine);
  if (!report.modes.empty()) add_mode(json["scene"], report.modes.front(), mechanism);
  json["workspace"] = workspace_json(machine, zone, shown.design.center);
  json["convergence"] = shown.convergence;
  return json;
}

Json values_json(const Layout& layout, const ParameterValues& values) {
  const std::set<std::string> used = used_names(layout.document);
  Json json = Json::object();
  for (const Parameter& parameter : layout.parameters)
    if (used.contains(parameter.name)) json[parameter.name] = value_of(parameter, values);
  return json;
}

Json measures_json(const Measures& measures) {
  Json json;
  for (const Index& index : indices()) json[index.key] = measures[index.key];
  return json;
}

Json name_or_null(const std::string& name) { return name.empty() ? Json(nullptr) : Json(name); }

Provenance::Provenance(const RunOptions& options)
    : options_(options), started_(std::chrono::system_clock::now()) {}

double Provenance::seconds() const {
  return std::chrono::duration<double>(std::chrono::system_clock::now() - started_).count();
}

Json Provenance::json() const {
  const auto started = std::chrono::time_point_cast<std::chrono::seconds>(started_);
  return {{"version", options_.version},
          {"seed", options_.seed},
          {"threads", options_.threads},
          {"command", options_.command},
          {"started", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(started))},
          {"seconds", seconds()},
          {"machine", fmt::format("{} cores", std::thread::hardware_concurrency())},
          {"hashes", hashes_},
          {"tolerances", {{"volume", kVolumeAccuracy}, {"rank gap", 1e3}}}};
}

std::string catalog_hash() {
  std::string text;
  for (const std::string& name : catalog_names())
    text += content_hash(read_text(data_directory() / "catalog" / "data" / (name + ".json")));
  return content_hash(text);
}

}  // namespace polyglide
