#include "kinematics/limits.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/clearance.hpp"
#include "kinematics/expression_limits.hpp"

namespace polyglide {
namespace {

constexpr double kSlack = 1e-9;  // [m, rad] a posture on its limit is allowed

bool cone_broken(const Joint& joint, const Posture& posture) {
  if (!joint.cone) return false;
  // The axis is carried by both bodies; the angle between its two images is the deflection.
  const Vector3 a = posture.bodies[joint.bodies[0]].linear() * joint.cone_axis;
  const Vector3 b = posture.bodies[joint.bodies[1]].linear() * joint.cone_axis;
  return std::atan2(a.cross(b).norm(), a.dot(b)) > *joint.cone + kSlack;
}

bool plane_broken(const HalfSpaceLimit& limit, const Posture& posture) {
  for (const Vector3& point : limit.points)
    for (const auto& plane : limit.planes)
      if (plane.normal.dot(posture.bodies[limit.body] * point) > plane.offset + kSlack) return true;
  return false;
}

}  // namespace

bool is_ignored(const std::string& limit, const std::vector<std::string>& ignored) {
  return std::any_of(ignored.begin(), ignored.end(), [&](const std::string& word) {
    return limit == word || limit.substr(0, limit.find(' ')) == word;
  });
}

std::vector<std::string> late_limit_names(const Mechanism& mechanism,
                                          const std::vector<std::string>& ignored) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const ExpressionLimit& limit : mechanism.expressions)
    if (!is_ignored(limit.name, ignored)) add(limit.name);
  for (const WatchedPair& pair : watched_pairs(mechanism, ignored)) add(pair.name);
  return names;
}

std::string broken_range(const Model& model, const Posture& posture, int j) {
  const Joint& joint = model.mechanism.joints[j];
  for (std::size_t i = 0; i < joint.range.size(); ++i) {
    const double q = posture.q[model.first_freedom[j] + static_cast<int>(i)];
    const bool driven =
        std::count(joint.driven.begin(), joint.driven.end(), static_cast<int>(i)) > 0;
    const std::string name = (driven ? "stroke " : "range ") + joint.name;
    if (q < joint.range[i].min - kSlack) return name + " min";
    if (q > joint.range[i].max + kSlack) return name + " max";
  }
  return "";
}

std::string broken_limit(const Model& model, const Posture& posture,
                         const std::vector<std::string>& ignored) {
  for (int j = 0; j < static_cast<int>(model.mechanism.joints.size()); ++j) {
    const Joint& joint = model.mechanism.joints[j];
    const std::string range = broken_range(model, posture, j);
    if (!range.empty() && !is_ignored(range, ignored)) return range;
    if (cone_broken(joint, posture) && !is_ignored("cone " + joint.name, ignored))
      return "cone " + joint.name;
  }
  for (const HalfSpaceLimit& limit : model.mechanism.limits)
    if (plane_broken(limit, posture) && !is_ignored(limit.name, ignored)) return limit.name;
  const std::string expression = broken_expression(model, posture, ignored);
  return expression.empty() ? broken_clearance(model, posture, ignored) : expression;
}

}  // namespace polyglide
