#include "kinematics/limb_wrenches.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "kinematics/motion.hpp"
#include "kinematics/screw_words.hpp"

namespace polyglide {
namespace {

/// Joints of every limb; dangling bodies make limbs that do not reach the platform.
std::vector<std::vector<int>> split_into_limbs(const Mechanism& mechanism) {
  std::vector<int> group(mechanism.bodies.size());
  std::iota(group.begin(), group.end(), 0);
  const auto ends = [&](int body) { return body == mechanism.base || body == mechanism.platform; };
  for (const Joint& joint : mechanism.joints) {
    const auto [first, second] = joint.bodies;
    if (!ends(first) && !ends(second))
      std::replace(group.begin(), group.end(), group[second], group[first]);
  }
  std::map<int, std::vector<int>> by_group;  // a direct joint is a limb of its own
  for (int j = 0; j < static_cast<int>(mechanism.joints.size()); ++j) {
    const auto [first, second] = mechanism.joints[j].bodies;
    const int body = ends(first) ? second : first;
    by_group[ends(body) ? -1 - j : group[body]].push_back(j);
  }
  std::vector<std::vector<int>> limbs;
  for (auto& [key, joints] : by_group) limbs.push_back(std::move(joints));
  std::ranges::sort(limbs);
  return limbs;
}

/// The mechanism with only these joints and their bodies.
Mechanism part(const Mechanism& whole, const std::vector<int>& joints) {
  Mechanism limb;
  limb.bodies = {whole.bodies[whole.base], whole.bodies[whole.platform]};
  limb.platform = 1;
  limb.tool = whole.tool;
  std::map<int, int> place{{whole.base, 0}, {whole.platform, 1}};
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

bool joins_base_to_platform(const Mechanism& limb) {
  const auto at = [&](int body) {
    return std::ranges::any_of(limb.joints, [&](const Joint& joint) {
      return joint.bodies[0] == body || joint.bodies[1] == body;
    });
  };
  return at(0) && at(1);
}

/// What the joints' names have in common before a dot.
std::string common_name(const Mechanism& limb) {
  const std::string& first = limb.joints.front().name;
  const std::size_t dot = first.rfind('.');
  if (dot == std::string::npos) return first;
  const std::string stem = first.substr(0, dot + 1);
  const bool shared = std::ranges::all_of(
      limb.joints, [&](const Joint& joint) { return joint.name.starts_with(stem); });
  return shared ? stem.substr(0, dot) : first;
}

/// Wrenches reciprocal to twists [w; v/size] of the tool point, as [f; n/size] about it.
Eigen::MatrixXd reciprocal(const Eigen::MatrixXd& twists) {
  Eigen::MatrixXd swapped(twists.cols(), 6);
  swapped << twists.bottomRows(3).transpose(), twists.topRows(3).transpose();
  return kernel_of(swapped, 1).basis;
}

}  // namespace

std::vector<LimbWrenches> limb_wrenches(const Mechanism& mechanism) {
  std::vector<LimbWrenches> result;
  for (const std::vector<int>& joints : split_into_limbs(mechanism)) {
    const Mechanism limb = part(mechanism, joints);
    if (!joins_base_to_platform(limb)) continue;
    LimbWrenches wrenches;
    wrenches.name = common_name(limb);
    for (const Joint& joint : limb.joints) wrenches.joints.push_back(joint.name);
    const Model model = compile(limb);
    const Freedoms free = freedoms_at(model, home(model));
    const Eigen::MatrixXd always = reciprocal(free.platform);
    const Eigen::MatrixXd held = reciprocal(hold_drives(model, free).platform);
    wrenches.connectivity = 6 - static_cast<int>(always.cols());
    wrenches.constraints = plain_basis(always, limb.tool, model.size);
    result.push_back(std::move(wrenches));
    const Eigen::Index count = held.cols() - always.cols();
    if (count == 0) continue;
    // What holding the drives adds, as far as the constraints do not bear it already.
    const Eigen::MatrixXd added = held - always * (always.transpose() * held);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(added, Eigen::ComputeThinU);
    result.back().actuations = plain_basis(svd.matrixU().leftCols(count), limb.tool, model.size);
  }
  return result;
}

}  // namespace polyglide
