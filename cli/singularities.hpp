#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "kinematics/solve.hpp"

namespace polyglide {

/// What else is asked about a pose.
struct SingularityQuestions {
  bool nearest = false;
  std::string to;  ///< other end of a way; empty: none
};

/// x,y,z[,a,b,c] in file units, from home, as a pose. @throws InputError naming the option.
[[nodiscard]] Pose read_pose(const std::string& text, const std::string& option,
                             const Units& units);

/// {"position": [m], "quaternion": [w, x, y, z]}
[[nodiscard]] nlohmann::ordered_json pose_json(const Pose& pose);

/// For people: millimetres and degrees.
[[nodiscard]] std::string pose_text(const Pose& pose);

/// Adds the singularities at a pose to its document and, when asked, how far the nearest is
/// and what lies on the way to another pose; prints them unless `json`. Nothing where the
/// pose cannot be taken.
void add_singularities(const Machine& machine, const Pose& pose, const SingularityQuestions& asked,
                       std::uint64_t seed, bool json, nlohmann::ordered_json& document);

}  // namespace polyglide
