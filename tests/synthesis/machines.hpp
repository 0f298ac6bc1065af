#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace polyglide::testing {

using Json = nlohmann::json;

/// An option of a choice.
inline Json option(const std::string& label, Json value) {
  return {{"label", label}, {"value", std::move(value)}};
}

/// An end of a rod: "spherical", or a word for the axis of a universal joint.
inline Json end(const std::string& word) {
  if (word == "spherical") return {{"joint", "spherical"}};
  return {{"joint", "universal"}, {"axis", word}};
}

/// One limb at an angle: vertical guide at radius 500, rod of 800 to a ball on
/// the platform at radius 120.
inline Json limb(const std::string& name, double turn, Json carriage) {
  return {{"name", name},
          {"turn", turn},
          {"guide", {{"through", {500, 0, 0}}, {"direction", "z"}}},
          {"rods",
           {{"length", 800},
            {"carriage", std::move(carriage)},
            {"platform", {{"joint", "spherical"}, {"at", {120, 0, 0}}}}}}};
}

/// A space of `limbs` limbs around the vertical, each with its own choice among `ends`
/// at the carriage: the textbook necklace.
inline Json necklace(int limbs, const std::vector<std::string>& ends) {
  Json space{{"format", "polyglide/space/1"}, {"name", "necklace"}};
  for (int i = 0; i < limbs; ++i) {
    Json options = Json::array();
    for (const std::string& word : ends) options.push_back(option(word, end(word)));
    space["limbs"].push_back(limb(fmt::format("l{}", i), 360.0 * i / limbs, {{"choose", options}}));
  }
  return space;
}

}  // namespace polyglide::testing
