#include "kinematics/closure_bounds.hpp"

#include "kinematics/limits.hpp"

namespace polyglide {
namespace {

bool same(const PoseBox& a, const PoseBox& b) {
  for (int k = 0; k < 6; ++k)
    if (a[k].lower() != b[k].lower() || a[k].upper() != b[k].upper()) return false;
  return true;
}

/// J with J T = D for every T and D inside; unbounded where T may be singular. J = D C - J (T C -
/// I) with C about the inverse of T.
IntervalMatrix divided(const IntervalMatrix& d, const IntervalMatrix& t) {
  const int n = t.rows();
  const Eigen::MatrixXd inverse = middle(t).fullPivLu().inverse();
  IntervalMatrix result(d.rows(), n);
  for (int i = 0; i < d.rows(); ++i)
    for (int j = 0; j < n; ++j) result(i, j) = kAnything;
  if (!inverse.allFinite()) return result;
  IntervalMatrix rest = product(t, inverse);
  Interval most(0.0);
  for (int j = 0; j < n; ++j) {
    rest(j, j) -= 1.0;
    Interval sum(0.0);
    for (int i = 0; i < n; ++i) sum += magnitude(rest(i, j));
    most = std::max(most.upper(), sum.upper());
  }
  if (!(most.upper() < 1)) return result;
  const IntervalMatrix start = product(d, inverse);
  for (int i = 0; i < d.rows(); ++i) {
    Interval largest(0.0);
    for (int j = 0; j < n; ++j) largest = std::max(largest.upper(), magnitude(start(i, j)));
    const double bound = (largest / (1.0 - most)).upper();
    for (int j = 0; j < n; ++j) result(i, j) = Interval(-bound, bound);
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round)
      for (int j = 0; j < n; ++j) {
        Interval value = start(i, j);
        for (int k = 0; k < n; ++k) value -= result(i, k) * rest(k, j);
        result(i, j) = common(result(i, j), value);
      }
  }
  return result;
}

}  // namespace

ClosureBounds::ClosureBounds(const Machine& machine, ClosureSystem system)
    : machine_(&machine), system_(std::move(system)) {
  offset_.setZero();
}

std::optional<ClosureBounds> ClosureBounds::make(const Machine& machine,
                                                 const std::vector<std::string>& ignored,
                                                 const Eigen::Quaterniond& rotation) {
  if (!late_limit_names(machine.model.mechanism, ignored).empty()) return std::nullopt;
  auto system = ClosureSystem::make(machine);
  if (!system) return std::nullopt;
  ClosureBounds result(machine, std::move(*system));
  for (const int drive : machine.model.drives)
    if (result.system_.part_of(drive) < 0) return std::nullopt;
  result.add_limits(ignored);
  if (result.size() > kMost) return std::nullopt;
  const std::vector<double> zero(result.system_.commanded().size(), 0.0);
  for (const ClosurePart& part : result.system_.parts()) {
    const auto root =
        root_at(result.equations_of(part), zero, std::vector<double>(part.unknowns.size(), 0.0));
    if (!root) return std::nullopt;
    result.home_.push_back({*root, true, nullptr});
  }
  const auto asked = coordinates_of({Vector3::Zero(), rotation.normalized()});
  for (int k : result.system_.commanded()) result.offset_[k] = k < 3 ? 0.0 : asked[k];
  return result;
}

double ClosureBounds::effort() const {
  constexpr double kPerProduct = 0.8, kPerBox = 100;
  double products = 0;
  for (const ClosurePart& part : system_.parts())
    products += std::pow(static_cast<double>(part.unknowns.size()), 3);
  return kPerBox + kPerProduct * products;
}

ParametricEnclosure ClosureBounds::equations_of(const ClosurePart& part) const {
  return [this, &part](const auto& unknowns, const auto& parameters) {
    return system_.enclose(part, unknowns, parameters);
  };
}

Interval ClosureBounds::scale_of(int parameter) const {
  return Interval(system_.commanded()[parameter] < 3 ? machine_->model.size : 1.0);
}

std::vector<Interval> ClosureBounds::parameters_of(const PoseBox& box) const {
  std::vector<Interval> result;
  for (int k : system_.commanded())
    result.push_back(k < 3 ? box[k] / machine_->model.size : box[k] + offset_[k]);
  return result;
}

