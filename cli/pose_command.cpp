#include <fmt/format.h>

#include <iostream>

#include "cli/commands.hpp"
#include "cli/machines.hpp"
#include "cli/print.hpp"
#include "cli/singularities.hpp"
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

ordered_json inverse(const Machine& machine, const Pose& pose,
                     const std::vector<std::string>& ignored, bool json) {
  const InverseResult result = solve_inverse(machine, pose, ignored);
  ordered_json document{{"name", machine.model.mechanism.name}, {"reachable", result.reachable}};
  document["drives"] = std::vector<double>(result.drives.begin(), result.drives.end());
  document["limit"] = result.limit.empty() ? ordered_json() : ordered_json(result.limit);
  document["pose"] = pose_json(result.pose);
  if (json) return document;

  std::cout << machine.model.mechanism.name << ": "
            << (result.reachable ? "reachable" : "not reachable: " + result.limit) << "\n";
  if (!result.reachable) return document;
  std::cout << "  pose from home " << pose_text(result.pose) << "\n  drives from home:\n";
  for (int d = 0; d < result.drives.size(); ++d)
    std::cout << fmt::format(
        "    {:<16} {}\n", drive_name(machine.model, d),
        linear_drive(machine.model, d) ? in_mm(result.drives[d]) : in_degrees(result.drives[d]));
  return document;
}

ordered_json forward(const Machine& machine, const std::string& text, bool all, std::uint64_t seed,
                     bool json) {
  const auto solutions = solve_forward(machine, read_drives(text, machine.model), all, seed);
  ordered_json document{{"name", machine.model.mechanism.name}, {"count", solutions.size()}};
  document["solutions"] = ordered_json::array();
  for (const ForwardSolution& solution : solutions)
    document["solutions"].push_back({{"pose", pose_json(solution.pose)},
                                     {"residual", solution.residual},
                                     {"certified", solution.closed_form},
                                     {"home_mode", solution.home_mode}});
  if (json) return document;
  std::cout << fmt::format("{}: {} assembly mode(s) found\n", machine.model.mechanism.name,
                           solutions.size());
  for (const ForwardSolution& solution : solutions)
    std::cout << fmt::format("  pose from home {}{}\n", pose_text(solution.pose),
                             solution.home_mode ? " (home's assembly mode)" : "");
  return document;
}

}  // namespace

int run_pose(CommandLine& line) {
  MachineOptions options;
  std::string ik, fk;
  std::vector<std::string> ignored;
  SingularityQuestions questions;
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
  if (!line.parse()) return kDone;
  if (ik.empty() && fk.empty())
    throw InputError({wrong_argument("", "pose needs --ik x,y,z[,a,b,c] or --fk q1,q2,…")});

  std::vector<ordered_json> documents;
  for (const ChosenMachine& chosen : load_machines(options)) {
    const Machine machine = prepare(chosen.mechanism);
    if (ik.empty()) {
      documents.push_back(forward(machine, fk, all, line.seed(), line.json()));
      continue;
    }
    const Pose pose = read_pose(ik, "--ik", chosen.mechanism.units);
    documents.push_back(inverse(machine, pose, ignored, line.json()));
    add_singularities(machine, pose, questions, line.seed(), line.json(), documents.back());
  }
  if (line.json()) print_json(one_or_all(std::move(documents)));
  return kDone;
}

}  // namespace polyglide
