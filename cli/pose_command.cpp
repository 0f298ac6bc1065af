#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "catalog/counted.hpp"
#include "cli/commands.hpp"
#include "cli/machines.hpp"
#include "cli/pose_indices.hpp"
#include "cli/print.hpp"
#include "cli/singularities.hpp"
#include "kinematics/assembly_modes.hpp"
#include "kinematics/limits.hpp"
#include "kinematics/motion.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {
namespace {

using nlohmann::ordered_json;

bool linear_drive(const Model& model, int drive) {
  return model.freedoms[model.drives[drive]].translational;
}

std::string drive_name(const Model& model, int drive) {
  return model.mechanism.joints[model.freedoms[model.drives[drive]].joint].name;
}

Eigen::VectorXd read_drives(const std::string& text, const Model& model) {
  const std::vector<double> numbers = parse_numbers(text, "--fk");
  if (numbers.size() != model.drives.size())
    throw InputError(
        {wrong_argument(text, fmt::format("--fk takes one number per drive; {} has {}",
                                          model.mechanism.name, model.drives.size()))});
  Eigen::VectorXd drives(static_cast<Eigen::Index>(numbers.size()));
  const Units& units = model.mechanism.units;
  for (std::size_t d = 0; d < numbers.size(); ++d)
    drives[static_cast<Eigen::Index>(d)] =
        numbers[d] * (linear_drive(model, static_cast<int>(d)) ? units.metres : units.radians);
  return drives;
}

/// Adds Jacobian, conditioning and stiffness to a document; the same for people.
std::string add_indices(const Machine& machine, const Pose& pose, const Eigen::VectorXd& drives,
                        const std::optional<Posture>& posture, const Springs& springs,
                        ordered_json& document) {
  const auto indices = indices_at(machine, pose, drives, posture, springs);
  if (!indices) {
    const std::string reason = why_no_indices(machine, posture);
    document["no_indices"] = reason;
    return "  no conditioning: " + reason + "\n";
  }
  add_json(*indices, machine.task, document);
  return text_of(*indices, springs);
}

/// The first of these drive positions beyond its stroke, "" when none is.
std::string broken_stroke(const Model& model, const Eigen::VectorXd& drives,
                          const std::vector<std::string>& ignored) {
  Posture posture = home(model);
  posture.q(model.drives) = drives;
  for (const int drive : model.drives) {
    const std::string limit = broken_range(model, posture, model.freedoms[drive].joint);
    if (!limit.empty() && !is_ignored(limit, ignored)) return limit;
  }
  return "";
}

/// Coordinates asked for that this machine cannot command and that came out otherwise.
std::string dependent_coordinates(const Machine& machine, const Pose& asked, const Pose& found) {
  const auto wanted = coordinates_of(asked), got = coordinates_of(found);
  std::string letters;
  for (int axis = 0; axis < 6; ++axis) {
    const double miss = std::abs(wanted[axis] - got[axis]) / (axis < 3 ? machine.model.size : 1);
    const bool free = std::ranges::count(machine.task.axes, axis) > 0;
    if (!free && wanted[axis] != 0 && miss > 1e-6) letters += "XYZABC"[axis];
  }
  return letters;
}

ordered_json inverse(const Machine& machine, const Pose& pose,
                     const std::vector<std::string>& ignored, const Springs& springs, bool json) {
  const InverseResult result = solve_inverse(machine, pose, ignored);
  ordered_json document{{"name", machine.model.mechanism.name}, {"reachable", result.reachable}};
  document["drives"] = std::vector<double>(result.drives.begin(), result.drives.end());
  document["limit"] = result.limit.empty() ? ordered_json() : ordered_json(result.limit);
  document["pose"] = pose_json(result.pose);
  std::string indices;
  if (result.reachable)
    indices = add_indices(machine, result.pose, result.drives, result.posture, springs, document);
  if (json) return document;
  std::cout << machine.model.mechanism.name << ": "
            << (result.reachable ? "reachable" : "not reachable: " + result.limit) << "\n";
  if (!result.reachable) return document;
  std::cout << "  pose from home " << pose_text(result.pose) << "\n";
  if (const std::string letters = dependent_coordinates(machine, pose, result.pose);
      !letters.empty())
    std::cout << fmt::format("    {} cannot be commanded here and follows from {}\n", letters,
                             axes_name(machine.task.axes));
  std::cout << "  drives from home:\n";
  for (int d = 0; d < result.drives.size(); ++d)
    std::cout << fmt::format(
        "    {:<16} {}\n", drive_name(machine.model, d),
        linear_drive(machine.model, d) ? in_mm(result.drives[d]) : in_degrees(result.drives[d]));
  std::cout << indices;
  return document;
}

ordered_json solution_json(const ForwardSolution& solution) {
  ordered_json json{{"pose", pose_json(solution.pose)},
                    {"residual", solution.residual},
                    {"certified", solution.certified}};
  if (solution.certified) json["radius"] = solution.radius;
  json["home_mode"] = solution.home_mode;
  json["connected_to_home"] = solution.connected_to_home;
  json["region"] = solution.region < 0 ? ordered_json() : ordered_json(solution.region);
  return json;
}

ordered_json completeness_json(const Completeness& completeness) {
  return {
      {"starts", completeness.starts},
      {"hits", completeness.hits},
      {"rarest_hits", completeness.rarest_hits},
      {"unseen", completeness.unseen},
      {"bound", completeness.bound > 0 ? ordered_json(completeness.bound) : ordered_json()},
      {"family", completeness.family.empty() ? ordered_json() : ordered_json(completeness.family)},
      {"complete", completeness.complete},
      {"stopped", completeness.stopped}};
}

/// @param indices of every solution, for people.
void print_modes(const Machine& machine, const AssemblyModes& modes,
                 const std::vector<std::string>& indices, bool all) {
  std::cout << fmt::format("{}: {} found\n", machine.model.mechanism.name,
                           counted(modes.solutions.size(), "assembly mode"));
  for (std::size_t i = 0; i < modes.solutions.size(); ++i) {
    const ForwardSolution& solution = modes.solutions[i];
    std::string notes;
    if (solution.home_mode)
      notes = " (home's assembly mode)";
    else if (solution.connected_to_home)
      notes = " (joined with home without a singularity)";
    if (all && !solution.certified) notes += " (not proved)";
    if (all && solution.region >= 0) notes += fmt::format(" region {}", solution.region + 1);
    std::cout << fmt::format("  pose from home {}{}\n", pose_text(solution.pose), notes);
    if (!all) std::cout << indices[i];
  }
  const Completeness& completeness = modes.completeness;
  if (!all) return;
  if (modes.solutions.empty())
    std::cout << "  the drives are out of reach: no posture has these drive positions\n";
  if (completeness.complete)
    std::cout << "  all there can be, each proved\n";
  else
    std::cout << fmt::format(
        "  searched from {} starts until {}; estimated share of modes not seen "
        "at most {:.2g} of the hits\n",
        completeness.starts, completeness.stopped, completeness.unseen);
}

ordered_json forward(const Machine& machine, const std::string& text, bool all,
                     const std::vector<std::string>& ignored, const Springs& springs,
                     std::uint64_t seed, bool json) {
  AssemblySearch search;
  search.seed = seed;
  const Eigen::VectorXd drives = read_drives(text, machine.model);
  AssemblyModes modes;
  if (all)
    modes = find_assembly_modes(machine, drives, search);
  else
    modes.solutions = solve_forward(machine, drives, false, seed);
  ordered_json document{{"name", machine.model.mechanism.name}, {"count", modes.solutions.size()}};
  const std::string limit = broken_stroke(machine.model, drives, ignored);
  document["limit"] = limit.empty() ? ordered_json() : ordered_json(limit);
  document["solutions"] = ordered_json::array();
  std::vector<std::string> indices;
  for (const ForwardSolution& solution : modes.solutions) {
    document["solutions"].push_back(solution_json(solution));
    indices.push_back(add_indices(machine, solution.pose, drives, solution.posture, springs,
                                  document["solutions"].back()));
  }
  if (all) document["completeness"] = completeness_json(modes.completeness);
  if (!json) print_modes(machine, modes, indices, all);
  if (!json && !limit.empty()) std::cout << "  these drive positions are beyond " << limit << "\n";
  return document;
}

}  // namespace