BoxLimits::BranchPointer ClosureBounds::follow(const PoseBox& box,
                                               const BranchPointer& from) const {
  constexpr int kPieces = 8, kPiecesFromHome = 64;
  const auto before = std::static_pointer_cast<const Followed>(from);
  if (before && same(before->box, box)) return from;
  if (before && beyond_reach(box)) return from;
  auto result = std::make_shared<Followed>();
  result->box = box;
  const std::vector<Interval> parameters = parameters_of(box);
  const std::vector<FollowedRoot>& roots = before ? before->roots : home_;
  for (std::size_t i = 0; i < roots.size(); ++i)
    result->roots.push_back(follow_root(equations_of(system_.parts()[i]), parameters, roots[i],
                                        before ? kPieces : kPiecesFromHome));
  return result;
}

ClosureBounds::Known ClosureBounds::pose_of_box(const PoseBox& box) const {
  Known result{std::vector<Interval>(system_.variables(), Interval(0.0)), {}, nullptr};
  const std::vector<Interval> parameters = parameters_of(box);
  for (std::size_t k = 0; k < parameters.size(); ++k)
    result.variables[system_.pose_variable(system_.commanded()[k])] = parameters[k];
  return result;
}

ClosureBounds::Known ClosureBounds::known(const PoseBox& box, const BranchPointer& branch) const {
  Known result = pose_of_box(box);
  result.followed = std::static_pointer_cast<const Followed>(branch);
  const std::vector<Interval> parameters = parameters_of(box);
  const bool in_middle = same(box, middle_of(result.followed->box));
  for (std::size_t p = 0; p < system_.parts().size(); ++p) {
    const FollowedRoot& root = result.followed->roots[p];
    const IntervalMatrix* rates = nullptr;
    std::vector<Interval> values(system_.parts()[p].unknowns.size(), kAnything);
    if (in_middle && root.in_middle) {
      values = root.point.root;
      rates = &root.point.rates;
    } else if (root.whole) {
      values = moved(root.point, root.whole->rates, parameters);
      rates = &root.whole->rates;
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = common(values[i], root.whole->roots[i]);
    }
    for (std::size_t i = 0; i < values.size(); ++i)
      result.variables[system_.parts()[p].unknowns[i]] = values[i];
    result.rates.push_back(rates);
  }
  return result;
}

/// Of a variable, per parameter; both scaled.
Interval ClosureBounds::rate(const Known& known, int variable, int parameter) const {
  const int part = system_.part_of(variable);
  if (part >= 0) {
    if (known.rates[part] == nullptr) return kAnything;
    return (*known.rates[part])(system_.parts()[part].columns[variable], parameter);
  }
  const bool own = variable == system_.pose_variable(system_.commanded()[parameter]);
  return Interval(own ? 1.0 : 0.0);
}

/// Task rates per rate of the commanded coordinates, SI.
IntervalMatrix ClosureBounds::task_rates(const Known& known) const {
  const std::vector<int>& axes = machine_->task.axes;
  const auto pose = [&](int k) { return known.variables[system_.pose_variable(k)]; };
  const std::array<IntervalVector, 3> turning = turn_by({pose(3), pose(4), pose(5)}).axes;
  const int n = static_cast<int>(axes.size());
  IntervalMatrix by_task(n, n);
  for (int i = 0; i < static_cast<int>(axes.size()); ++i)
    for (int j = 0; j < static_cast<int>(axes.size()); ++j) {
      if (axes[i] < 3) {
        by_task(i, j) = Interval(i == j ? 1.0 : 0.0);
        continue;
      }
      Interval sum(0.0);
      for (int k = 0; k < 3; ++k)
        sum += turning[k][axes[i] - 3] * rate(known, system_.pose_variable(3 + k), j) / scale_of(j);
      by_task(i, j) = sum;
    }
  return by_task;
}

IntervalMatrix ClosureBounds::jacobian(const PoseBox& box, const BranchPointer& branch) const {
  const auto& followed = static_cast<const Followed&>(*branch);
  const bool here = same(box, followed.box) || same(box, middle_of(followed.box));
  const Known known = this->known(box, here ? branch : follow(box, branch));
  const Model& model = machine_->model;
  const std::vector<int>& axes = machine_->task.axes;
  const int n = static_cast<int>(axes.size());
  IntervalMatrix result(static_cast<int>(model.drives.size()), n);
  for (int d = 0; d < result.rows(); ++d)
    for (int k = 0; k < n; ++k) {
      const int drive = model.drives[d];
      const Interval scale(model.freedoms[drive].translational ? model.size : 1.0);
      result(d, k) = scale * rate(known, drive, k) / scale_of(k);
    }
  if (!known.all() || machine_->task.rotations == 0) return result;
  result = divided(result, task_rates(known));
  for (int k = 0; k < n; ++k)
    for (int d = 0; axes[k] > 2 && d < result.rows(); ++d)
      result(d, k) /= machine_->task.characteristic_length;
  return result;
}

}  // namespace polyglide
