#pragma once

#include <string>
#include <vector>

#include "kinematics/model.hpp"

namespace polyglide {

/// Whether a limit of this name does not count: `ignored` holds its full name,
/// its first word ("stroke", "cone"), or the name of a half-space limit.
[[nodiscard]] bool is_ignored(const std::string& limit, const std::vector<std::string>& ignored);

/// The first limit a posture breaks, "" when it keeps all: "stroke leg1.guide max"
/// for a driven joint, "range leg1.hinge min" for a passive one, "cone leg1.top", or
/// the name of a half-space limit.
[[nodiscard]] std::string broken_limit(const Model& model, const Posture& posture,
                                       const std::vector<std::string>& ignored = {});

}  // namespace polyglide
