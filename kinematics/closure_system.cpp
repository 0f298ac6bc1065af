#include "kinematics/closure_system.hpp"

#include <deque>
#include <map>
#include <numeric>

#include "kinematics/interval_matrix.hpp"

namespace polyglide {
namespace {

constexpr int kPose = -1;  // a step of a path: the pose of the platform

/// The platform's displacement as six joints one after the other: shifts along x, y, z, turns
/// about z, y, x through the tool.
ScrewChain pose_chain(const Vector3& tool, int first) {
  ScrewChain chain;
  for (int k : {0, 1, 2, 5, 4, 3}) {
    ScrewFactor& factor = chain.emplace_back();
    factor.variable = first + k;
    factor.translational = k < 3;
    factor.axis = vector_of(Vector3::Unit(k % 3));
    factor.point = tool;
  }
  return chain;
}

std::vector<LoopStep> turned_back(std::vector<LoopStep> path) {
  std::reverse(path.begin(), path.end());
  for (LoopStep& step : path) step.sign = -step.sign;
  return path;
}

bool starts_with_pose(const std::vector<LoopStep>& path) {
  return !path.empty() && path.front().joint == kPose;
}

}  // namespace

ClosureSystem::ClosureSystem(const Machine& machine) : model_(&machine.model) {
  const std::vector<int>& axes = machine.task.axes;
  for (int k = 0; k < 6; ++k) {
    const bool commanded = std::count(axes.begin(), axes.end(), k) > 0;
    if (commanded) commanded_.push_back(k);
    if (!commanded && !machine.task.pure) followers_.push_back(k);
  }
  // What a pure machine cannot do stays zero, and is left out.
  for (ScrewFactor& factor : pose_chain(model_->mechanism.tool, pose_variable(0))) {
    const int k = factor.variable - pose_variable(0);
    if (!machine.task.pure || std::count(axes.begin(), axes.end(), k) > 0) pose_.push_back(factor);
  }
  owner_.assign(variables(), -1);
  find_paths();
}

/// Breadth first from base and platform, so that loops are short.
void ClosureSystem::find_paths() {
  const Mechanism& mechanism = model_->mechanism;
  const std::size_t bodies = mechanism.bodies.size();
  paths_.resize(bodies);
  tree_.assign(bodies, -1);
  std::vector<char> met(bodies, 0);
  paths_[mechanism.platform] = {{kPose, 1}};
  std::deque<int> open{mechanism.base, mechanism.platform};
  met[mechanism.base] = met[mechanism.platform] = 1;
  while (!open.empty()) {
    const int body = open.front();
    open.pop_front();
    for (int j = 0; j < static_cast<int>(mechanism.joints.size()); ++j) {
      const auto [first, second] = mechanism.joints[j].bodies;
      if (first != body && second != body) continue;
      const int other = first == body ? second : first;
      if (met[other]) continue;
      met[other] = 1;
      tree_[other] = j;
      paths_[other] = paths_[body];
      paths_[other].push_back({j, other == second ? 1 : -1});
      open.push_back(other);
    }
  }
}

ScrewChain ClosureSystem::chain_along(const std::vector<LoopStep>& path) const {
  const Posture start = home(*model_);
  ScrewChain chain;
  for (const LoopStep& step : path) {
    ScrewChain part = step.joint == kPose ? pose_ : joint_chain(*model_, step.joint, start);
    if (step.sign < 0) part = inverse(std::move(part));
    chain.insert(chain.end(), part.begin(), part.end());
  }
  return chain;
}

/// Per body the number of its part, -1 for base and platform.
std::vector<int> ClosureSystem::group_bodies() const {
  const Mechanism& mechanism = model_->mechanism;
  std::vector<int> group(mechanism.bodies.size());
  std::iota(group.begin(), group.end(), 0);
  const auto held = [&](int body) { return body == mechanism.base || body == mechanism.platform; };
  const auto unite = [&](int a, int b) {
    const auto [least, most] = std::minmax({group[a], group[b]});
    std::replace(group.begin(), group.end(), int{most}, int{least});
  };
  for (const Joint& joint : mechanism.joints) {
    const auto [a, b] = joint.bodies;
    if (!held(a) && !held(b)) unite(a, b);
  }
  // Coordinates that follow are unknowns of all limbs.
  if (!followers_.empty()) std::fill(group.begin(), group.end(), 0);
  group[mechanism.base] = group[mechanism.platform] = -1;
  return group;
}

void ClosureSystem::add_loop(int joint, ClosurePart& part) {
  const auto [first, second] = model_->mechanism.joints[joint].bodies;
  const std::vector<LoopStep>&out = paths_[first], &back = paths_[second];
  std::size_t shared = 0;
  while (shared < std::min(out.size(), back.size()) && out[shared].joint == back[shared].joint)
    ++shared;
  const auto rest = [shared](const std::vector<LoopStep>& path) {
    return std::vector<LoopStep>(path.begin() + static_cast<std::ptrdiff_t>(shared), path.end());
  };
  std::vector<LoopStep> through = rest(out);
  through.push_back({joint, 1});
  part.loops.push_back(
      {chain_along(through), chain_along(rest(back)), model_->mechanism.joints[joint].at});
  if (starts_with_pose(back) == starts_with_pose(out)) return;
  std::vector<LoopStep> limb = through;
  const std::vector<LoopStep> home = turned_back(back);
  limb.insert(limb.end(), home.begin(), home.end());
  if (starts_with_pose(out)) limb = turned_back(limb);
  limb.pop_back();  // the pose
  limbs_.push_back(std::move(limb));
}

std::vector<int> ClosureSystem::variables_of(int joint) const {
  std::vector<int> result(freedoms(model_->mechanism.joints[joint].type));
  std::iota(result.begin(), result.end(), model_->first_freedom[joint]);
  return result;
}

std::optional<ClosureSystem> ClosureSystem::make(const Machine& machine) {
  ClosureSystem system(machine);
  const Mechanism& mechanism = machine.model.mechanism;
  const std::vector<int> group = system.group_bodies();
  // Parts in the order of their first joint; one of its own for a joint from base to platform.
  std::map<int, std::pair<ClosurePart, std::vector<int>>> parts;
  for (int j = 0; j < static_cast<int>(mechanism.joints.size()); ++j) {
    const auto [a, b] = mechanism.joints[j].bodies;
    int key = group[a] >= 0 ? group[a] : group[b];
    if (key < 0)
      key = system.followers_.empty() ? static_cast<int>(mechanism.bodies.size()) + j : 0;
    auto& [part, candidates] = parts[key];
    const std::vector<int> own = system.variables_of(j);
    candidates.insert(candidates.end(), own.begin(), own.end());
    if (system.tree_[a] != j && system.tree_[b] != j) system.add_loop(j, part);
  }
  for (auto& [key, entry] : parts) {
    auto& [part, candidates] = entry;
    if (key == 0 && !system.followers_.empty())
      for (int k : system.followers_) candidates.push_back(system.pose_variable(k));
    if (!system.choose_unknowns(part, candidates)) return std::nullopt;
    system.parts_.push_back(std::move(part));
  }
  return system;
}

bool ClosureSystem::choose_unknowns(ClosurePart& part, const std::vector<int>& candidates) {
  part.columns.assign(variables(), -1);
  for (std::size_t i = 0; i < candidates.size(); ++i)
    part.columns[candidates[i]] = static_cast<int>(i);
  part.unknowns = candidates;
  const std::vector<Interval> zero(candidates.size(), Interval(0.0)), home(commanded_.size(), 0.0);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(0, static_cast<Eigen::Index>(zero.size()));
  if (!part.loops.empty()) jacobian = middle(enclose(part, zero, home).jacobian);
  auto chosen = independent_columns(jacobian.leftCols(zero.size()));
  if (!chosen) return false;
  std::sort(chosen->begin(), chosen->end());
  const auto rank = static_cast<Eigen::Index>(chosen->size());
  if (rank < static_cast<Eigen::Index>(candidates.size())) {
    Eigen::MatrixXd idle = Eigen::MatrixXd::Identity(zero.size(), zero.size());
    if (rank > 0)
      idle = Eigen::JacobiSVD<Eigen::MatrixXd>(jacobian.leftCols(zero.size()), Eigen::ComputeFullV)
                 .matrixV()
                 .rightCols(static_cast<Eigen::Index>(zero.size()) - rank)
                 .eval();
    if (!harmless(candidates, idle)) return false;
  }
  part.columns.assign(variables(), -1);
  part.unknowns.clear();
  for (int i : *chosen) {
    part.columns[candidates[i]] = static_cast<int>(part.unknowns.size());
    owner_[candidates[i]] = static_cast<int>(parts_.size());
    part.unknowns.push_back(candidates[i]);
  }
  for (std::size_t k = 0; k < commanded_.size(); ++k)
    part.columns[pose_variable(commanded_[k])] = static_cast<int>(part.unknowns.size() + k);
  return true;
}

/// Whether motions that leave the platform where it is are seen by no limit: rods that spin.
/// @param idle one column each
bool ClosureSystem::harmless(const std::vector<int>& candidates,
                             const Eigen::MatrixXd& idle) const {
  constexpr double kStill = 1e-9;
  const Mechanism& mechanism = model_->mechanism;
  if (!mechanism.limits.empty()) return false;
  const auto moves = [&](int variable) {
    const auto at = std::find(candidates.begin(), candidates.end(), variable);
    return at != candidates.end() && idle.row(at - candidates.begin()).norm() > kStill;
  };
  for (int drive : model_->drives)
    if (moves(drive)) return false;
  for (int k = 0; k < 6; ++k)
    if (moves(pose_variable(k))) return false;
  for (int j = 0; j < static_cast<int>(mechanism.joints.size()); ++j) {
    const Joint& joint = mechanism.joints[j];
    Eigen::Matrix3Xd turn = Eigen::Matrix3Xd::Zero(3, idle.cols());
    for (int variable : variables_of(j)) {
      if (!moves(variable)) continue;
      const Range range =
          joint.range.empty() ? Range{} : joint.range[variable - model_->first_freedom[j]];
      if (std::isfinite(range.min) || std::isfinite(range.max)) return false;
      const auto row = std::find(candidates.begin(), candidates.end(), variable);
      turn += model_->freedoms[variable].screw.head<3>() * idle.row(row - candidates.begin());
    }
    for (Eigen::Index c = 0; joint.cone && c < turn.cols(); ++c)
      if (turn.col(c).cross(joint.cone_axis).norm() > kStill) return false;
  }
  return true;
}

Enclosure ClosureSystem::enclose(const ClosurePart& part, const std::vector<Interval>& unknowns,
                                 const std::vector<Interval>& parameters) const {
  thread_local std::vector<Interval> all;
  all.assign(variables(), Interval(0.0));
  for (std::size_t i = 0; i < unknowns.size(); ++i) all[part.unknowns[i]] = unknowns[i];
  for (std::size_t k = 0; k < parameters.size(); ++k)
    all[pose_variable(commanded_[k])] = parameters[k];
  const int rows = 6 * static_cast<int>(part.loops.size());
  Enclosure result{std::vector<Interval>(rows, Interval(0.0)),
                   IntervalMatrix(rows, static_cast<int>(unknowns.size() + parameters.size()))};
  for (std::size_t l = 0; l < part.loops.size(); ++l)
    enclose_loop(part.loops[l], all, model_->size, part.columns, 6 * static_cast<int>(l), result);
  return result;
}

}  // namespace polyglide
