#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iostream>

#include "cli/commands.hpp"
#include "cli/machines.hpp"
#include "cli/print.hpp"
#include "kinematics/mobility.hpp"

namespace polyglide {
namespace {

void print_page(const MobilityReport& report, const Mechanism& mechanism) {
  const auto plural = [](int count) { return count == 1 ? "" : "s"; };
  std::cout << fmt::format("{}: {}\n", mechanism.name, to_string(report.verdict));
  for (const std::string& reason : report.reasons) std::cout << "  " << reason << "\n";
  std::cout << columns({
      {"", "", ""},
      {"  mobility", fmt::format("{}", report.finite),
       fmt::format("finite; {} at home; Kutzbach {}; {} redundant constraint{}", report.home,
                   report.kutzbach, report.redundant_constraints,
                   plural(report.redundant_constraints))},
      {"  platform", report.pattern,
       fmt::format("{} freedom{} ({}); {} at home", report.platform_dof,
                   plural(report.platform_dof), report.axes.empty() ? "none" : report.axes,
                   report.platform_home_dof)},
      {"  drives", fmt::format("{}", report.drives),
       fmt::format("held, the platform keeps {} freedom{}, {} at home; {} surplus",
                   report.locked_platform, plural(report.locked_platform),
                   report.home_locked_platform, report.surplus)},
      {"  certainty", fmt::format("{:.1e}", report.rank_gap),
       fmt::format("smallest gap of a rank decision; margin to singularity {:.2g}", report.margin)},
  });
  if (report.idle > 0)
    std::cout << fmt::format("  idle        {} freedom{} that move no platform point: {}\n",
                             report.idle, plural(report.idle), fmt::join(report.idle_rods, ", "));
  if (report.branches.size() > 1) {
    std::cout << "  branches through home:";
    for (const auto& branch : report.branches)
      std::cout << fmt::format(" {} ({} freedom{})", branch.pattern, branch.dimension,
                               plural(branch.dimension));
    std::cout << "\n";
  }
  for (const FreedomMode& mode : report.modes) std::cout << "  freedom left " << mode.about << "\n";
}

}  // namespace

int run_check(CommandLine& line) {
  MachineOptions options;
  add_machine_options(line.options(), options);
  if (!line.parse()) return kDone;

  std::vector<nlohmann::ordered_json> documents;
  for (const ChosenMachine& machine : load_machines(options)) {
    MobilityOptions how;
    how.seed = line.seed();
    const MobilityReport report = analyse_mobility(compile(machine.mechanism), how);
    if (line.json())
      documents.push_back(to_json(report, machine.mechanism));
    else
      print_page(report, machine.mechanism);
  }
  if (line.json()) print_json(one_or_all(std::move(documents)));
  return kDone;
}

}  // namespace polyglide
