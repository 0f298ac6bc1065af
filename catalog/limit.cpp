#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "catalog/draft.hpp"
#include "catalog/shape_words.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

constexpr std::size_t kMostPairs = 10000;

HalfSpaceLimit read_half_space(const json& value, const Reader& reader,
                               const Mechanism& mechanism) {
  HalfSpaceLimit limit;
  limit.name = text(member(value, "name"));
  const json& body = member(value, "body");
  const auto found =
      std::ranges::find(mechanism.bodies, text(body, mechanism.bodies[mechanism.platform]));
  if (found == mechanism.bodies.end()) {
    reader.problems().add(body, "there is no body of this name",
                          did_you_mean(text(body), mechanism.bodies));
    return limit;
  }
  limit.body = static_cast<int>(found - mechanism.bodies.begin());
  const json& points = member(value, "points");
  if (points.is_array()) {
    for (const json& point : points) limit.points.push_back(reader.point(point, Compass{}));
  } else {
    for (const Joint& joint : mechanism.joints)
      if (joint.type != JointType::prismatic &&
          (joint.bodies[0] == limit.body || joint.bodies[1] == limit.body))
        limit.points.push_back(joint.at);
  }
  for (const json& plane : member(value, "inside")) {
    const json& normal = member(plane, "normal");
    if (!normal.is_array() || normal.size() != 3) continue;
    const Vector3 written(reader.number(normal[0]), reader.number(normal[1]),
                          reader.number(normal[2]));
    const double norm = written.norm();
    if (norm < 1e-12)
      reader.problems().add(normal, "a normal must have a length greater than zero");
    // The rule normal · point <= offset stays the same when both are scaled.
    const Vector3 unit = unit_vector(written);
    const double scale = unit == written ? 1 : norm;
    limit.planes.push_back({unit, reader.length(member(plane, "offset")) / scale});
  }
  return limit;
}

/// The shapes that a word means; told when there are none.
std::vector<int> shapes_of(const json& value, const Reader& reader, const Mechanism& mechanism) {
  std::vector<int> shapes;
  std::vector<std::string> names;
  for (int i = 0; i < static_cast<int>(mechanism.shapes.size()); ++i) {
    names.push_back(mechanism.shapes[i].name);
    if (means(text(value), names.back())) shapes.push_back(i);
  }
  if (!shapes.empty()) return shapes;
  const bool known = std::ranges::any_of(
      mechanism.bodies, [&](const std::string& body) { return means(text(value), body); });
  reader.problems().add(value,
                        known ? "has no shape: give it one under \"shapes\""
                              : "must mean a body or a slide that has a shape",
                        did_you_mean(text(value), names));
  return shapes;
}

ClearanceLimit read_clearance(const json& value, const Reader& reader, const Mechanism& mechanism) {
  ClearanceLimit limit;
  limit.name = text(member(value, "name"));
  const json& distance = member(value, "clearance");
  limit.distance = reader.length(distance);
  if (limit.distance < 0) reader.problems().add(distance, "a clearance must not be negative");
  limit.joined = member(value, "joined") == true;
  if (mechanism.shapes.empty()) {
    reader.problems().add(value, "a clearance needs bodies of some thickness: give \"shapes\"");
    return limit;
  }
  static const json kAll = {"*", "*"};
  const json& written = member(value, "between");
  const json& between = written.is_null() ? kAll : written;
  if (!between.is_array() || between.size() != 2) return limit;
  if (!written.is_null()) limit.between = {text(between[0]), text(between[1])};
  const auto first = shapes_of(between[0], reader, mechanism),
             second = shapes_of(between[1], reader, mechanism);
  std::set<std::array<int, 2>> pairs;
  for (const int a : first)
    for (const int b : second) {
      const Contact found = contact(mechanism, mechanism.shapes[a], mechanism.shapes[b]);
      if (found == Contact::none || (found == Contact::joined && limit.joined))
        pairs.insert({std::min(a, b), std::max(a, b)});
    }
  limit.pairs.assign(pairs.begin(), pairs.end());
  if (first.empty() || second.empty()) return limit;
  const json& at = written.is_null() ? value : written;
  if (pairs.empty())
    reader.problems().add(at, "means no two shapes that can come apart: joints connect them all");
  if (pairs.size() > kMostPairs)
    reader.problems().add(
        at, fmt::format("means {} pairs; at most {} can be watched", pairs.size(), kMostPairs));
  return limit;
}

