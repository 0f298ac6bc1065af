#include "optimizer/requirements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numbers>

namespace polyglide {
namespace {

using nlohmann::json;

constexpr double kMillimetre = 1e-3, kDegree = std::numbers::pi / 180;

Vector3 millimetres(const json& list) {
  return kMillimetre * Vector3(list.at(0), list.at(1), list.at(2));
}

Zone read_zone(const json& document, Problems& problems) {
  Zone zone;
  if (!document.contains("zone")) {
    problems.add_missing(document, "\"zone\" must be given: where the tool has to reach");
    return zone;
  }
  const json& value = document.at("zone");
  if (value.contains("size") == value.contains("cylinder"))
    problems.add(value, "must hold either \"size\" or \"cylinder\"");
  if (value.contains("size")) zone.size = millimetres(value.at("size"));
  if (value.contains("cylinder")) {
    zone.shape = Zone::Shape::cylinder;
    const double diameter = value.at("cylinder").at("diameter");
    zone.size = kMillimetre * Vector3(diameter, diameter, value.at("cylinder").at("height"));
  }
  if (value.contains("center")) zone.center = millimetres(value.at("center"));
  zone.tilt = kDegree * value.value("tilt", 0.0);
  return zone;
}

std::vector<std::pair<std::string, double>> read_weights(const json& document, const char* key,
                                                         Problems& problems) {
  std::vector<std::pair<std::string, double>> weights;
  if (!document.contains(key)) {
    problems.add_missing(document,
                         fmt::format("\"{}\" must be given: what makes a design good", key));
    return weights;
  }
  const json& value = document.at(key);
  const std::vector<std::string> words = objective_words();
  for (const auto& [name, weight] : value.items()) {
    if (std::ranges::find(words, name) == words.end()) {
      std::string list;
      for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
      problems.add(weight, fmt::format("\"{}\" is no objective; there are {}", name, list),
                   did_you_mean(name, words));
    } else if (weight.get<double>() > 0) {
      weights.emplace_back(name, weight.get<double>());
    }
  }
  if (weights.empty() && problems.empty())
    problems.add(value, "at least one weight must be greater than zero");
  return weights;
}

std::string zone_text(const Zone& zone) {
  const Vector3 mm = zone.size / kMillimetre;
  std::string text = zone.shape == Zone::Shape::cylinder
                         ? fmt::format("Ø{:g} × {:g} mm", mm.x(), mm.z())
                         : fmt::format("{:g} × {:g} × {:g} mm", mm.x(), mm.y(), mm.z());
  if (zone.tilt > 0) text += fmt::format(", tilted ±{:g}°", zone.tilt / kDegree);
  return text;
}

}  // namespace

Requirements read_requirements(const json& document, const char* weights_key, Problems& problems) {
  Requirements requirements;
  requirements.zone = read_zone(document, problems);
  requirements.objectives = read_weights(document, weights_key, problems);
  if (document.contains("limits"))
    requirements.condition = document.at("limits").value("condition", 0.0);
  if (document.contains("envelope")) requirements.envelope = millimetres(document.at("envelope"));
  return requirements;
}

void check_name(const json& document, Problems& problems) {
  const std::string name = document.at("name");
  const auto fits = [](unsigned char c) {
    return std::isalnum(c) || c == '-' || c == '_' || c == '.';
  };
  if (name.front() == '.' || !std::ranges::all_of(name, fits))
    problems.add(document.at("name"), "a name consists of letters, digits, '-', '_' and '.'");
}

nlohmann::ordered_json requirements_json(const Requirements& requirements) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  list.push_back({{"name", "work zone"}, {"asked", zone_text(requirements.zone)}});
  if (requirements.condition > 0)
    list.push_back({{"name", "conditioning"},
                    {"asked", fmt::format("κ at most {:g} in the zone", requirements.condition)}});
  if (requirements.envelope) {
    const Vector3 mm = *requirements.envelope / kMillimetre;
    list.push_back({{"name", "envelope"},
                    {"asked", fmt::format("{:g} × {:g} × {:g} mm", mm.x(), mm.y(), mm.z())}});
  }
  return list;
}

}  // namespace polyglide
