#include <limits>

#include "kinematics/manifold.hpp"
#include "kinematics/motion.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {

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

double condition_number(const Eigen::MatrixXd& jacobian) {
  const Eigen::VectorXd s = singular_values(jacobian);
  const Eigen::Index last = s.size() - 1;
  if (last < 0 || !(s[last] > 0)) return std::numeric_limits<double>::infinity();
  return s[0] / s[last];
}

}  // namespace polyglide
