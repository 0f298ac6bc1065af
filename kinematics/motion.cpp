#include "kinematics/motion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "kinematics/manifold.hpp"

namespace polyglide {
namespace {

/// Rotation rates that drawing errors cause in a Schoenflies machine reach 1e-7; commanded
/// ones are of the order of 1.
constexpr RankScale kTurning{1e-8, 1e-3};

/// Which freedoms belong to joints closing a loop, loop by loop, and which do not.
struct Split {
  std::vector<std::vector<int>> closing;  ///< per loop
  std::vector<int> tree;
};

Split split_freedoms(const Model& model) {
  Split split;
  split.closing.resize(model.loop_joints.size());
  for (int f = 0; f < static_cast<int>(model.freedoms.size()); ++f) {
    const auto loop = std::ranges::find(model.loop_joints, model.freedoms[f].joint);
    (loop == model.loop_joints.end() ? split.tree : split.closing[loop - model.loop_joints.begin()])
        .push_back(f);
  }
  return split;
}

}  // namespace

Kernel closure_kernel(const Model& model, const Eigen::MatrixXd& jacobian, Certainty certainty) {
  const Split split = split_freedoms(model);
  const auto loops = static_cast<int>(model.loops.size());
  Eigen::MatrixXd reduced(6 * loops, split.tree.size());
  std::vector<Eigen::MatrixXd> rates(
      loops);  // of the closing joint per rate of the tree's freedoms
  Eigen::Index rows = 0;
  for (int loop = 0; loop < loops; ++loop) {
    Eigen::Matrix<double, 6, Eigen::Dynamic> tree(6, split.tree.size());
    for (std::size_t i = 0; i < split.tree.size(); ++i)
      tree.col(static_cast<Eigen::Index>(i)) = jacobian.block<6, 1>(6 * loop, split.tree[i]);
    using Own = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 3>;
    Own own(6, split.closing[loop].size());
    for (Eigen::Index i = 0; i < own.cols(); ++i)
      own.col(i) = jacobian.block<6, 1>(6 * loop, split.closing[loop][i]);
    if (own.cols() == 0) {  // closed by a weld
      reduced.middleRows<6>(rows) = tree;
      rates[loop].resize(0, tree.cols());
      rows += 6;
      continue;
    }
    const Eigen::HouseholderQR<Own> qr(own);
    tree.applyOnTheLeft(qr.householderQ().transpose());
    reduced.middleRows(rows, 6 - own.cols()) = tree.bottomRows(6 - own.cols());
    rows += 6 - own.cols();
    rates[loop] = -qr.matrixQR()
                       .topRows(own.cols())
                       .triangularView<Eigen::Upper>()
                       .solve(tree.topRows(own.cols()));
  }
  // Screws are about 1 in these units: where the closing joints leave rounding only, it has rank 0.
  const Kernel tree = certainty == Certainty::confirmed ? kernel_of(reduced.topRows(rows), 1)
                                                        : screened_kernel(reduced.topRows(rows), 1);
  Kernel kernel{tree.decision, tree.pivot, Eigen::MatrixXd(jacobian.cols(), tree.basis.cols())};
  kernel.basis(split.tree, Eigen::all) = tree.basis;
  for (int loop = 0; loop < loops; ++loop)
    kernel.basis(split.closing[loop], Eigen::all) = rates[loop] * tree.basis;
  return kernel;
}

Eigen::MatrixXd platform_motion(const Model& model, const Posture& posture,
                                const Eigen::MatrixXd& rates) {
  const Eigen::MatrixXd screws = freedom_screws(model, posture);
  const int platform = model.mechanism.platform;
  const Vector3 tool = posture.bodies[platform] * model.mechanism.tool;
  Eigen::MatrixXd twists = Eigen::MatrixXd::Zero(6, rates.cols());
  for (const auto [joint, sign] : model.platform_path) {
    const int first = model.first_freedom[joint];
    for (int f = first; f < first + freedoms(model.mechanism.joints[joint].type); ++f) {
      const Vector3 w = screws.col(f).head<3>(), v = screws.col(f).tail<3>();
      Screw at_tool;
      at_tool << w, (v + w.cross(tool)) / model.size;
      twists.noalias() +=
          sign * (model.freedoms[f].translational ? model.size : 1) * at_tool * rates.row(f);
    }
  }
  return twists;
}

Freedoms freedoms_at(const Model& model, const Posture& posture, Certainty certainty) {
  Freedoms result;
  Kernel kernel = closure_kernel(model, closure_jacobian(model, posture), certainty);
  result.rank = kernel.decision;
  result.pivot = kernel.pivot;
  result.kernel = std::move(kernel.basis);
  result.mobility = static_cast<int>(result.kernel.cols());
  if (certainty == Certainty::screened) return result;
  result.platform = platform_motion(model, posture, result.kernel);
  // Kernel columns are orthonormal: a platform rate of 1 is real, 1e-15 is not.
  result.platform_rank = rank_of(result.platform, 1);
  return result;
}

Freedoms hold_drives(const Model& model, const Freedoms& free) {
  Freedoms held;
  Kernel kernel = kernel_of(free.kernel(model.drives, Eigen::all), 1);
  held.rank = kernel.decision;
  held.kernel = free.kernel * kernel.basis;
  held.kernel(model.drives, Eigen::all).setZero();
  held.mobility = static_cast<int>(held.kernel.cols());
  if (free.platform.cols() < free.kernel.cols()) return held;  // screened
  held.platform = free.platform * kernel.basis;
  held.platform_rank = rank_of(held.platform, 1);
  return held;
}

TaskSpace task_axes(const Freedoms& freedoms) {
  TaskSpace task;
  const Eigen::MatrixXd angular = freedoms.platform.topRows(3);
  const int dof = freedoms.platform_rank.rank;
  if (dof == 0) return task;
  const Svd svd = svd_of(angular);
  // Of more than three freedoms some turn, however little.
  task.rotations =
      std::clamp(decide_rank(svd.values, freedoms.platform_rank.largest, kTurning).rank,
                 std::max(0, dof - 3), std::min(dof, 3));
  task.translations = dof - task.rotations;

  Eigen::MatrixXd translating = freedoms.platform.bottomRows(3);
  if (task.rotations > 0) {
    for (int row : independent_rows(angular, task.rotations)) task.axes.push_back(3 + row);
    translating = translating * svd.v.rightCols(angular.cols() - task.rotations);
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

}  // namespace polyglide
