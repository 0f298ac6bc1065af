#include <fmt/format.h>

#include <cmath>

#include "kinematics/evaluate.hpp"
#include "kinematics/limits.hpp"
#include "kinematics/manifold.hpp"
#include "kinematics/motion.hpp"

namespace polyglide {
namespace {

using Coordinates = Eigen::Matrix<double, 6, 1>;

/// Rates of [x y z a b c] from the twist [w; v of the tool], for R = Rz(c)·Ry(b)·Rx(a):
/// w = Rz·Ry·e_x ȧ + Rz·e_y ḃ + e_z ċ, inverted.
Eigen::Matrix<double, 6, 6> coordinate_rates(const Coordinates& at) {
  Eigen::Matrix3d turning;
  const Eigen::AngleAxisd rz(at[5], Vector3::UnitZ()), ry(at[4], Vector3::UnitY());
  turning << rz * (ry * Vector3::UnitX()), rz * Vector3::UnitY(), Vector3::UnitZ();
  Eigen::Matrix<double, 6, 6> rates = Eigen::Matrix<double, 6, 6>::Zero();
  rates.topRightCorner<3, 3>().setIdentity();
  rates.bottomLeftCorner<3, 3>() = turning.inverse();
  return rates;
}

/// Difference of coordinates with angles brought to (-π, π].
Coordinates coordinate_error(const Coordinates& at, const Coordinates& goal) {
  Coordinates error = at - goal;
  for (int i = 3; i < 6; ++i) error[i] = std::remainder(error[i], 2 * M_PI);
  return error;
}

/// The demand that the platform's task coordinates have the goal's values. With
/// three rotations the whole rotation is compared, which has no singular angles.
Goal platform_goal(const Machine& machine, const Coordinates& goal) {
  return [&machine, goal](const Posture& posture, const Eigen::MatrixXd& screws) {
    const Model& model = machine.model;
    const Transform& platform = posture.bodies[model.mechanism.platform];
    const Coordinates at = coordinates_of(platform_pose(model, platform));
    Coordinates error = coordinate_error(at, goal);
    Eigen::Matrix<double, 6, 6> rates = coordinate_rates(at);
    if (machine.task.rotations == 3) {
      const Eigen::AngleAxisd turn(Eigen::Matrix3d(
          platform.linear() * pose_of(goal).rotation.toRotationMatrix().transpose()));
      error.tail<3>() = turn.angle() * turn.axis();
      rates.bottomLeftCorner<3, 3>().setIdentity();
    }
    error.head<3>() /= model.size;
    rates.topRows<3>() /= model.size;

    Eigen::MatrixXd twist =
        body_jacobian(model, screws, model.mechanism.platform) * freedom_scale(model).asDiagonal();
    const Vector3 tool = platform * model.mechanism.tool;
    for (Eigen::Index c = 0; c < twist.cols(); ++c) {
      const Vector3 w = twist.col(c).head<3>();
      twist.col(c).tail<3>() += w.cross(tool);
    }
    Demand demand;
    demand.residual = error(machine.task.axes);
    demand.jacobian = (rates * twist)(machine.task.axes, Eigen::all);
    return demand;
  };
}

InverseResult no_solution(const Machine& machine, const std::string& limit) {
  InverseResult result;
  result.limit = limit;
  result.drives = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(machine.model.drives.size()));
  return result;
}

/// The budget of a way is spent before it begins.
std::string too_far() {
  return fmt::format("reach: not looked for beyond {:.0f} times the machine's size", kFarthestWay);
}

/// The asked coordinate that a pure machine cannot command, or "".
std::string not_commanded(const Machine& machine, const Coordinates& asked) {
  Coordinates rest = asked;
  for (int axis : machine.task.axes) rest[axis] = 0;
  for (int i = 0; i < 6; ++i)
    if (std::abs(rest[i]) > 1e-9)
      return fmt::format("motion {} is not free on this machine (task axes {})", "XYZABC"[i],
                         machine.task.axes.empty() ? "none" : axes_name(machine.task.axes));
  return "";
}

InverseResult solve_closed_form(const Machine& machine, const Pose& pose,
                                const std::vector<std::string>& ignored) {
  const Evaluator evaluator(machine, ignored);
  InverseResult result = no_solution(machine, "");
  const int limit = evaluator.inverse(pose, result.drives);
  result.reachable = limit < 0;
  if (!result.reachable) result.limit = evaluator.limit_names()[limit];
  result.pose = pose;
  return result;
}

}  // namespace

InverseResult solve_inverse_general(const Machine& machine, const Pose& pose, Posture& posture) {
  const Model& model = machine.model;
  const Coordinates goal = coordinates_of(pose);
  const Coordinates start =
      coordinates_of(platform_pose(model, posture.bodies[model.mechanism.platform]));
  Coordinates span = coordinate_error(goal, start);
  Coordinates scaled = span;
  scaled.head<3>() /= model.size;

  // Continuation in steps short enough to stay on the assembly mode.
  const std::vector<int> active = all_freedoms(model);
  constexpr double kStep = 0.25, kShortest = 1e-4;
  const double way = scaled.cwiseAbs().maxCoeff();
  if (!(way < kFarthestWay)) return no_solution(machine, too_far());
  double done = 0, step = std::min(1.0, kStep / std::max(way, 1e-9));
  double residual = 0;
  bool arrived = false;
  while (!arrived) {
    const double next = std::min(1.0, done + step);
    Posture trial = posture;
    const Projection projection =
        project(model, trial, active, platform_goal(machine, start + next * span));
    if (projection.closed && displacement(model, posture, trial) < 1.5) {
      posture = std::move(trial);
      residual = projection.residual;
      done = next;
      arrived = done >= 1;
    } else {
      step /= 2;
      if (step < kShortest) return no_solution(machine, "reach");
    }
  }
  InverseResult result;
  result.reachable = true;
  result.drives = drive_positions(model, posture);
  result.pose = platform_pose(model, posture.bodies[model.mechanism.platform]);
  result.residual = residual;
  return result;
}

InverseResult solve_inverse(const Machine& machine, const Pose& pose,
                            const std::vector<std::string>& ignored) {
  if (machine.task.pure || machine.task.axes.empty()) {
    const std::string stray = not_commanded(machine, coordinates_of(pose));
    if (!stray.empty()) return no_solution(machine, stray);
    if (machine.legs) return solve_closed_form(machine, pose, ignored);
  }
  Posture posture = home(machine.model);
  InverseResult result = solve_inverse_general(machine, pose, posture);
  if (result.reachable) result.limit = broken_limit(machine.model, posture, ignored);
  if (result.reachable) result.posture = std::move(posture);
  result.reachable = result.reachable && result.limit.empty();
  return result;
}

}  // namespace polyglide
