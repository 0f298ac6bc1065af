#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "cli/command_line.hpp"
#include "kinematics/stiffness.hpp"

namespace polyglide {

/// What yields, in words of the command line.
struct StiffnessOptions {
  std::vector<double> drives{1.0};   ///< [N/m, N·m/rad]
  double rods = 0;                   ///< [N/m]; 0: rigid
  double characteristic_length = 0;  ///< file units; 0: the machine's own
};

/// Declares --drive-stiffness, --rod-stiffness and --characteristic-length.
void add_stiffness_options(CLI::App& app, StiffnessOptions& options);

/// @throws InputError for what does not fit the machine.
[[nodiscard]] Springs springs_of(const StiffnessOptions& options, const Machine& machine);

/// Adds Jacobian, conditioning and stiffness to the document of a pose.
void add_json(const PoseIndices& indices, const TaskSpace& task, nlohmann::ordered_json& document);

/// For people: lines with the condition number and the stiffnesses.
[[nodiscard]] std::string text_of(const PoseIndices& indices, const Springs& springs);

}  // namespace polyglide
