#include <fmt/format.h>

#include <iostream>

#include "cli/commands.hpp"
#include "cli/machines.hpp"
#include "cli/print.hpp"
#include "cli/singularities.hpp"
#include "kinematics/assembly_modes.hpp"
#include "kinematics/motion.hpp"
#include "kinematics/solve.hpp"
#include "kinematics/stiffness.hpp"

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

ordered_json matrix_json(const Eigen::MatrixXd& matrix) {
  ordered_json rows = ordered_json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    const Eigen::VectorXd row = matrix.row(i);
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return rows;
}

/// Jacobian, conditioning and stiffness at a pose that can be taken.
void add_indices(const Machine& machine, const InverseResult& inverse, const Springs& springs,
                 bool json, ordered_json& document) {
  if (!inverse.reachable) return;
  const auto indices = indices_at(machine, inverse.pose, springs);
  if (!indices) return;
  const auto& sigma = indices->singular_values;
  document["axes"] = axes_name(machine.task.axes);
  document["jacobian"] = matrix_json(indices->jacobian);
  document["characteristic_length"] = indices->characteristic_length;
  document["singular_values"] = std::vector<double>(sigma.begin(), sigma.end());
  document["condition"] =
      std::isfinite(indices->condition) ? ordered_json(indices->condition) : ordered_json(nullptr);
  document["stiffness"] = matrix_json(indices->stiffness);
  if (json) return;
  std::cout << fmt::format("  condition number {:.6g} (characteristic length {})\n",
                           indices->condition, in_mm(indices->characteristic_length));
}

ordered_json inverse(const Machine& machine, const Pose& pose,
                     const std::vector<std::string>& ignored, const Springs& springs, bool json) {
  const InverseResult result = solve_inverse(machine, pose, ignored);
  ordered_json document{{"name", machine.model.mechanism.name}, {"reachable", result.reachable}};
  document["drives"] = std::vector<double>(result.drives.begin(), result.drives.end());
  document["limit"] = result.limit.empty() ? ordered_json() : ordered_json(result.limit);
  document["pose"] = pose_json(result.pose);
  if (json) {
    add_indices(machine, result, springs, json, document);
    return document;
  }
  std::cout << machine.model.mechanism.name << ": "
            << (result.reachable ? "reachable" : "not reachable: " + result.limit) << "\n";
  if (!result.reachable) return document;
  std::cout << "  pose from home " << pose_text(result.pose) << "\n  drives from home:\n";
  for (int d = 0; d < result.drives.size(); ++d)
    std::cout << fmt::format(
        "    {:<16} {}\n", drive_name(machine.model, d),
        linear_drive(machine.model, d) ? in_mm(result.drives[d]) : in_degrees(result.drives[d]));
  add_indices(machine, result, springs, json, document);
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

void print_modes(const Machine& machine, const AssemblyModes& modes, bool all) {
  std::cout << fmt::format("{}: {} assembly mode(s) found\n", machine.model.mechanism.name,
                           modes.solutions.size());
  for (const ForwardSolution& solution : modes.solutions) {
    std::string notes;
    if (solution.home_mode)
      notes = " (home's assembly mode)";
    else if (solution.connected_to_home)
      notes = " (joined with home without a singularity)";
    if (all && !solution.certified) notes += " (not proved)";
    if (all && solution.region >= 0) notes += fmt::format(" region {}", solution.region + 1);
    std::cout << fmt::format("  pose from home {}{}\n", pose_text(solution.pose), notes);
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

ordered_json forward(const Machine& machine, const std::string& text, bool all, std::uint64_t seed,
                     bool json) {
  AssemblySearch search;
  search.seed = seed;
  const Eigen::VectorXd drives = read_drives(text, machine.model);
  AssemblyModes modes;
  if (all)
    modes = find_assembly_modes(machine, drives, search);
  else
    modes.solutions = solve_forward(machine, drives, false, seed);
  ordered_json document{{"name", machine.model.mechanism.name}, {"count", modes.solutions.size()}};
  document["solutions"] = ordered_json::array();
  for (const ForwardSolution& solution : modes.solutions)
    document["solutions"].push_back(solution_json(solution));
  if (all) document["completeness"] = completeness_json(modes.completeness);
  if (!json) print_modes(machine, modes, all);
  return document;
}

/// How far what yields is stiff, in words of the command line.
struct StiffnessOptions {
  std::vector<double> drives{1.0};
  double rods = 0, characteristic_length = 0;
};

void add_stiffness_options(CLI::App& app, CLI::Option* ik, StiffnessOptions& options) {
  app.add_option("--drive-stiffness", options.drives,
                 "With --ik: N/m or N m/rad of all drives or of each, for the stiffness matrix")
      ->delimiter(',')
      ->needs(ik)
      ->check(CLI::PositiveNumber);
  app.add_option("--rod-stiffness", options.rods,
                 "With --ik: N/m of all rods of a drive together, in series with it")
      ->needs(ik)
      ->check(CLI::PositiveNumber);
  app.add_option("--characteristic-length", options.characteristic_length,
                 "With --ik: length that makes rotations comparable (file units)")
      ->needs(ik)
      ->check(CLI::PositiveNumber);
}

/// @throws InputError for what does not fit the machine.
Springs springs_of(const StiffnessOptions& options, const Machine& machine) {
  const std::size_t drives = machine.model.drives.size();
  if (options.drives.size() != 1 && options.drives.size() != drives)
    throw InputError({wrong_argument(
        fmt::format("{} numbers", options.drives.size()),
        fmt::format("--drive-stiffness takes one number, or one per drive; {} has {}",
                    machine.model.mechanism.name, drives))});
  if (options.rods > 0 && (!machine.legs || machine.task.translations != 3))
    throw InputError({wrong_argument(
        fmt::format("{}", options.rods),
        "--rod-stiffness is for machines whose legs are guides or cranks with rods, or struts, and "
        "that translate in three directions")});
  Springs springs;
  springs.drives = options.drives;
  if (options.rods > 0) springs.rods = options.rods;
  if (options.characteristic_length > 0)
    springs.characteristic_length =
        options.characteristic_length * machine.model.mechanism.units.metres;
  return springs;
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
  add_stiffness_options(line.options(), ik_option, yields);
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
    documents.push_back(inverse(machine, pose, ignored, springs_of(yields, machine), line.json()));
    add_singularities(machine, pose, questions, line.seed(), line.json(), documents.back());
  }
  if (line.json()) print_json(one_or_all(std::move(documents)));
  return kDone;
}

}  // namespace polyglide
