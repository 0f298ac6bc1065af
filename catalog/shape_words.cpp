#include "catalog/shape_words.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace polyglide {
namespace {

constexpr double kSame = 1e-9;  // [m] points nearer than this are one

/// * for any letters, ? for any one. Goes back to the last * only, so the cost is at most the
/// product of the lengths.
bool fits(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0, star = std::string_view::npos, taken = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p, ++n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++taken;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

int other_body(const Joint& joint, int body) {
  return joint.bodies[0] == body ? joint.bodies[1] : joint.bodies[0];
}

bool joins(const Joint& joint, int body) {
  return joint.bodies[0] == body || joint.bodies[1] == body;
}

std::set<int> bodies_of(const BodyShape& shape) {
  if (shape.form == BodyShape::Form::mesh) return {shape.body};
  std::set<int> bodies;
  for (const BodyPoint& point : shape.points) bodies.insert(point.body);
  return bodies;
}

/// Connected by a joint, or at one point of a third body by a joint each.
bool joined(const Mechanism& mechanism, int a, int b) {
  for (const Joint& first : mechanism.joints) {
    if (!joins(first, a)) continue;
    const int third = other_body(first, a);
    if (third == b) return true;
    for (const Joint& second : mechanism.joints)
      if (joins(second, b) && other_body(second, b) == third &&
          first.type != JointType::prismatic && second.type != JointType::prismatic &&
          (first.at - second.at).norm() < kSame)
        return true;
  }
  return false;
}

/// Whether `body` slides on the rail, or hangs on what slides there.
bool rides(const Mechanism& mechanism, const BodyShape& rail, int body) {
  if (rail.rail < 0) return false;
  const int carriage = other_body(mechanism.joints[rail.rail], rail.points.front().body);
  return body == carriage || std::ranges::any_of(mechanism.joints, [&](const Joint& joint) {
           return joins(joint, carriage) && joins(joint, body);
         });
}

}  // namespace

bool means(std::string_view word, std::string_view name) {
  if (fits(word, name)) return true;
  const std::size_t point = name.find('.');
  if (point == std::string_view::npos) return false;
  std::string_view limb = name.substr(0, point);
  if (fits(word, limb)) return true;
  while (!limb.empty() && std::isdigit(static_cast<unsigned char>(limb.back())))
    limb.remove_suffix(1);
  return !limb.empty() && fits(word, limb);
}

Contact contact(const Mechanism& mechanism, const BodyShape& a, const BodyShape& b) {
  Contact found = Contact::none;
  for (const int one : bodies_of(a))
    for (const int other : bodies_of(b)) {
      if (one == other) return Contact::same_body;
      if (joined(mechanism, one, other) || rides(mechanism, a, other) || rides(mechanism, b, one))
        found = Contact::joined;
    }
  return found;
}

std::vector<Vector3> joint_points(const Mechanism& mechanism, int body) {
  std::vector<Vector3> points;
  for (const Joint& joint : mechanism.joints) {
    if (joint.type == JointType::prismatic || !joins(joint, body)) continue;
    const auto same = [&](const Vector3& point) { return (point - joint.at).norm() < kSame; };
    if (std::ranges::none_of(points, same)) points.push_back(joint.at);
  }
  return points;
}

}  // namespace polyglide
