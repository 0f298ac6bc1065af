#include "kinematics/stiffness.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "kinematics/evaluate.hpp"

namespace polyglide {
namespace {

bool positive(double value) { return value > 0 && std::isfinite(value); }

void check(const Machine& machine, const Springs& springs) {
  const std::size_t drives = machine.model.drives.size();
  if (springs.drives.size() != 1 && springs.drives.size() != drives)
    throw std::invalid_argument(fmt::format("{} drive stiffnesses given, the machine has {} drives",
                                            springs.drives.size(), drives));
  if (!std::ranges::all_of(springs.drives, positive))
    throw std::invalid_argument("a drive stiffness must be a positive number");
  if (springs.characteristic_length && !positive(*springs.characteristic_length))
    throw std::invalid_argument("a characteristic length must be a positive number");
  if (!springs.rods) return;
  if (!positive(*springs.rods))
    throw std::invalid_argument("a rod stiffness must be a positive number");
  if (!machine.legs || machine.task.translations != 3)
    throw std::invalid_argument(
        "rod stiffness needs legs of guide, crank or strut with rods, and three translations");
}

/// J in SI, from a batch of one.
std::optional<Eigen::MatrixXd> jacobian_at(const Machine& machine, const Pose& pose) {
  // Every limit is ignored: what counts is the posture.
  std::vector<std::string> ignored;
  const Evaluator named(machine);
  for (const std::string& name : named.limit_names())
    if (name != "motion" && name != "not finite" && !name.starts_with("reach"))
      ignored.push_back(name);
  const Evaluator evaluator(machine, ignored);
  PoseBatch batch;
  batch.x = {pose.position.x()};
  batch.y = {pose.position.y()};
  batch.z = {pose.position.z()};
  batch.rotation = pose.rotation;
  batch.wanted = Wanted::jacobian | Wanted::condition;
  batch.instructions = "scalar";
  BatchResult result;
  evaluator.evaluate(batch, result);
  if (result.limit[0] >= 0) return std::nullopt;
  const auto rows = static_cast<Eigen::Index>(machine.model.drives.size());
  const auto columns = static_cast<Eigen::Index>(machine.task.axes.size());
  Eigen::MatrixXd jacobian(rows, columns);
  for (Eigen::Index d = 0; d < rows; ++d)
    for (Eigen::Index k = 0; k < columns; ++k) {
      const double scale = machine.task.axes[k] < 3 ? 1 : machine.task.characteristic_length;
      jacobian(d, k) = result.jacobian[d * columns + k] * scale;
    }
  if (!jacobian.allFinite() || jacobian.isZero(0)) return std::nullopt;
  return jacobian;
}

}  // namespace

std::optional<PoseIndices> indices_at(const Machine& machine, const Pose& pose,
                                      const Springs& springs) {
  check(machine, springs);
  const auto jacobian = jacobian_at(machine, pose);
  if (!jacobian) return std::nullopt;
  PoseIndices result;
  result.jacobian = *jacobian;
  result.characteristic_length =
      springs.characteristic_length.value_or(machine.task.characteristic_length);
  Eigen::MatrixXd scaled = *jacobian;
  for (Eigen::Index k = 0; k < scaled.cols(); ++k)
    if (machine.task.axes[k] >= 3) scaled.col(k) /= result.characteristic_length;
  result.singular_values = Eigen::JacobiSVD<Eigen::MatrixXd>(scaled).singularValues();
  result.condition = condition_number(scaled);
  Eigen::VectorXd stiffness(jacobian->rows());
  for (Eigen::Index d = 0; d < stiffness.size(); ++d) {
    stiffness[d] = springs.drives[springs.drives.size() == 1 ? 0 : d];
    // Task axes ascend: the first three are the translations.
    if (springs.rods)
      stiffness[d] =
          1 / (1 / stiffness[d] + jacobian->row(d).head<3>().squaredNorm() / *springs.rods);
  }
  result.stiffness = jacobian->transpose() * stiffness.asDiagonal() * *jacobian;
  return result;
}

}  // namespace polyglide
