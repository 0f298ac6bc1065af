#include "kinematics/limb_wrenches.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "kinematics/motion.hpp"
#include "kinematics/screw_words.hpp"

namespace polyglide {
namespace {

/// A part of the mechanism between two bodies.
struct Stage {
  int from = 0, to = 0;
  std::vector<int> joints;
};

/// Bodies and joints that can be reached from `start` without passing through `blocked`.
std::vector<int> reached_joints(const Mechanism& mechanism, int start, int blocked) {
  std::vector<bool> seen(mechanism.bodies.size(), false), taken(mechanism.joints.size(), false);
  std::vector<int> open{start};
  seen[start] = true;
  while (!open.empty()) {
    const int body = open.back();
    open.pop_back();
    for (std::size_t j = 0; j < mechanism.joints.size(); ++j) {
      const auto [first, second] = mechanism.joints[j].bodies;
      if (first != body && second != body) continue;
      taken[j] = true;
      const int other = first == body ? second : first;
      if (!seen[other] && other != blocked) open.push_back(other);
      seen[other] = true;
    }
  }
  std::vector<int> joints;
  for (std::size_t j = 0; j < taken.size(); ++j)
    if (taken[j]) joints.push_back(static_cast<int>(j));
  return joints;
}

bool touches(const Mechanism& mechanism, const std::vector<int>& joints, int body) {
  return std::ranges::any_of(joints, [&](int j) {
    const auto& bodies = mechanism.joints[j].bodies;
    return bodies[0] == body || bodies[1] == body;
  });
}

/// Joints of every limb between the ends of a stage.
std::vector<std::vector<int>> split_into_limbs(const Mechanism& mechanism, const Stage& stage) {
  std::vector<int> group(mechanism.bodies.size());
  std::iota(group.begin(), group.end(), 0);
  const auto ends = [&](int body) { return body == stage.from || body == stage.to; };
  for (const int j : stage.joints) {
    const auto [first, second] = mechanism.joints[j].bodies;
    if (!ends(first) && !ends(second))  // copies: std::replace takes references into the group
      std::replace(group.begin(), group.end(), int{group[second]}, int{group[first]});
  }
  std::map<int, std::vector<int>> by_group;  // a direct joint is a limb of its own
  for (const int j : stage.joints) {
    const auto [first, second] = mechanism.joints[j].bodies;
    const int body = ends(first) ? second : first;
    by_group[ends(body) ? -1 - j : group[body]].push_back(j);
  }
  std::vector<std::vector<int>> limbs;
  for (auto& [key, joints] : by_group)
    if (touches(mechanism, joints, stage.from) && touches(mechanism, joints, stage.to))
      limbs.push_back(std::move(joints));
  std::ranges::sort(limbs);
  return limbs;
}

/// Cuts the mechanism at the bodies through which every way to the platform leads. Parts
/// that are single limbs one after the other stay together: they are one serial limb.
std::vector<Stage> split_into_stages(const Mechanism& mechanism) {
  std::vector<std::pair<std::size_t, int>> cuts;  // by how many joints lie before
  for (int body = 0; body < static_cast<int>(mechanism.bodies.size()); ++body) {
    if (body == mechanism.base || body == mechanism.platform) continue;
    const std::vector<int> before = reached_joints(mechanism, mechanism.base, body);
    if (!touches(mechanism, before, mechanism.platform)) cuts.emplace_back(before.size(), body);
  }
  std::ranges::sort(cuts);
  cuts.emplace_back(mechanism.joints.size(), mechanism.platform);
  std::vector<Stage> stages;
  bool previous_single = false;
  int from = mechanism.base;
  for (const auto& [size, body] : cuts) {
    const std::vector<int> before = reached_joints(mechanism, mechanism.base, body);
    const std::vector<int> earlier = from == mechanism.base
                                         ? std::vector<int>{}
                                         : reached_joints(mechanism, mechanism.base, from);
    Stage stage{from, body, {}};
    std::ranges::set_difference(before, earlier, std::back_inserter(stage.joints));
    const bool single = split_into_limbs(mechanism, stage).size() == 1;
    if (single && previous_single) {
      stages.back().to = body;
      stages.back().joints.insert(stages.back().joints.end(), stage.joints.begin(),
                                  stage.joints.end());
    } else {
      stages.push_back(std::move(stage));
    }
    previous_single = single;
    from = body;
  }
  return stages;
}

/// The mechanism with only these joints and their bodies, `to` the platform of `from`.
Mechanism part(const Mechanism& whole, const std::vector<int>& joints, int from, int to) {
  Mechanism limb;
  limb.bodies = {whole.bodies[from], whole.bodies[to]};
  limb.platform = 1;
  limb.tool = whole.tool;
  std::map<int, int> place{{from, 0}, {to, 1}};
  for (const int j : joints) {
    Joint joint = whole.joints[j];
    for (int& body : joint.bodies) {
      const auto [found, is_new] = place.try_emplace(body, static_cast<int>(limb.bodies.size()));
      if (is_new) limb.bodies.push_back(whole.bodies[body]);
      body = found->second;
    }
    limb.joints.push_back(std::move(joint));
  }
  return limb;
}

/// Wrenches reciprocal to twists [w; v/size] of the tool point, as [f; n/size] about it.
Eigen::MatrixXd reciprocal(const Eigen::MatrixXd& twists) {
  Eigen::MatrixXd swapped(twists.cols(), 6);
  swapped << twists.bottomRows(3).transpose(), twists.topRows(3).transpose();
  return kernel_of(swapped, 1).basis;
}

/// The wrench with so much of the couples added that no pitch is left, where they can.
Screw without_pitch(Screw wrench, const std::vector<Screw>& constraints) {
  const Vector3 force = wrench.head<3>();
  Vector3 along = Vector3::Zero();  // part of the force's direction that the couples span
  for (const Screw& constraint : constraints)
    if (constraint.head<3>().isZero(1e-9))
      along += force.dot(constraint.tail<3>()) * constraint.tail<3>();
  const double reach = force.dot(along);
  if (reach > 0.01) wrench.tail<3>() -= force.dot(wrench.tail<3>()) / reach * along;
  return wrench;
}

LimbWrenches wrenches_of(const Mechanism& limb) {
  LimbWrenches wrenches;
  for (const Joint& joint : limb.joints) wrenches.joints.push_back(joint.name);
  wrenches.name = limb_names(wrenches.joints);
  const Model model = compile(limb);
  const Freedoms free = freedoms_at(model, home(model));
  const Eigen::MatrixXd always = reciprocal(free.platform);
  const Eigen::MatrixXd held = reciprocal(hold_drives(model, free).platform);
  wrenches.connectivity = 6 - static_cast<int>(always.cols());
  wrenches.constraints = plain_basis(always, limb.tool, model.size);
  const Eigen::Index count = held.cols() - always.cols();
  if (count == 0) return wrenches;
  // What holding the drives adds, as far as the constraints do not bear it already.
  const Eigen::MatrixXd added = held - always * (always.transpose() * held);
  const Svd svd = svd_of(added);
  for (const Screw& wrench : plain_basis(svd.u.leftCols(count), limb.tool, model.size))
    wrenches.actuations.push_back(without_pitch(wrench, wrenches.constraints));
  return wrenches;
}

}  // namespace

std::string limb_names(const std::vector<std::string>& joints) {
  std::vector<std::string> names;
  for (const std::string& joint : joints) {
    const std::string limb = joint.substr(0, joint.rfind('.'));
    if (std::ranges::find(names, limb) == names.end()) names.push_back(limb);
  }
  return fmt::format("{}", fmt::join(names, "–"));
}

std::vector<LimbWrenches> limb_wrenches(const Mechanism& mechanism) {
  std::vector<LimbWrenches> result;
  for (const Stage& stage : split_into_stages(mechanism))
    for (const std::vector<int>& joints : split_into_limbs(mechanism, stage)) {
      result.push_back(wrenches_of(part(mechanism, joints, stage.from, stage.to)));
      result.back().from = stage.from;
      result.back().to = stage.to;
    }
  return result;
}

}  // namespace polyglide
