#include "cli/pose_indices.hpp"

#include <fmt/format.h>

#include <cmath>

#include "cli/print.hpp"
#include "kinematics/motion.hpp"

namespace polyglide {
namespace {

using nlohmann::ordered_json;

ordered_json matrix_json(const Eigen::MatrixXd& matrix) {
  ordered_json rows = ordered_json::array();
  for (const auto& row : matrix.rowwise())
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  return rows;
}

ordered_json range_json(const std::optional<StiffnessRange>& range, const char* unit) {
  if (!range) return nullptr;
  return {{"min", range->least}, {"max", range->greatest}, {"unit", unit}};
}

}  // namespace

void add_stiffness_options(CLI::App& app, StiffnessOptions& options) {
  app.add_option("--drive-stiffness", options.drives,
                 "N/m (N m/rad where it turns) of every drive, or one number for all")
      ->delimiter(',')
      ->check(positive_number("--drive-stiffness"));
  app.add_option("--rod-stiffness", options.rods,
                 "N/m of all rods of a drive together, in series with it")
      ->check(positive_number("--rod-stiffness"));
  app.add_option("--characteristic-length", options.characteristic_length,
                 "Length that makes rotations comparable (file units)")
      ->check(positive_number("--characteristic-length"));
}

Springs springs_of(const StiffnessOptions& options, const Machine& machine) {
  const Mechanism& mechanism = machine.model.mechanism;
  const std::size_t drives = machine.model.drives.size();
  if (options.drives.size() != 1 && options.drives.size() != drives)
    throw InputError({wrong_argument(
        fmt::format("{} numbers", options.drives.size()),
        fmt::format("--drive-stiffness takes one number, or one per drive; {} has {}",
                    mechanism.name, drives))});
  if (options.rods > 0 && !knows_rods(machine))
    throw InputError({wrong_argument(
        fmt::format("{}", options.rods),
        fmt::format("--rod-stiffness is for machines whose legs are guides or cranks with rods, or "
                    "struts; {} has others",
                    mechanism.name))});
  Springs springs;
  springs.drives = options.drives;
  if (options.rods > 0) springs.rods = options.rods;
  if (options.characteristic_length > 0)
    springs.characteristic_length = options.characteristic_length * mechanism.units.metres;
  return springs;
}

void add_json(const PoseIndices& indices, const TaskSpace& task, ordered_json& document) {
  const auto& sigma = indices.singular_values;
  document["axes"] = axes_name(task.axes);
  document["jacobian"] = matrix_json(indices.jacobian);
  document["characteristic_length"] = indices.characteristic_length;
  document["singular_values"] = std::vector<double>(sigma.begin(), sigma.end());
  document["condition"] =
      std::isfinite(indices.condition) ? ordered_json(indices.condition) : ordered_json(nullptr);
  document["stiffness"] = {{"drives", indices.drive_stiffness},
                           {"matrix", matrix_json(indices.stiffness)},
                           {"translation", range_json(indices.translation, "N/m")},
                           {"rotation", range_json(indices.rotation, "N m/rad")}};
}

std::string text_of(const PoseIndices& indices, const Springs& springs) {
  std::string text = std::isfinite(indices.condition)
                         ? fmt::format("  condition number {:.6g} (characteristic length {})\n",
                                       indices.condition, in_mm(indices.characteristic_length))
                         : std::string("  singular\n");
  // Without a stiffness of the drives only the document tells: it is per drive stiffness.
  if (springs.drives == std::vector<double>{1.0} && !springs.rods) return text;
  const auto line = [&](const char* name, const std::optional<StiffnessRange>& range,
                        const char* unit) {
    if (range)
      text += fmt::format("  stiffness against {} {:.6g} to {:.6g} {}\n", name, range->least,
                          range->greatest, unit);
  };
  line("forces", indices.translation, "N/m");
  line("moments", indices.rotation, "N m/rad");
  return text;
}

}  // namespace polyglide
