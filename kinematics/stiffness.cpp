#include "kinematics/stiffness.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "catalog/counted.hpp"
#include "kinematics/motion.hpp"
#include "kinematics/rank.hpp"

namespace polyglide {
namespace {

constexpr double kWorst = 1e12;  // condition number

bool is_positive(double value) { return value > 0 && std::isfinite(value); }

void check_springs(const Machine& machine, const Springs& springs) {
  const std::size_t drives = machine.model.drives.size();
  if (springs.drives.size() != 1 && springs.drives.size() != drives)
    throw std::invalid_argument(
        fmt::format("{} given, the machine has {}",
                    counted(springs.drives.size(), "drive stiffness", "drive stiffnesses"),
                    counted(drives, "drive")));
  if (!std::ranges::all_of(springs.drives, is_positive))
    throw std::invalid_argument("a drive stiffness must be a positive number");
  if (springs.characteristic_length && !is_positive(*springs.characteristic_length))
    throw std::invalid_argument("a characteristic length must be a positive number");
  if (!springs.rods) return;
  if (!is_positive(*springs.rods))
    throw std::invalid_argument("a rod stiffness must be a positive number");
  if (!knows_rods(machine))
    throw std::invalid_argument("rod stiffness needs legs of guide, crank or strut with rods");
}

/// J in SI from one with rotations divided by the machine's characteristic length.
Eigen::MatrixXd in_si(Eigen::MatrixXd jacobian, const TaskSpace& task) {
  for (Eigen::Index k = 0; k < jacobian.cols(); ++k)
    if (task.axes[k] >= 3) jacobian.col(k) *= task.characteristic_length;
  return jacobian;
}

/// Eigenvalues of the block of the first `count` axes when the others are free to follow.
std::optional<StiffnessRange> yielding_range(const Eigen::MatrixXd& stiffness, Eigen::Index count) {
  if (count == 0) return std::nullopt;
  const Eigen::Index rest = stiffness.cols() - count;
  Eigen::MatrixXd yielding = stiffness.topLeftCorner(count, count);
  if (rest > 0) {
    const Eigen::MatrixXd mixed = stiffness.bottomLeftCorner(rest, count);
    const Eigen::MatrixXd own = stiffness.bottomRightCorner(rest, rest);
    yielding -= mixed.transpose() * least_squares(own, mixed);
  }
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(yielding, Eigen::EigenvaluesOnly)
          .eigenvalues();
  return StiffnessRange{std::max(0.0, values.minCoeff()), std::max(0.0, values.maxCoeff())};
}

void add_conditioning(PoseIndices& result, const TaskSpace& task) {
  Eigen::MatrixXd scaled = result.jacobian;
  for (Eigen::Index k = 0; k < scaled.cols(); ++k)
    if (task.axes[k] >= 3) scaled.col(k) /= result.characteristic_length;
  result.singular_values = singular_values(scaled);
  result.condition = condition_number(scaled);
  if (scaled.rows() < scaled.cols() || !(result.condition < kWorst))
    result.condition = std::numeric_limits<double>::infinity();
}

void add_stiffness(PoseIndices& result, const TaskSpace& task, const Eigen::VectorXd& springs) {
  result.stiffness = result.jacobian.transpose() * springs.asDiagonal() * result.jacobian;
  result.translation = yielding_range(result.stiffness, task.translations);
  result.rotation = yielding_range(result.stiffness.reverse(), task.rotations);
}

}  // namespace

bool knows_rods(const Machine& machine) { return machine.legs && machine.task.pure; }

std::string why_no_indices(const Machine& machine, const std::optional<Posture>& posture) {
  const std::size_t axes = machine.task.axes.size();
  if (axes == 0) return "the machine commands no motion of the platform";
  if (!posture)
    return "a rod stands across the motion of its carriage or crank: the rate of its drive does "
           "not follow from the platform's";
  const int freedoms = freedoms_at(machine.model, *posture).platform_rank.rank;
  if (freedoms < static_cast<int>(axes))
    return fmt::format("the platform has only {} of its {} freedoms here, while a drive can move",
                       freedoms, axes);
  return fmt::format("{} do not command the machine here: it can move while they stand still",
                     axes_name(machine.task.axes));
}

std::optional<PoseIndices> indices_at(const Machine& machine, const Pose& pose,
                                      const Eigen::VectorXd& drives,
                                      const std::optional<Posture>& posture,
                                      const Springs& springs) {
  check_springs(machine, springs);
  const TaskSpace& task = machine.task;
  const auto rows = knows_rods(machine) ? leg_rows(machine, pose, drives) : std::nullopt;
  PoseIndices result;
  if (rows) {
    result.jacobian = (*rows)(Eigen::all, task.axes);
  } else {
    const auto general = posture && !springs.rods ? task_jacobian(machine, *posture) : std::nullopt;
    if (!general) return std::nullopt;
    result.jacobian = in_si(*general, task);
  }
  if (!result.jacobian.allFinite() || result.jacobian.cols() == 0) return std::nullopt;
  result.characteristic_length = springs.characteristic_length.value_or(task.characteristic_length);
  result.drive_stiffness = springs.drives;
  if (springs.drives.size() == 1)
    result.drive_stiffness.assign(machine.model.drives.size(), springs.drives[0]);
  Eigen::VectorXd series = Eigen::Map<const Eigen::VectorXd>(
      result.drive_stiffness.data(), static_cast<Eigen::Index>(result.drive_stiffness.size()));
  for (Eigen::Index d = 0; springs.rods && d < series.size(); ++d)
    series[d] = 1 / (1 / series[d] + rows->row(d).head<3>().squaredNorm() / *springs.rods);
  add_conditioning(result, task);
  add_stiffness(result, task, series);
  return result;
}

}  // namespace polyglide
