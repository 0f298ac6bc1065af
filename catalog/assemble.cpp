#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "catalog/draft.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

/// Parameters with their overrides, then the derived dimensions.
Scope make_scope(const Layout& layout, const ParameterValues& values, Problems& problems) {
  Scope scope;
  scope.degrees = layout.units.angle != "rad";
  for (const Parameter& parameter : layout.parameters) {
    const auto given = values.find(parameter.name);
    const double value = given == values.end() ? parameter.value : given->second;
    const bool free = parameter.min != parameter.max;
    if (given != values.end() &&
        (!std::isfinite(value) || (free && (value < parameter.min || value > parameter.max))))
      problems.add({layout.file, "/parameters/" + parameter.name, fmt::format("{:.12g}", value),
                    fmt::format("this parameter must lie in [{:.12g}, {:.12g}]", parameter.min,
                                parameter.max),
                    ""});
    scope.names.emplace_back(parameter.name, value);
  }
  for (const auto& [name, value] : values) {
    if (scope.find(name) != nullptr) continue;
    std::vector<std::string> known;
    for (const Parameter& parameter : layout.parameters) known.push_back(parameter.name);
    const std::string near = did_you_mean(name, known);
    problems.add({layout.file, "/parameters", '"' + name + '"',
                  layout.name + " has no parameter of this name",
                  !near.empty()   ? near
                  : known.empty() ? "it has none"
                                  : fmt::format("it has {}", fmt::join(known, ", "))});
  }
  return scope;
}

/// Adds the derived dimensions in an order in which each knows what it uses.
void add_derived(const json& derived, Scope& scope, Problems& problems) {
  if (!derived.is_object()) return;
  std::vector<std::pair<std::string, const json*>> waiting;
  for (const auto& [name, value] : derived.items())
    if (value.is_string()) waiting.emplace_back(name, &value);
  const auto evaluate_into_scope = [&](const std::string& name, const json& value) {
    const Evaluation result = evaluate(value.get_ref<const std::string&>(), scope);
    if (!result.error.empty()) problems.add(value, result.error, result.hint);
    scope.names.emplace_back(name, result.value);
  };
  const auto uses_waiting = [&](const auto& entry) {
    return std::ranges::any_of(
        names_in(entry.second->template get<std::string>()), [&](auto& name) {
          return std::ranges::any_of(waiting, [&](auto& other) { return other.first == name; });
        });
  };
  while (!waiting.empty()) {
    const auto next = std::ranges::find_if_not(waiting, uses_waiting);
    if (next == waiting.end()) break;
    evaluate_into_scope(next->first, *next->second);
    waiting.erase(next);
  }
  for (const auto& [name, value] : waiting) {
    problems.add(*value, "a derived dimension must not depend on itself");
    scope.names.emplace_back(name, std::numeric_limits<double>::quiet_NaN());
  }
}

std::vector<JointDraft> draft_joints(const Layout& layout, Scope& scope,
                                     const std::array<std::string, 2>& base_and_platform,
                                     Problems& problems) {
  std::vector<JointDraft> drafts;
  for (const json& limb : member(layout.document, "limbs"))
    expand_limb(limb, scope, layout.units, problems, base_and_platform, drafts);
  const Reader reader(problems, scope, layout.units);
  for (const json& joint : member(layout.document, "joints")) {
    JointDraft& draft = drafts.emplace_back(read_joint(joint, reader, Compass{}));
    draft.joint.name = text(member(joint, "name"));
    const json& between = member(joint, "between");
    if (between.is_array() && between.size() == 2)
      draft.bodies = {text(between[0]), text(between[1])};
  }
  return drafts;
}

void check_names(const std::vector<JointDraft>& drafts, Problems& problems) {
  std::set<std::string> seen;
  for (const JointDraft& draft : drafts) {
    if (seen.insert(draft.joint.name).second) continue;
    const json& name = member(*draft.origin, "name");
    problems.add(name.is_null() ? *draft.origin : name,
                 fmt::format("the joint name \"{}\" is given twice", draft.joint.name));
  }
}

