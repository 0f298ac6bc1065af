#include "kinematics/evaluate.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <stdexcept>

#include "kinematics/leg_kernel.hpp"
#include "kinematics/limits.hpp"

namespace polyglide {
namespace {

/// Names of limits in the order in which broken_limit() looks for them.
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
  add("motion");
  return names;
}

/// Whether a pure machine is asked for a coordinate that it does not have.
bool is_stray(const Machine& machine, const Pose& pose) {
  if (!machine.task.pure) return false;
  Eigen::Matrix<double, 6, 1> rest = coordinates_of(pose);
  for (int axis : machine.task.axes) rest[axis] = 0;
  return rest.cwiseAbs().maxCoeff() > 1e-9;
}

/// Runs `work(first, last)` on blocks of fixed size, so that results do not
/// depend on how many threads share them.
template <typename Work>
void in_blocks(std::size_t size, std::size_t block, const Work& work) {
  if (size <= block) {
    if (size > 0) work(std::size_t{0}, size);
    return;
  }
  const std::size_t blocks = (size + block - 1) / block;
  tbb::parallel_for(std::size_t{0}, blocks,
                    [&](std::size_t i) { work(i * block, std::min(size, (i + 1) * block)); });
}

}  // namespace

Evaluator::Evaluator(const Machine& machine, const std::vector<std::string>& ignored)
    : machine_(machine), ignored_(ignored) {
  if (machine_.legs && machine_.task.pure) {
    for (Leg& leg : machine_.legs->legs) {
      const int joint = machine_.model.freedoms[machine_.model.drives[leg.drive]].joint;
      const std::string stroke = "stroke " + machine_.model.mechanism.joints[joint].name;
      if (is_ignored(stroke + " min", ignored_)) leg.stroke.min = Range{}.min;
      if (is_ignored(stroke + " max", ignored_)) leg.stroke.max = Range{}.max;
    }
    kernel_ = std::make_shared<const LegKernel>(machine_, ignored_);
    limit_names_ = kernel_->limit_names();
  } else {
    limit_names_ = general_limit_names(machine_);
  }
}

int Evaluator::limit_index(const std::string& name) const {
  const auto at = std::find(limit_names_.begin(), limit_names_.end(), name);
  return at == limit_names_.end() ? 0 : static_cast<int>(at - limit_names_.begin());
}

void Evaluator::evaluate(const PoseBatch& poses, BatchResult& result) const {
  if (poses.y.size() != poses.size() || poses.z.size() != poses.size())
    throw std::invalid_argument("Evaluator::evaluate: x, y and z of the poses differ in length");
  result.limit.resize(poses.size());
  result.inverse_condition.resize(poses.size());
  result.orientation.resize(poses.size());
  if (kernel_)
    evaluate_legs(poses, result);
  else
    evaluate_general(poses, result);
}

void Evaluator::evaluate_legs(const PoseBatch& poses, BatchResult& result) const {
  const LegKernel::Oriented oriented = kernel_->orient(poses.rotation);
  in_blocks(poses.size(), 8 * LegKernel::kBlock, [&](std::size_t first, std::size_t last) {
    LegKernel::Block block;
    block.conditioning = poses.conditioning;
    for (std::size_t i = first; i < last; i += LegKernel::kBlock) {
      block.count = static_cast<int>(std::min<std::size_t>(LegKernel::kBlock, last - i));
      block.x = &poses.x[i];
      block.y = &poses.y[i];
      block.z = &poses.z[i];
      block.limit = &result.limit[i];
      block.inverse_condition = &result.inverse_condition[i];
      block.orientation = &result.orientation[i];
      kernel_->evaluate(oriented, block);
    }
  });
}

void Evaluator::evaluate_general(const PoseBatch& poses, BatchResult& result) const {
  const Model& model = machine_.model;
  in_blocks(poses.size(), 16, [&](std::size_t first, std::size_t last) {
    Posture near = home(model);
    for (std::size_t i = first; i < last; ++i) {
      result.inverse_condition[i] = 0;
      result.orientation[i] = 0;
      const Pose pose{{poses.x[i], poses.y[i], poses.z[i]}, poses.rotation};
      result.limit[i] = static_cast<int>(limit_names_.size()) - 1;
      if (is_stray(machine_, pose)) continue;
      Posture posture = near;
      const InverseResult solved = solve_inverse_general(machine_, pose, posture);
      if (!solved.reachable) {
        result.limit[i] = 0;
        continue;
      }
      near = posture;
      const std::string broken = broken_limit(model, posture, ignored_);
      result.limit[i] = broken.empty() ? -1 : limit_index(broken);
      if (!broken.empty()) continue;
      const auto jacobian = task_jacobian(machine_, posture);
      if (!jacobian) continue;
      result.inverse_condition[i] = 1 / condition_number(*jacobian);
      if (jacobian->rows() != jacobian->cols() || jacobian->size() == 0) continue;
      const double det = jacobian->determinant();
      result.orientation[i] = static_cast<signed char>((det > 0) - (det < 0));
    }
  });
}

int Evaluator::inverse(const Pose& pose, Eigen::VectorXd& drives) const {
  const Model& model = machine_.model;
  drives.resize(static_cast<Eigen::Index>(model.drives.size()));
  if (!kernel_) {
    drives.setZero();
    if (is_stray(machine_, pose)) return static_cast<int>(limit_names_.size()) - 1;
    Posture posture = home(model);
    const InverseResult solved = solve_inverse_general(machine_, pose, posture);
    drives = solved.drives;
    if (!solved.reachable) return 0;
    const std::string broken = broken_limit(model, posture, ignored_);
    return broken.empty() ? -1 : limit_index(broken);
  }
  int limit = -1;
  double condition = 0;
  signed char orientation = 0;
  LegKernel::Block block;
  block.count = 1;
  block.x = &pose.position.x();
  block.y = &pose.position.y();
  block.z = &pose.position.z();
  block.limit = &limit;
  block.inverse_condition = &condition;
  block.orientation = &orientation;
  kernel_->evaluate(kernel_->orient(pose.rotation), block);
  for (Eigen::Index d = 0; d < drives.size(); ++d) drives[d] = block.drives[d * LegKernel::kBlock];
  return limit;
}

}  // namespace polyglide
