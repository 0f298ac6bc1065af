#include "cli/commands.hpp"

namespace polyglide {
namespace {

constexpr Command kCommands[] = {
    {"catalog", "List the machines that come with polyglide, or show some", run_catalog},
    {"check", "Say whether the drives hold the platform, and why", run_check},
    {"pose", "Find drives for a pose, or poses for drives", run_pose},
    {"workspace", "Measure where the platform can be, and how well", run_workspace},
    {"enumerate", "Find every distinct layout of a design space, with verdicts", run_enumerate},
    {"design", "Find, tune and rank the layouts that do what a brief asks", run_design},
    {"optimize", "Improve the dimensions of one machine", run_optimize},
    {"report", "Write the page of a stored run again", run_report},
    {"export", "Write a machine in a format for other tools", run_export},
};

}  // namespace

std::span<const Command> commands() { return kCommands; }

}  // namespace polyglide
