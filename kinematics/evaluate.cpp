#include "kinematics/evaluate.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "kinematics/batch_kernels.hpp"
#include "kinematics/batch_model.hpp"
#include "kinematics/clearance.hpp"
#include "kinematics/expression_limits.hpp"
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
  for (const std::string& name : late_limit_names(machine.model.mechanism)) add(name);
  add("motion");
  add("not finite");
  return names;
}

bool is_finite(const Pose& pose) {
  return pose.position.allFinite() && pose.rotation.coeffs().allFinite();
}

/// The limit that needs no solving: a coordinate that is no number, or one that a pure
/// machine does not have; -1 when there is none.
int limit_of_coordinates(const Machine& machine, const Pose& pose, int names) {
  if (!is_finite(pose)) return names - 1;
  if (!machine.task.pure) return -1;
  Eigen::Matrix<double, 6, 1> rest = coordinates_of(pose);
  for (int axis : machine.task.axes) rest[axis] = 0;
  return rest.cwiseAbs().maxCoeff() > 1e-9 ? names - 2 : -1;
}

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

constexpr std::size_t kGrain = 8 * batch::kBlock;

signed char sign_of(double value) { return static_cast<signed char>((value > 0) - (value < 0)); }

/// A batch in the words of a kernel, and its answers brought back.
class KernelRun {
 public:
  KernelRun(const batch::KernelModel& model, const PoseBatch& poses, BatchResult& result)
      : model_(model), kernel_(batch::kernel_named(poses.instructions)) {
    in_ = {poses.x.data(), poses.y.data(), poses.z.data()};
    const auto given = [](const std::vector<double>& v) { return v.empty() ? nullptr : v.data(); };
    for (int k = 0; k < 4; ++k) in_.quaternion[k] = given(poses.quaternion[k]);
    for (int k = 0; k < 3; ++k) in_.angle[k] = given(poses.angles[k]);
    const auto wanted = [](std::vector<double>& v) { return v.empty() ? nullptr : v.data(); };
    out_.limit = result.limit.data();
    out_.orientation = result.orientation.empty() ? nullptr : result.orientation.data();
    out_.condition = wanted(result.inverse_condition);
    out_.frobenius = wanted(result.frobenius);
    out_.smallest = wanted(result.smallest);
    out_.transmission = wanted(result.transmission);
    out_.softest = wanted(result.softest);
    out_.stiffest = wanted(result.stiffest);
    out_.drives = wanted(result.drives);
    out_.jacobian = wanted(result.jacobian);
    out_.stride = poses.size();
  }

  void operator()(std::size_t first, std::size_t last) const {
    const std::size_t lanes = kernel_.lanes;
    for (std::size_t i = first; i < last; i += batch::kBlock) {
      const std::size_t count = std::min<std::size_t>(batch::kBlock, last - i);
      const std::size_t whole = count - count % lanes;
      if (whole > 0) run(i, whole);
      if (whole < count) run_rest(i + whole, count - whole);
    }
  }

 private:
  template <typename Columns, typename Move>
  static void for_each_output(Columns& out, const batch::KernelModel& model, const Move& move) {
    for (auto* column : {&out.condition, &out.frobenius, &out.smallest, &out.transmission,
                         &out.softest, &out.stiffest})
      move(*column, 1);
    move(out.drives, model.drives);
    move(out.jacobian, model.drives * model.columns);
  }

  static void advance(batch::KernelInput& in, std::size_t by) {
    const auto move = [by](const double*& column) {
      if (column) column += by;
    };
    move(in.x), move(in.y), move(in.z);
    for (auto& column : in.angle) move(column);
    for (auto& column : in.quaternion) move(column);
  }

  void run(std::size_t first, std::size_t count) const {
    batch::KernelInput in = in_;
    advance(in, first);
    batch::KernelOutput out = out_;
    out.limit += first;
    if (out.orientation) out.orientation += first;
    for_each_output(out, model_, [first](double*& column, int) {
      if (column) column += first;
    });
    kernel_.evaluate(model_, in, out, static_cast<int>(count));
  }

