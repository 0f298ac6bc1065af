#include "catalog/mechanism.hpp"

#include <algorithm>

namespace polyglide {

int freedoms(JointType type) {
  switch (type) {
    case JointType::revolute:
    case JointType::prismatic:
    case JointType::helical:
      return 1;
    case JointType::cylindrical:
    case JointType::universal:
      return 2;
    case JointType::spherical:
    case JointType::planar:
      return 3;
    case JointType::weld:
      return 0;
  }
  return 0;
}

bool is_translation(JointType type, int index) {
  switch (type) {
    case JointType::prismatic:
      return true;
    case JointType::cylindrical:
      return index == 1;
    case JointType::planar:
      return index < 2;
    default:
      return false;
  }
}

const std::vector<std::string>& joint_words() {
  static const std::vector<std::string> words = {"revolute",  "prismatic", "helical", "cylindrical",
                                                 "universal", "spherical", "planar",  "weld"};
  return words;
}

std::string to_string(JointType type) { return joint_words()[static_cast<std::size_t>(type)]; }

std::optional<JointType> joint_type(std::string_view word) {
  const auto& words = joint_words();
  const auto found = std::ranges::find(words, word);
  if (found == words.end()) return std::nullopt;
  return static_cast<JointType>(found - words.begin());
}

std::string clearance_name(const Mechanism& mechanism, const std::array<int, 2>& pair) {
  return "clearance " + mechanism.shapes[pair[0]].name + ' ' + mechanism.shapes[pair[1]].name;
}

std::vector<std::string> listed_limits(const Mechanism& mechanism) {
  std::vector<std::string> names;
  for (const HalfSpaceLimit& limit : mechanism.limits) names.push_back(limit.name);
  for (const ExpressionLimit& limit : mechanism.expressions) names.push_back(limit.name);
  for (const ClearanceLimit& limit : mechanism.clearances) names.push_back(limit.name);
  return names;
}

}  // namespace polyglide
