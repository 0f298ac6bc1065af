#include "cli/commands.hpp"

namespace polyglide {
namespace {

constexpr Command kCommands[] = {
    {"catalog", "List the machines that come with polyglide, or show some", run_catalog},
    {"export", "Write a machine in a format for other tools", run_export},
};

}  // namespace

std::span<const Command> commands() { return kCommands; }

}  // namespace polyglide
