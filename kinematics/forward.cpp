#include <algorithm>
#include <cmath>

#include "kinematics/assembly_modes.hpp"
#include "kinematics/manifold.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {
namespace {

void set_drives(const Model& model, Posture& posture, const Eigen::VectorXd& drives) {
  Eigen::VectorXd increments =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.freedoms.size()));
  increments(model.drives) = drives - drive_positions(model, posture);
  advance(model, posture, increments);
}

/// Whether a pure machine has moved in its task coordinates only. Otherwise the way from home led
/// through a singularity onto another motion branch.
bool in_task_space(const Machine& machine, const Pose& pose) {
  if (!machine.task.pure) return true;
  Eigen::Matrix<double, 6, 1> rest = coordinates_of(pose);
  rest.head<3>() /= machine.model.size;
  for (const int axis : machine.task.axes) rest[axis] = 0;
  return rest.lpNorm<Eigen::Infinity>() < 1e-6;
}

}  // namespace

bool solve_forward_from(const Machine& machine, const Eigen::VectorXd& drives, Posture& posture) {
  const Model& model = machine.model;
  const std::vector<int> passive = passive_freedoms(model);
  const Eigen::VectorXd start = drive_positions(model, posture);
  const double farthest = std::max(1e-9, drive_distance(model, start, drives));
  if (!(farthest < kFarthestWay)) return false;
  constexpr double kStep = 0.25, kShortest = 1e-4;
  Posture current = posture;
  double done = 0, step = std::min(1.0, kStep / farthest);
  while (done < 1) {
    const double next = std::min(1.0, done + step);
    Posture trial = current;
    set_drives(model, trial, start + next * (drives - start));
    if (project(model, trial, passive).closed && displacement(model, current, trial) < 1.5) {
      current = std::move(trial);
      done = next;
    } else if ((step /= 2) < kShortest) {
      return false;
    }
  }
  posture = std::move(current);
  return true;
}

std::optional<ForwardSolution> follow_from_home(const Machine& machine,
                                                const Eigen::VectorXd& drives) {
  const Model& model = machine.model;
  Posture posture = home(model);
  if (!solve_forward_from(machine, drives, posture)) return std::nullopt;
  ForwardSolution own;
  own.home_mode = true;
  own.pose = platform_pose(model, posture.bodies[model.mechanism.platform]);
  if (!in_task_space(machine, own.pose)) return std::nullopt;
  own.residual = closure_residual(model, posture).lpNorm<Eigen::Infinity>();
  own.posture = std::move(posture);
  return own;
}

std::vector<ForwardSolution> solve_forward(const Machine& machine, const Eigen::VectorXd& drives,
                                           bool all, std::uint64_t seed) {
  AssemblySearch search;
  search.seed = seed;
  search.regions = false;
  if (all) return find_assembly_modes(machine, drives, search).solutions;
  if (!(drive_distance(machine.model, 0 * drives, drives) < kFarthestWay)) return {};
  if (auto own = follow_from_home(machine, drives)) return {std::move(*own)};
  // Where the drives cannot be followed from home, the closed form still knows.
  std::vector<ForwardSolution> solutions = three_sphere_modes(machine, drives);
  if (solutions.size() > 1) solutions.resize(1);
  return solutions;
}

}  // namespace polyglide
