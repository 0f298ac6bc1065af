#pragma once

#include <string>
#include <vector>

#include "kinematics/model.hpp"

namespace polyglide {

/// Whether a limit of this name does not count: `ignored` holds its full name,
/// its first word ("stroke", "cone", "clearance"), or the name that the file gives a limit.
[[nodiscard]] bool is_ignored(const std::string& limit, const std::vector<std::string>& ignored);

/// Names of the limits that are looked at last: expressions, then pairs of shapes. Each once.
[[nodiscard]] std::vector<std::string> late_limit_names(
    const Mechanism& mechanism, const std::vector<std::string>& ignored = {});

/// The end of its range that joint `j` is beyond in a posture: "stroke leg1.guide max" for a driven
/// freedom, "range leg1.hinge min" for a passive one, "" within.
[[nodiscard]] std::string broken_range(const Model& model, const Posture& posture, int j);

/// The first limit a posture breaks, "" when it keeps all: "stroke leg1.guide max"
/// for a driven joint, "range leg1.hinge min" for a passive one, "cone leg1.top", the name of a
/// half-space or expression limit, or "clearance leg1.rod leg2.rod".
[[nodiscard]] std::string broken_limit(const Model& model, const Posture& posture,
                                       const std::vector<std::string>& ignored = {});

}  // namespace polyglide
