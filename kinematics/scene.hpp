#pragma once

#include <nlohmann/json.hpp>

#include "kinematics/mobility.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {

/// What a page needs to draw a machine and move it: the SCENE of
/// docs/run-format.md, in metres and radians.
/// @param nodes upper bound on the number of drive combinations tabulated.
[[nodiscard]] nlohmann::ordered_json scene_of(const Machine& machine, int nodes = 800);

/// The part of a scene that a picture of the machine at home needs: `bodies` and `segments`.
[[nodiscard]] nlohmann::ordered_json picture_of(const Machine& machine);

/// Adds `mode` (the freedom that is left, as frames) to a scene.
void add_mode(nlohmann::ordered_json& scene, const FreedomMode& mode, const Mechanism& mechanism);

}  // namespace polyglide
