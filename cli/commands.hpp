#pragma once

#include <span>
#include <string_view>

#include "cli/command_line.hpp"

namespace polyglide {

/// Exit statuses of the program; 1 and 2 are reached by exceptions only (main.cpp).
enum ExitStatus : int {
  kDone = 0,
  kWrongInput = 1,       ///< InputError: the user's input is wrong
  kOurBug = 2,           ///< any other exception
  kNothingSatisfies = 3  ///< done, but nothing satisfies the brief
};

/// A subcommand. To add one: a file with its run_… function, a line below, and a
/// row in commands.cpp.
struct Command {
  std::string_view name;
  std::string_view help;     ///< one line
  int (*run)(CommandLine&);  ///< returns the exit status
};

/// All subcommands, in the order in which --help lists them.
[[nodiscard]] std::span<const Command> commands();

int run_catalog(CommandLine& line);
int run_check(CommandLine& line);
int run_pose(CommandLine& line);
int run_workspace(CommandLine& line);
int run_enumerate(CommandLine& line);
int run_design(CommandLine& line);
int run_optimize(CommandLine& line);
int run_report(CommandLine& line);
int run_export(CommandLine& line);

}  // namespace polyglide
