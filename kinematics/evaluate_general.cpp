// Evaluation by Newton on loop closure, from pose to pose.
#include <cmath>
#include <limits>

#include "kinematics/evaluate_parts.hpp"
#include "kinematics/limits.hpp"

namespace polyglide {
namespace {

bool is_finite(const Pose& pose) {
  return pose.position.allFinite() && pose.rotation.coeffs().allFinite();
}

signed char sign_of(double value) { return static_cast<signed char>((value > 0) - (value < 0)); }

/// Indices of one Jacobian found the general way.
void put_indices(const Eigen::MatrixXd& jacobian, std::size_t i, BatchResult& result) {
  if (jacobian.size() == 0) return;  // no freedoms, or no drives
  const Eigen::VectorXd sigma = Eigen::JacobiSVD<Eigen::MatrixXd>(jacobian).singularValues();
  const Eigen::Index n = jacobian.cols();
  const double greatest = sigma[0], least = jacobian.rows() < n ? 0 : sigma[n - 1];
  const auto put = [i](auto& column, auto value) {
    if (!column.empty()) column[i] = value;
  };
  put(result.inverse_condition, greatest > 0 ? least / greatest : 0);
  put(result.smallest, least);
  put(result.softest, least * least);
  put(result.stiffest, greatest * greatest);
  if (least > 0)
    put(result.frobenius, static_cast<double>(n) /
                              std::sqrt(sigma.squaredNorm() * sigma.cwiseInverse().squaredNorm()));
  if (jacobian.rows() == n) put(result.orientation, sign_of(jacobian.determinant()));
}

void put_column(std::vector<double>& column, std::size_t size, std::size_t i,
                const Eigen::VectorXd& values) {
  if (column.empty()) return;
  for (Eigen::Index k = 0; k < values.size(); ++k)
    column[static_cast<std::size_t>(k) * size + i] = values[k];
}

}  // namespace

std::vector<std::string> general_limit_names(const Machine& machine) {
  std::vector<std::string> names{"reach"};
  const auto add = [&names](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const Joint& joint : machine.model.mechanism.joints) {
    for (int i = 0; i < static_cast<int>(joint.range.size()); ++i) {
      const bool driven = std::count(joint.driven.begin(), joint.driven.end(), i) > 0;
      add((driven ? "stroke " : "range ") + joint.name + " min");
      add((driven ? "stroke " : "range ") + joint.name + " max");
    }
    if (joint.cone) add("cone " + joint.name);
  }
  for (const HalfSpaceLimit& limit : machine.model.mechanism.limits) add(limit.name);
  for (const std::string& name : late_limit_names(machine.model.mechanism)) add(name);
  add("motion");
  add("not finite");
  return names;
}

int limit_of_coordinates(const Machine& machine, const Pose& pose, int names) {
  if (!is_finite(pose)) return names - 1;
  if (!machine.task.pure) return -1;
  Eigen::Matrix<double, 6, 1> rest = coordinates_of(pose);
  for (int axis : machine.task.axes) rest[axis] = 0;
  return rest.cwiseAbs().maxCoeff() > 1e-9 ? names - 2 : -1;
}

void clear_at(std::size_t i, BatchResult& result) {
  for (auto* column : {&result.inverse_condition, &result.frobenius, &result.smallest,
                       &result.transmission, &result.softest, &result.stiffest})
    if (!column->empty()) (*column)[i] = 0;
  if (!result.orientation.empty()) result.orientation[i] = 0;
}

void Evaluator::evaluate_general(const PoseBatch& poses, BatchResult& result) const {
  const Model& model = machine_.model;
  const unsigned indices = Wanted::condition | Wanted::orientation | Wanted::frobenius |
                           Wanted::smallest | Wanted::stiffness | Wanted::jacobian;
  in_blocks(poses.size(), 16, [&](std::size_t first, std::size_t last) {
    Posture near = home(model);
    for (std::size_t i = first; i < last; ++i) {
      clear_at(i, result);
      const Pose pose = pose_at(poses, i);
      const int names = static_cast<int>(limit_names_.size());
      result.limit[i] = limit_of_coordinates(machine_, pose, names);
      if (result.limit[i] >= 0) continue;
      Posture posture = near;
      const InverseResult solved = solve_inverse_general(machine_, pose, posture);
      if (!solved.reachable) {
        result.limit[i] = 0;
        continue;
      }
      near = posture;
      put_column(result.drives, poses.size(), i, solved.drives);
      const std::string broken = broken_limit(model, posture, ignored_);
      result.limit[i] = broken.empty() ? -1 : limit_index(broken);
      if (!broken.empty() || (poses.wanted & indices) == 0) continue;
      const auto jacobian = task_jacobian(machine_, posture);
      if (!jacobian) continue;
      put_indices(*jacobian, i, result);
      put_column(result.jacobian, poses.size(), i,
                 Eigen::Map<const Eigen::VectorXd>(Eigen::MatrixXd(jacobian->transpose()).data(),
                                                   jacobian->size()));
    }
  });
}

void Evaluator::forward_general(const DriveBatch& drives, ForwardResult& result) const {
  const Model& model = machine_.model;
  const auto rows = static_cast<Eigen::Index>(model.drives.size());
  in_blocks(drives.size, 16, [&](std::size_t first, std::size_t last) {
    Posture near = home(model);
    for (std::size_t i = first; i < last; ++i) {
      Eigen::VectorXd asked(rows);
      for (Eigen::Index d = 0; d < rows; ++d)
        asked[d] = drives.drives[static_cast<std::size_t>(d) * drives.size + i];
      Posture posture = near;
      const bool found = asked.allFinite() && solve_forward_from(machine_, asked, posture);
      result.residual[i] = std::numeric_limits<double>::infinity();
      if (!found) continue;
      near = posture;
      const Pose pose = platform_pose(model, posture.bodies[model.mechanism.platform]);
      result.residual[i] = closure_residual(model, posture).lpNorm<Eigen::Infinity>();
      for (int k = 0; k < 3; ++k) result.pose[k][i] = pose.position[k];
      const Eigen::Quaterniond& q = pose.rotation;
      const double parts[]{q.w(), q.x(), q.y(), q.z()};
      for (int k = 0; k < 4; ++k) result.pose[3 + k][i] = parts[k];
    }
  });
}

}  // namespace polyglide