/// Names that an expression over poses may use, beside parameters.
std::vector<std::string> pose_words(const Mechanism& mechanism) {
  std::vector<std::string> words{"x", "y", "z", "a", "b", "c"};
  std::size_t drives = 0;
  for (const Joint& joint : mechanism.joints) drives += joint.driven.size();
  for (std::size_t i = 1; i <= drives; ++i) words.push_back(fmt::format("q{}", i));
  return words;
}

/// Joints with one drive, and the word for its drive.
std::vector<std::pair<std::string, std::string>> drive_words(const Mechanism& mechanism) {
  std::vector<std::pair<std::string, std::string>> words;
  std::size_t drives = 0;
  for (const Joint& joint : mechanism.joints) {
    if (joint.driven.size() == 1) words.emplace_back(joint.name, fmt::format("q{}", drives + 1));
    drives += joint.driven.size();
  }
  return words;
}

/// The expression with parameters and joint names replaced; words that mean nothing, or two
/// things, are told.
std::string resolved(const json& value, const Reader& reader, const Mechanism& mechanism) {
  const auto poses = pose_words(mechanism);
  const auto drives = drive_words(mechanism);
  return with_words(text(value), [&](const std::string& word) -> std::optional<std::string> {
    const bool is_pose = std::ranges::find(poses, word) != poses.end();
    const double* parameter = reader.scope().find(word);
    const auto drive = std::ranges::find(drives, word, &std::pair<std::string, std::string>::first);
    const bool is_drive = drive != drives.end() && drive->second != word;
    if ((parameter != nullptr) + is_pose + is_drive > 1)
      reader.problems().add(
          value, fmt::format("\"{0}\" is a parameter or a joint and also a word for the pose or a "
                             "drive: give it another name, for example under \"derived\"",
                             word));
    if (is_pose) return std::nullopt;
    if (is_drive) return drive->second;
    if (parameter != nullptr) return fmt::format("({})", *parameter);
    std::vector<std::string> known = poses;
    for (const auto& [joint, drive_word] : drives) known.push_back(joint);
    for (const auto& [name, number] : reader.scope().names) known.push_back(name);
    reader.problems().add(value,
                          fmt::format("\"{}\" is neither a coordinate of the pose (x y z a b c), a "
                                      "drive, a parameter nor a function",
                                      word),
                          did_you_mean(word, known));
    return "0";
  });
}

ExpressionLimit read_expression(const json& value, const Reader& reader,
                                const Mechanism& mechanism) {
  ExpressionLimit limit;
  limit.name = text(member(value, "name"));
  const json& expression = member(value, "expression");
  limit.expression = resolved(expression, reader, mechanism);
  const std::string mistake = mistake_in(limit.expression, reader.scope().degrees);
  if (!mistake.empty()) reader.problems().add(expression, mistake);
  const json &min = member(value, "min"), &max = member(value, "max");
  if (!min.is_null()) limit.range.min = reader.number(min);
  if (!max.is_null()) limit.range.max = reader.number(max);
  if (min.is_null() && max.is_null())
    reader.problems().add(value, "an expression must have a \"min\", a \"max\" or both");
  if (limit.range.min > limit.range.max)
    reader.problems().add(value, "min must not be greater than max");
  return limit;
}

/// Words that belong to another kind of limit.
void refuse_strangers(const json& value, const std::string& kind,
                      const std::vector<std::string>& words, const Reader& reader) {
  for (const char* word : {"body", "points", "between", "joined", "min", "max"})
    if (value.contains(word) && std::ranges::find(words, word) == words.end())
      reader.problems().add(value[word],
                            fmt::format("\"{}\" has no meaning beside \"{}\"", word, kind));
}

}  // namespace

void read_limits(const Layout& layout, const Reader& reader, Mechanism& mechanism) {
  std::set<std::string> seen;
  for (const json& value : member(layout.document, "limits")) {
    if (!value.is_object()) continue;
    const json& name = member(value, "name");
    if (!seen.insert(text(name)).second)
      reader.problems().add(name, "the name of this limit is given twice");
    if (value.contains("clearance")) {
      refuse_strangers(value, "clearance", {"between", "joined"}, reader);
      mechanism.clearances.push_back(read_clearance(value, reader, mechanism));
    } else if (value.contains("expression")) {
      refuse_strangers(value, "expression", {"min", "max"}, reader);
      mechanism.expressions.push_back(read_expression(value, reader, mechanism));
    } else {
      refuse_strangers(value, "inside", {"body", "points"}, reader);
      mechanism.limits.push_back(read_half_space(value, reader, mechanism));
    }
  }
}

}  // namespace polyglide