/// Index of a body, which is added when it is new.
int body_index(std::vector<std::string>& bodies, const std::string& name) {
  const auto index = static_cast<int>(std::ranges::find(bodies, name) - bodies.begin());
  if (index == static_cast<int>(bodies.size())) bodies.push_back(name);
  return index;
}

/// Every body must hang on the base, and the platform must be one of them.
void check_connections(const Mechanism& mechanism, const std::vector<JointDraft>& drafts,
                       const json& document, Problems& problems) {
  std::vector<bool> reached(mechanism.bodies.size(), false);
  reached[mechanism.base] = true;
  for (bool grown = true; grown;) {
    grown = false;
    for (const JointDraft& draft : drafts) {
      const auto [a, b] = draft.joint.bodies;
      if (reached[a] == reached[b]) continue;
      reached[a] = reached[b] = grown = true;
    }
  }
  const auto used = [&](int body) {
    return std::ranges::any_of(drafts, [&](const JointDraft& draft) {
      return draft.joint.bodies[0] == body || draft.joint.bodies[1] == body;
    });
  };
  for (const auto& [key, body] :
       {std::pair{"base", mechanism.base}, {"platform", mechanism.platform}}) {
    if (used(body)) continue;
    std::vector<std::string> others = mechanism.bodies;
    std::erase(others, mechanism.bodies[body]);
    const json& place = member(document, key);
    const std::string rule = fmt::format("the {} \"{}\" must be a body that some joint joins", key,
                                         mechanism.bodies[body]);
    if (place.is_null())
      problems.add_missing(document, rule);
    else
      problems.add(place, rule, did_you_mean(mechanism.bodies[body], others));
    return;  // then nothing else need be connected, either
  }
  for (const JointDraft& draft : drafts)
    if (!reached[draft.joint.bodies[0]])
      problems.add(*draft.origin,
                   fmt::format("the bodies \"{}\" and \"{}\" are not connected to "
                               "the base \"{}\"",
                               draft.bodies[0], draft.bodies[1], mechanism.bodies[mechanism.base]));
}

void connect(Mechanism& mechanism, std::vector<JointDraft>& drafts,
             const std::array<std::string, 2>& base_and_platform, const json& document,
             Problems& problems) {
  mechanism.bodies = {base_and_platform[0]};
  mechanism.platform = body_index(mechanism.bodies, base_and_platform[1]);
  if (mechanism.platform == mechanism.base)
    problems.add(member(document, "platform"), "the platform must be another body than the base");
  bool named = !drafts.empty();
  for (JointDraft& draft : drafts) {
    if (draft.bodies[0].empty() || draft.bodies[1].empty()) {
      named = false;  // told by the schema; what is connected cannot be known
      continue;
    }
    for (int end = 0; end < 2; ++end)
      draft.joint.bodies[end] = body_index(mechanism.bodies, draft.bodies[end]);
    if (draft.bodies[0] == draft.bodies[1])
      problems.add(*draft.origin, "a joint must join two different bodies");
  }
  if (drafts.empty()) problems.add_missing(document, "a machine must have at least one joint");
  if (named) check_connections(mechanism, drafts, document, problems);
}

/// A slide's point is for drawing only; where none is given, a neighbour's serves.
void place_slides(std::vector<JointDraft>& drafts) {
  for (JointDraft& draft : drafts) {
    if (draft.placed) continue;
    for (const int body : {draft.joint.bodies[1], draft.joint.bodies[0]}) {
      const auto neighbour = std::ranges::find_if(drafts, [&](const JointDraft& other) {
        return other.placed && (other.joint.bodies[0] == body || other.joint.bodies[1] == body);
      });
      if (neighbour == drafts.end()) continue;
      draft.joint.at = neighbour->joint.at;
      break;
    }
  }
}

/// Candidates for the direction of the rod that ends in this joint: towards the
/// other joints of its bodies; where there are only slides (a strut), along them.
std::vector<Vector3> rod_directions(const Joint& joint, const Mechanism& mechanism,
                                    const std::vector<JointDraft>& drafts) {
  std::vector<Vector3> rods, others, slides;
  for (const int body : joint.bodies) {
    if (body == mechanism.base || body == mechanism.platform) continue;
    for (const JointDraft& draft : drafts) {
      const Joint& other = draft.joint;
      if (&other == &joint || (other.bodies[0] != body && other.bodies[1] != body)) continue;
      const Vector3 way = other.at - joint.at;
      if (other.type == JointType::prismatic)
        slides.push_back(other.axes[0]);
      else if (way.norm() < 1e-9)
        continue;
      else if (other.type == JointType::spherical || other.type == JointType::universal)
        rods.push_back(way.normalized());
      else
        others.push_back(way.normalized());
    }
  }
  return !rods.empty() ? rods : !others.empty() ? others : slides;
}

