#include <cmath>
#include <limits>

#include "kinematics/manifold.hpp"
#include "kinematics/motion.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {
namespace {

constexpr double kAcross = 1e-12;  // cosine between a rod and a motion that it is across

}  // namespace

std::optional<Eigen::MatrixXd> task_jacobian(const Machine& machine, const Posture& posture) {
  const Model& model = machine.model;
  const Freedoms freedoms = freedoms_at(model, posture);
  // Task rates per kernel rate. Rotations count as the speed they give at the
  // characteristic length, so that all rows are in m/s.
  const Eigen::Index axes = static_cast<Eigen::Index>(machine.task.axes.size());
  Eigen::MatrixXd task(axes, freedoms.mobility);
  for (Eigen::Index i = 0; i < axes; ++i) {
    const int axis = machine.task.axes[i];
    task.row(i) = axis < 3 ? model.size * freedoms.platform.row(3 + axis)
                           : machine.task.characteristic_length * freedoms.platform.row(axis - 3);
  }
  const Eigen::MatrixXd drives =
      (freedom_scale(model).asDiagonal() * freedoms.kernel)(model.drives, Eigen::all);
  const Svd svd = svd_of(task);
  if (decide_rank(svd.values, model.size).rank < axes) return std::nullopt;
  return drives * svd.v.leftCols(axes) * svd.values.cwiseInverse().asDiagonal() * svd.u.transpose();
}

std::optional<Eigen::MatrixXd> leg_rows(const Machine& machine, const Pose& pose,
                                        const Eigen::VectorXd& drives) {
  if (!machine.legs) return std::nullopt;
  const Vector3& tool = machine.model.mechanism.tool;
  Eigen::MatrixXd rows(drives.size(), 6);
  for (Eigen::Index d = 0; d < drives.size(); ++d) {
    const Leg& leg = machine.legs->legs[machine.legs->primary[d]];
    const Vector3 arm = pose.rotation * (leg.platform_point - tool);
    Vector3 base = leg.base_point;
    if (leg.kind == Leg::Kind::guide_rod) base += drives[d] * leg.direction;
    if (leg.kind == Leg::Kind::crank_rod)
      base = leg.centre + Eigen::AngleAxisd(drives[d], leg.direction) * (base - leg.centre);
    const Vector3 rod = tool + pose.position + arm - base;
    const Vector3 motion = leg.kind == Leg::Kind::crank_rod ? leg.direction.cross(base - leg.centre)
                           : leg.kind == Leg::Kind::strut   ? rod.normalized()
                                                            : leg.direction;
    const double along = rod.dot(motion);
    if (!(std::abs(along) > kAcross * rod.norm() * motion.norm())) return std::nullopt;
    rows.row(d) << rod.transpose() / along, arm.cross(rod).transpose() / along;
  }
  return rows;
}

double condition_number(const Eigen::MatrixXd& jacobian) {
  const Eigen::VectorXd s = singular_values(jacobian);
  const Eigen::Index last = s.size() - 1;
  if (last < 0 || !(s[last] > 0)) return std::numeric_limits<double>::infinity();
  return s[0] / s[last];
}

}  // namespace polyglide