  /// Poses that fill no register: padded with the last one.
  void run_rest(std::size_t first, std::size_t count) const {
    constexpr std::size_t kWidest = batch::kMostLanes;
    double inputs[10][kWidest];
    batch::KernelInput in = in_;
    advance(in, first);
    int used = 0;
    const auto pad = [&](const double*& column) {
      if (!column) return;
      double* to = inputs[used++];
      for (std::size_t i = 0; i < kWidest; ++i) to[i] = column[std::min(i, count - 1)];
      column = to;
    };
    pad(in.x), pad(in.y), pad(in.z);
    for (auto& column : in.angle) pad(column);
    for (auto& column : in.quaternion) pad(column);

    int limits[kWidest];
    signed char orientations[kWidest];
    double answers[6 + 7 * batch::kMostDrives][kWidest];
    batch::KernelOutput out = out_, whole = out_;
    out.limit = limits;
    if (out.orientation) out.orientation = orientations;
    out.stride = kWidest;
    int at = 0;
    for_each_output(out, model_, [&](double*& column, int columns) {
      if (column) column = answers[at];
      at += columns;
    });
    kernel_.evaluate(model_, in, out, kernel_.lanes);
    std::copy_n(limits, count, whole.limit + first);
    if (out.orientation) std::copy_n(orientations, count, whole.orientation + first);
    at = 0;
    for_each_output(whole, model_, [&](double*& column, int columns) {
      for (int c = 0; column && c < columns; ++c)
        std::copy_n(answers[at + c], count,
                    column + static_cast<std::size_t>(c) * out_.stride + first);
      at += columns;
    });
  }

  const batch::KernelModel& model_;
  const batch::Kernel& kernel_;
  batch::KernelInput in_;
  batch::KernelOutput out_;
};

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

void clear_at(std::size_t i, BatchResult& result) {
  for (auto* column : {&result.inverse_condition, &result.frobenius, &result.smallest,
                       &result.transmission, &result.softest, &result.stiffest})
    if (!column->empty()) (*column)[i] = 0;
  if (!result.orientation.empty()) result.orientation[i] = 0;
}

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
  const batch::Kernel& kernel = batch::kernel_named(drives.instructions);
  const auto lanes = static_cast<std::size_t>(kernel.forward_lanes);
  const std::size_t rows = machine_.model.drives.size();
  in_blocks(drives.size, kGrain, [&](std::size_t first, std::size_t last) {
    const std::size_t whole = (last - first) - (last - first) % lanes;
    batch::ForwardColumns io{
        &drives.drives[first],  drives.size, &result.pose[0][first], &result.pose[1][first],
        &result.pose[2][first], {},          &result.residual[first]};
    for (int k = 0; k < 4; ++k) io.quaternion[k] = &result.pose[3 + k][first];
    if (whole > 0) kernel.forward(model_->turning(), io, static_cast<int>(whole));
    if (whole == last - first) return;
    // The rest fills no register: padded with the last one.
    constexpr std::size_t kWidest = batch::kMostLanes;
    const std::size_t begin = first + whole, count = last - begin;
    std::vector<double> drive(rows * kWidest);
    double pose[8][kWidest];
    for (std::size_t i = 0; i < kWidest; ++i) {
      const std::size_t from = begin + std::min(i, count - 1);
      for (std::size_t d = 0; d < rows; ++d)
        drive[d * kWidest + i] = drives.drives[d * drives.size + from];
      for (std::size_t k = 0; k < 7; ++k) pose[k][i] = result.pose[k][from];
    }
    kernel.forward(model_->turning(),
                   {drive.data(),
                    kWidest,
                    pose[0],
                    pose[1],
                    pose[2],
                    {pose[3], pose[4], pose[5], pose[6]},
                    pose[7]},
                   kernel.forward_lanes);
    for (std::size_t k = 0; k < 7; ++k) std::copy_n(pose[k], count, &result.pose[k][begin]);
    std::copy_n(pose[7], count, &result.residual[begin]);
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
