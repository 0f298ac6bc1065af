#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace polyglide {

/// A singularity map as one SVG text that needs nothing else: 1/κ in shades, paler where a limit
/// stops the machine, nothing where it has no posture; singular curves in colour by kind; axes in
/// millimetres and degrees; a legend that says what is gained or lost.
/// @param map the `workspace --singularity-map --json` document. Text in it is data, whatever it
/// holds.
[[nodiscard]] std::string map_svg(const nlohmann::ordered_json& map);

}  // namespace polyglide