void point_cones(const Mechanism& mechanism, std::vector<JointDraft>& drafts, Problems& problems) {
  for (JointDraft& draft : drafts) {
    if (!draft.joint.cone || !draft.joint.cone_axis.isZero()) continue;
    const auto directions = rod_directions(draft.joint, mechanism, drafts);
    if (directions.size() == 1)
      draft.joint.cone_axis = directions[0];
    else
      problems.add(*draft.origin, fmt::format("the direction of the rod at joint {} is not plain: "
                                              "give \"cone_axis\"",
                                              draft.joint.name));
  }
}

/// What no rule above has caught: a number that is missing or not one.
void check_numbers(const Mechanism& mechanism, const std::vector<JointDraft>& drafts,
                   const json& document, Problems& problems) {
  if (!problems.empty()) return;
  for (const JointDraft& draft : drafts) {
    const Joint& joint = draft.joint;
    bool finite = joint.at.allFinite() && joint.axes[0].allFinite() && joint.axes[1].allFinite() &&
                  std::isfinite(joint.pitch) && std::isfinite(joint.cone.value_or(0));
    for (const Range& range : joint.range)
      finite = finite && !std::isnan(range.min) && !std::isnan(range.max);
    if (!finite)
      problems.add(*draft.origin,
                   fmt::format("joint {} lacks a number, or has one too large", joint.name));
  }
  if (!mechanism.tool.allFinite())
    problems.add(member(document, "tool"), "the tool point must be three numbers");
  for (const HalfSpaceLimit& limit : mechanism.limits) {
    bool finite = true;
    for (const Vector3& point : limit.points) finite = finite && point.allFinite();
    for (const auto& plane : limit.planes)
      finite = finite && plane.normal.allFinite() && std::isfinite(plane.offset);
    if (!finite)
      problems.add(member(document, "limits"), "limit " + limit.name + " lacks a number");
  }
  for (const BodyShape& shape : mechanism.shapes) {
    bool finite = std::isfinite(shape.radius);
    for (const BodyPoint& point : shape.points) finite = finite && point.at.allFinite();
    if (!finite)
      problems.add(member(document, "shapes"), "the shape of " + shape.name + " lacks a number");
  }
}

}  // namespace

Mechanism assemble(const Layout& layout, const ParameterValues& values, Problems& problems) {
  const json& document = layout.document;
  const std::array base_and_platform = {text(member(document, "base"), "base"),
                                        text(member(document, "platform"), "platform")};
  Scope scope = make_scope(layout, values, problems);
  add_derived(member(document, "derived"), scope, problems);
  std::vector<JointDraft> drafts = draft_joints(layout, scope, base_and_platform, problems);

  Mechanism mechanism;
  mechanism.name = layout.name;
  mechanism.title = layout.title;
  mechanism.source = layout.source;
  mechanism.about = layout.about;
  mechanism.units = layout.units;
  check_names(drafts, problems);
  connect(mechanism, drafts, base_and_platform, document, problems);
  place_slides(drafts);
  point_cones(mechanism, drafts, problems);
  for (const JointDraft& draft : drafts) mechanism.joints.push_back(draft.joint);

  const Reader reader(problems, scope, layout.units);
  mechanism.tool = reader.offset(member(document, "tool"), Compass{});
  read_shapes(layout, reader, mechanism);
  read_limits(layout, reader, mechanism);
  check_numbers(mechanism, drafts, document, problems);
  return mechanism;
}

Mechanism expand(const Layout& layout, const ParameterValues& values) {
  Problems problems(layout.document, layout.file);
  Mechanism mechanism = assemble(layout, values, problems);
  problems.raise();
  return mechanism;
}

}  // namespace polyglide
