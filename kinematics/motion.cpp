#include "kinematics/motion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "kinematics/manifold.hpp"

namespace polyglide {
namespace {

/// Indices of `count` rows that are independent, chosen by pivoting, ascending.
std::vector<int> independent_rows(const Eigen::MatrixXd& matrix, int count) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix.transpose());
  std::vector<int> rows;
  for (int i = 0; i < count; ++i)
    rows.push_back(static_cast<int>(qr.colsPermutation().indices()[i]));
  std::sort(rows.begin(), rows.end());
  return rows;
}

std::string vector_text(const Vector3& v, double scale) {
  const auto tidy = [](double value) { return std::abs(value) < 5e-4 ? 0.0 : value; };
  return fmt::format("({:.3g}, {:.3g}, {:.3g})", tidy(v.x() * scale), tidy(v.y() * scale),
                     tidy(v.z() * scale));
}

/// The active freedoms that belong to joints closing a loop, loop by loop, and the
/// positions of all others in `active`.
struct Split {
  std::vector<std::vector<int>> closing;  ///< per loop: positions in `active`
  std::vector<int> tree;                  ///< positions in `active`
};

Split split_freedoms(const Model& model, const std::vector<int>& active) {
  Split split;
  split.closing.resize(model.loop_joints.size());
  for (int i = 0; i < static_cast<int>(active.size()); ++i) {
    const int joint = model.freedoms[active[i]].joint;
    const auto loop = std::find(model.loop_joints.begin(), model.loop_joints.end(), joint);
    if (loop == model.loop_joints.end())
      split.tree.push_back(i);
    else
      split.closing[loop - model.loop_joints.begin()].push_back(i);
  }
  return split;
}

}  // namespace

Kernel closure_kernel(const Model& model, const Eigen::MatrixXd& screws,
                      const std::vector<int>& active) {
  const Split split = split_freedoms(model, active);
  const Eigen::MatrixXd scaled = scaled_screws(model, screws);
  const int loops = static_cast<int>(model.loop_joints.size());
  Eigen::MatrixXd reduced(6 * loops, split.tree.size());
  std::vector<Eigen::MatrixXd> rates(
      loops);  // of the closing joint per rate of the tree's freedoms
  Eigen::Index rows = 0;
  for (int loop = 0; loop < loops; ++loop) {
    const Eigen::MatrixXd block = loop_block(model, scaled, loop)(Eigen::all, active);
    const Eigen::MatrixXd tree = block(Eigen::all, split.tree);
    const Eigen::MatrixXd own = block(Eigen::all, split.closing[loop]);
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(own);
    const Eigen::MatrixXd turned = qr.householderQ().transpose() * tree;
    reduced.middleRows(rows, 6 - own.cols()) = turned.bottomRows(6 - own.cols());
    rows += 6 - own.cols();
    rates[loop] = -qr.matrixQR()
                       .topRows(own.cols())
                       .triangularView<Eigen::Upper>()
                       .solve(turned.topRows(own.cols()));
  }
  const Kernel tree = kernel_of(reduced.topRows(rows));
  Kernel kernel{tree.decision, Eigen::MatrixXd(active.size(), tree.basis.cols())};
  kernel.basis(split.tree, Eigen::all) = tree.basis;
  for (int loop = 0; loop < loops; ++loop)
    kernel.basis(split.closing[loop], Eigen::all) = rates[loop] * tree.basis;
  return kernel;
}

Freedoms freedoms_at(const Model& model, const Posture& posture, const std::vector<int>& active) {
  Freedoms result;
  const Eigen::MatrixXd screws = freedom_screws(model, posture);
  Kernel kernel = closure_kernel(model, screws, active);
  result.rank = kernel.decision;
  result.kernel = std::move(kernel.basis);
  result.mobility = static_cast<int>(result.kernel.cols());

  const Eigen::VectorXd scale = freedom_scale(model);
  Eigen::MatrixXd twists =
      columns(body_jacobian(model, screws, model.mechanism.platform) * scale.asDiagonal(), active);
  const Vector3 tool = posture.bodies[model.mechanism.platform] * model.mechanism.tool;
  for (Eigen::Index c = 0; c < twists.cols(); ++c) {
    const Vector3 w = twists.col(c).head<3>();
    twists.col(c).tail<3>() = (twists.col(c).tail<3>() + w.cross(tool)) / model.size;
  }
  result.platform = twists * result.kernel;
  // Kernel columns are orthonormal: a platform rate of 1 is real, 1e-15 is not.
  result.platform_rank = rank_of(result.platform, 1);
  return result;
}

TaskSpace task_axes(const Freedoms& freedoms) {
  TaskSpace task;
  const Eigen::MatrixXd angular = freedoms.platform.topRows(3);
  const int dof = freedoms.platform_rank.rank;
  if (dof == 0) return task;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(angular, Eigen::ComputeFullV);
  task.rotations =
      std::min(decide_rank(svd.singularValues(), freedoms.platform_rank.largest).rank, dof);
  task.translations = dof - task.rotations;

  Eigen::MatrixXd translating = freedoms.platform.bottomRows(3);
  if (task.rotations > 0) {
    for (int row : independent_rows(angular, task.rotations)) task.axes.push_back(3 + row);
    translating = translating * svd.matrixV().rightCols(angular.cols() - task.rotations);
  }
  if (task.translations > 0)
    for (int row : independent_rows(translating, task.translations)) task.axes.push_back(row);
  std::sort(task.axes.begin(), task.axes.end());
  return task;
}

double characteristic_length(const Model& model) {
  double square = 0;
  int count = 0;
  for (const Joint& joint : model.mechanism.joints) {
    const bool on_platform =
        joint.bodies[0] == model.mechanism.platform || joint.bodies[1] == model.mechanism.platform;
    if (!on_platform || joint.type == JointType::prismatic) continue;
    square += (joint.at - model.mechanism.tool).squaredNorm();
    ++count;
  }
  const double length = count > 0 ? std::sqrt(square / count) : 0;
  return length > 1e-9 * model.size ? length : model.size;
}

std::string pattern_name(int translations, int rotations) {
  if (translations + rotations == 0) return "0";
  return fmt::format("{}T{}R", translations, rotations);
}

std::string axes_name(const std::vector<int>& axes) {
  std::string name;
  for (int axis : axes) name += "XYZABC"[axis];
  return name;
}

std::string describe_twist(const Screw& twist) {
  const Vector3 w = twist.head<3>(), v = twist.tail<3>();
  const double turning = w.norm();
  if (turning < 1e-9 * (1 + v.norm())) return "translation along " + vector_text(v.normalized(), 1);
  const Vector3 axis = w / turning;
  const Vector3 point = w.cross(v) / (turning * turning);
  const double pitch = axis.dot(v) / turning;
  const std::string where =
      fmt::format("the axis along {} through {} mm", vector_text(axis, 1), vector_text(point, 1e3));
  if (std::abs(pitch) < 1e-6 * (1 + point.norm())) return "rotation about " + where;
  return fmt::format("screw motion of pitch {:.3g} mm/rad about {}", pitch * 1e3, where);
}

}  // namespace polyglide
