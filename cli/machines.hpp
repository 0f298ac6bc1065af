#pragma once

#include <string>
#include <vector>

#include "catalog/layout.hpp"
#include "cli/command_line.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {

/// The machines a command works on: `NAME… --set parameter=value …`.
struct MachineOptions {
  std::vector<std::string> names;     ///< catalog names or files
  std::vector<std::string> settings;  ///< "parameter=value", in the file's units
};

/// Declares NAME… (at least one when `required`) and --set.
void add_machine_options(CLI::App& app, MachineOptions& options, bool required = true);

/// A machine as its file gives it, and in numbers for the values asked for.
struct ChosenMachine {
  Layout layout;
  Mechanism mechanism;
};

/// Loads the named machines in their order; a setting counts for each of them.
/// @throws InputError with the mistakes of all of them.
[[nodiscard]] std::vector<ChosenMachine> load_machines(const MachineOptions& options);

/// Says on standard error which of these words names no limit of the machine: most likely it is
/// misspelt.
void remark_unknown_limits(const std::vector<std::string>& ignored, const Machine& machine);

}  // namespace polyglide