int run_pose(CommandLine& line) {
  MachineOptions options;
  std::string ik, fk;
  std::vector<std::string> ignored;
  SingularityQuestions questions;
  StiffnessOptions yields;
  bool all = false;
  add_machine_options(line.options(), options);
  auto* ik_option = line.options().add_option(
      "--ik", ik, "Drives for the pose x,y,z[,a,b,c] from home, file units");
  auto* fk_option =
      line.options().add_option("--fk", fk, "Poses for the drives q1,q2,… from home, file units");
  ik_option->excludes(fk_option);
  line.options().add_flag("--all", all, "With --fk: every assembly mode")->needs(fk_option);
  line.options()
      .add_option("--ignore-limits", ignored, "Limits that do not count, separated by commas")
      ->delimiter(',');
  line.options()
      .add_option("--to", questions.to,
                  "With --ik: singularities on the straight way to this pose, too")
      ->needs(ik_option);
  line.options()
      .add_flag("--nearest-singularity", questions.nearest,
                "With --ik: the nearest singular pose, too")
      ->needs(ik_option);
  add_stiffness_options(line.options(), yields);
  if (!line.parse()) return kDone;
  if (ik.empty() && fk.empty())
    throw InputError({wrong_argument("", "pose needs --ik x,y,z[,a,b,c] or --fk q1,q2,…")});

  if (!questions.to.empty()) static_cast<void>(read_pose(questions.to, "--to", Units{}));

  std::vector<ordered_json> documents;
  for (const ChosenMachine& chosen : load_machines(options)) {
    const Machine machine = prepare(chosen.mechanism);
    const Springs springs = springs_of(yields, machine);
    if (!line.quiet()) remark_unknown_limits(ignored, machine);
    if (ik.empty()) {
      documents.push_back(forward(machine, fk, all, ignored, springs, line.seed(), line.json()));
      continue;
    }
    const Pose pose = read_pose(ik, "--ik", chosen.mechanism.units);
    documents.push_back(inverse(machine, pose, ignored, springs, line.json()));
    add_singularities(machine, pose, questions, line.seed(), line.json(), documents.back());
  }
  if (line.json()) print_json(one_or_all(std::move(documents)));
  return kDone;
}

}  // namespace polyglide
