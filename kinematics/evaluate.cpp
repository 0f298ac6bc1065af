#include "kinematics/evaluate.hpp"

#include <algorithm>
#include <stdexcept>

#include "kinematics/batch_model.hpp"
#include "kinematics/clearance.hpp"
#include "kinematics/evaluate_parts.hpp"
#include "kinematics/expression_limits.hpp"
#include "kinematics/kernel_run.hpp"
#include "kinematics/limits.hpp"

namespace polyglide {
namespace {

void check_length(std::size_t size, std::size_t wanted, bool may_be_empty, const char* what) {
  if (size != wanted && !(may_be_empty && size == 0))
    throw std::invalid_argument(std::string("Evaluator: ") + what + " has " + std::to_string(size) +
                                " entries for " + std::to_string(wanted) + " poses");
}

void check(const PoseBatch& poses) {
  check_length(poses.y.size(), poses.size(), false, "column y");
  check_length(poses.z.size(), poses.size(), false, "column z");
  for (const auto& angle : poses.angles)
    check_length(angle.size(), poses.size(), true, "a column of angles");
  for (const auto& part : poses.quaternion)
    check_length(part.size(), poses.size(), poses.quaternion[0].empty(),
                 "a column of the quaternion");
}

void make_columns(const Machine& machine, const PoseBatch& poses, BatchResult& result) {
  const std::size_t size = poses.size(), drives = machine.model.drives.size();
  const auto column = [&](auto& data, unsigned wanted, std::size_t count = 1) {
    data.resize((poses.wanted & wanted) != 0 ? size * count : 0);
  };
  result.limit.resize(size);
  column(result.inverse_condition, Wanted::condition);
  column(result.orientation, Wanted::orientation);
  column(result.frobenius, Wanted::frobenius);
  column(result.smallest, Wanted::smallest);
  column(result.transmission, Wanted::transmission);
  column(result.softest, Wanted::stiffness);
  column(result.stiffest, Wanted::stiffness);
  column(result.drives, Wanted::drives, drives);
  column(result.jacobian, Wanted::jacobian, drives * machine.task.axes.size());
}

constexpr std::size_t kGrain = 8 * batch::kBlock;

}  // namespace

bool has_rotations(const PoseBatch& poses) {
  return !poses.quaternion[0].empty() ||
         std::any_of(poses.angles.begin(), poses.angles.end(),
                     [](const auto& angle) { return !angle.empty(); });
}

Pose pose_at(const PoseBatch& poses, std::size_t i) {
  const Vector3 at(poses.x[i], poses.y[i], poses.z[i]);
  if (!has_rotations(poses)) return {at, poses.rotation};
  if (!poses.quaternion[0].empty()) {
    const auto& q = poses.quaternion;
    return {at, Eigen::Quaterniond(q[0][i], q[1][i], q[2][i], q[3][i]).normalized()};
  }
  Eigen::Matrix<double, 6, 1> coordinates;
  coordinates.head<3>() = at;
  for (int k = 0; k < 3; ++k) coordinates[3 + k] = poses.angles[k].empty() ? 0 : poses.angles[k][i];
  return pose_of(coordinates);
}

Evaluator::Evaluator(const Machine& machine, const std::vector<std::string>& ignored)
    : machine_(machine), ignored_(ignored) {
  const bool fits = machine_.model.drives.size() <= batch::kMostDrives;
  if (machine_.legs && machine_.task.pure && fits) {
    for (Leg& leg : machine_.legs->legs) {
      const int joint = machine_.model.freedoms[machine_.model.drives[leg.drive]].joint;
      const std::string stroke = "stroke " + machine_.model.mechanism.joints[joint].name;
      if (is_ignored(stroke + " min", ignored_)) leg.stroke.min = Range{}.min;
      if (is_ignored(stroke + " max", ignored_)) leg.stroke.max = Range{}.max;
    }
    model_ = std::make_shared<const BatchModel>(machine_, ignored_);
    limit_names_ = model_->limit_names();
    const auto expressions =
        std::make_shared<const BatchExpressions>(machine_.model, ignored_, limit_names_);
    const auto clearances =
        std::make_shared<const BatchClearances>(machine_, ignored_, limit_names_);
    if (!expressions->empty()) expressions_ = expressions;
    if (!clearances->empty()) clearances_ = clearances;
  } else {
    limit_names_ = general_limit_names(machine_);
  }
}

int Evaluator::limit_index(const std::string& name) const {
  const auto at = std::find(limit_names_.begin(), limit_names_.end(), name);
  return at == limit_names_.end() ? 0 : static_cast<int>(at - limit_names_.begin());
}

void Evaluator::evaluate(const PoseBatch& poses, BatchResult& result) const {
  check(poses);
  make_columns(machine_, poses, result);
  if (!model_) {
    evaluate_general(poses, result);
    return;
  }
  // Late limits ask for drives, whether or not they are wanted.
  const bool late = expressions_ || clearances_, drives = (poses.wanted & Wanted::drives) != 0;
  if (late) result.drives.resize(poses.size() * machine_.model.drives.size());
  evaluate_legs(poses, result);
  if (late && !drives) result.drives.clear();
}

void Evaluator::check_late_limits(const PoseBatch& poses, std::size_t first, std::size_t last,
                                  BatchResult& result) const {
  if (!expressions_ && !clearances_) return;
  std::vector<char> stopped(last - first);
  for (std::size_t i = first; i < last; ++i) stopped[i - first] = result.limit[i] >= 0;
  if (expressions_) expressions_->check(poses, first, last, result);
  if (clearances_) clearances_->check(poses, first, last, result);
  for (std::size_t i = first; i < last; ++i)
    if (!stopped[i - first] && result.limit[i] >= 0) clear_at(i, result);
}

void Evaluator::evaluate_legs(const PoseBatch& poses, BatchResult& result) const {
  const auto run = [&](const KernelRun& kernel) {
    in_blocks(poses.size(), kGrain, [&](std::size_t first, std::size_t last) {
      kernel(first, last);
      check_late_limits(poses, first, last, result);
    });
  };
  if (has_rotations(poses)) {
    run(KernelRun(model_->turning(), poses, result));
    return;
  }
  if (poses.rotation.coeffs().allFinite() && model_->commands(poses.rotation)) {
    const batch::KernelModel model = model_->turned(poses.rotation);
    run(KernelRun(model, poses, result));
    return;
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    result.limit[i] =
        limit_of_coordinates(machine_, pose_at(poses, i), static_cast<int>(limit_names_.size()));
    clear_at(i, result);
  }
}

void Evaluator::forward(const DriveBatch& drives, ForwardResult& result) const {
  check_length(drives.drives.size(), drives.size * machine_.model.drives.size(), false,
               "the array of drives");
  for (std::size_t k = 0; k < 7; ++k) {
    check_length(drives.start[k].size(), drives.size, drives.start[0].empty(),
                 "a column of starts");
    if (drives.start[k].empty())
      result.pose[k].assign(drives.size, k == 3 ? 1 : 0);
    else
      result.pose[k] = drives.start[k];
  }
  result.residual.resize(drives.size);
  const int rotations = machine_.task.rotations;
  // Two free rotations are no set of directions that turning keeps.
  if (model_ && rotations != 2)
    forward_legs(drives, result);
  else
    forward_general(drives, result);
}

void Evaluator::forward_legs(const DriveBatch& drives, ForwardResult& result) const {
  const ForwardRun run(model_->turning(), drives, result);
  in_blocks(drives.size, kGrain, run);
}

int Evaluator::inverse(const Pose& pose, Eigen::VectorXd& drives) const {
  PoseBatch batch;
  batch.x = {pose.position.x()};
  batch.y = {pose.position.y()};
  batch.z = {pose.position.z()};
  batch.rotation = pose.rotation;
  batch.wanted = Wanted::drives;
  BatchResult result;
  evaluate(batch, result);
  drives = Eigen::Map<const Eigen::VectorXd>(result.drives.data(),
                                             static_cast<Eigen::Index>(result.drives.size()));
  return result.limit[0];
}

}  // namespace polyglide
