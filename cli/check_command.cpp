#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iostream>
#include <ranges>
#include <regex>

#include "catalog/counted.hpp"
#include "cli/commands.hpp"
#include "cli/machines.hpp"
#include "cli/print.hpp"
#include "kinematics/mobility.hpp"
#include "kinematics/screw_words.hpp"

namespace polyglide {
namespace {

/// The counts, each with what it means.
void print_counts(const MobilityReport& report) {
  std::vector<std::vector<std::string>> rows{
      {"  mobility", fmt::format("{}", report.finite),
       fmt::format("finite; {} at home; Kutzbach {}; {}", report.home, report.kutzbach,
                   counted(report.redundant_constraints, "redundant constraint"))},
      {"  platform", report.pattern,
       fmt::format("{} ({}); {} at home; {}", counted(report.platform_dof, "freedom"),
                   report.axes.empty() ? "none" : report.axes, report.platform_home_dof,
                   report.motion)},
      {"  drives", fmt::format("{}", report.drives),
       fmt::format("held, the platform keeps {}, {} at home; {} surplus",
                   counted(report.locked_platform, "freedom"), report.home_locked_platform,
                   report.surplus)},
      {"  certainty", fmt::format("{:.1e}", report.rank_gap),
       fmt::format("smallest gap of a rank decision; margin to singularity {:.2g}", report.margin)},
  };
  const CountingTerms& terms = report.counting;
  rows.push_back({"  counting", fmt::format("{}", terms.mobility),
                  fmt::format("= d(n − g − 1) + Σf + υ − ζ = {}({} − {} − 1) + {} + {} − {}",
                              terms.order, terms.links, terms.joints, terms.freedoms,
                              terms.virtual_constraints, terms.local)});
  std::cout << '\n' << columns(rows);
}

void print_list(const char* title, const std::vector<std::string>& items) {
  if (items.empty()) return;
  std::cout << "\n  " << title << "\n";
  for (const std::string& item : items) std::cout << "    " << item << "\n";
}

/// A motion, and the bodies that take part with their share of the fastest one's speed.
std::string motion_text(const std::string& about, const std::vector<BodyMotion>& bodies,
                        const Mechanism& mechanism) {
  constexpr std::size_t kShown = 5;
  std::vector<std::string> shares;
  for (const BodyMotion& body : bodies | std::views::take(kShown))
    shares.push_back(fmt::format("{} {:.0f} %", mechanism.bodies[body.body], 100 * body.speed));
  const std::string more =
      bodies.size() > kShown ? fmt::format(" and {} more", bodies.size() - kShown) : "";
  return fmt::format("{}\n      moving: {}{}", about, fmt::join(shares, ", "), more);
}

/// A limb, and below it every wrench on a line of its own.
std::string limb_text(const LimbWrenches& limb) {
  std::string text = limb.name;
  for (const Screw& wrench : limb.constraints) text += "\n      " + describe_wrench(wrench);
  for (const Screw& wrench : limb.actuations) text += "\n      driven: " + describe_wrench(wrench);
  return limb.constraints.empty() && limb.actuations.empty() ? text + "\n      nothing" : text;
}

/// A redundant constraint, every loop that carries a part of it on a line of its own.
std::string constraint_text(const RedundantConstraint& constraint) {
  return std::regex_replace(constraint.about, std::regex(", with "), ",\n      with ");
}

void print_evidence(const MobilityReport& report, const Mechanism& mechanism) {
  std::vector<std::string> items;
  for (const FreedomMode& mode : report.modes)
    items.push_back(motion_text(mode.about, mode.bodies, mechanism));
  print_list("Freedoms that are left", items);
  items.clear();
  if (report.branches.size() > 1)
    for (const auto& branch : report.branches)
      items.push_back(fmt::format("{} ({})", branch.pattern, counted(branch.dimension, "freedom")));
  print_list("Motion branches that meet at home", items);
  items.clear();
  for (const PlatformMotion& motion : report.platform_motions)
    items.push_back(motion_text(motion.about, motion.bodies, mechanism));
  print_list("What the platform can do at home", items);
  items.clear();
  for (const IdleFreedom& idle : report.idle_freedoms) items.push_back(idle.about);
  print_list("Idle freedoms, which move no point of the platform", items);
  items.clear();
  for (const RedundantConstraint& constraint : report.redundant)
    items.push_back(constraint_text(constraint));
  print_list("Redundant constraints", items);
  items.clear();
  for (const LimbWrenches& limb : report.limbs) items.push_back(limb_text(limb));
  print_list("What each limb bears, always and when driven", items);
}

void print_page(const MobilityReport& report, const Mechanism& mechanism) {
  std::cout << fmt::format("{}: {}\n", mechanism.name, to_string(report.verdict));
  for (const std::string& reason : report.reasons) std::cout << "  " << reason << "\n";
  print_counts(report);
  print_evidence(report, mechanism);
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
