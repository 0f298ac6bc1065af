#include "optimizer/families.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "catalog/json_file.hpp"
#include "kinematics/clearance.hpp"

namespace polyglide {
namespace {

/// A number to a tenth of a nanometre, without signed zeros.
std::string text(double value) {
  const double rounded = std::round(value * 1e10) / 1e10;
  return fmt::format("{:.10g},", rounded == 0 ? 0.0 : rounded);
}

std::string text(const Vector3& v) { return text(v.x()) + text(v.y()) + text(v.z()); }

std::string cone_text(const Joint& joint) {
  return joint.cone ? "cone " + text(*joint.cone) + text(joint.cone_axis) : "";
}

std::string leg_text(const Mechanism& mechanism, const Leg& leg, bool primary) {
  return fmt::format("{} {} {} {}", static_cast<int>(leg.kind), leg.drive, primary,
                     text(leg.side)) +
         text(leg.base_point) + text(leg.direction) + text(leg.centre) + text(leg.platform_point) +
         text(leg.length) + text(leg.stroke.min) + text(leg.stroke.max) +
         cone_text(mechanism.joints[leg.base_joint]) +
         cone_text(mechanism.joints[leg.platform_joint]) + '\n';
}

std::string machine_text(const Machine& machine) {
  const Mechanism& mechanism = machine.model.mechanism;
  std::string result;
  for (std::size_t i = 0; i < machine.legs->legs.size(); ++i) {
    const Leg& leg = machine.legs->legs[i];
    result += leg_text(mechanism, leg, machine.legs->primary[leg.drive] == static_cast<int>(i));
  }
  for (const HalfSpaceLimit& limit : mechanism.limits) {
    result += limit.body == mechanism.platform ? "platform " : mechanism.bodies[limit.body] + ' ';
    for (const Vector3& point : limit.points) result += text(point);
    for (const auto& plane : limit.planes) result += text(plane.normal) + text(plane.offset);
  }
  for (const ExpressionLimit& limit : mechanism.expressions)
    result += limit.expression + ' ' + text(limit.range.min) + text(limit.range.max);
  for (const WatchedPair& pair : watched_pairs(mechanism, {})) {
    result += pair.name + ' ' + text(pair.apart);
    for (const int shape : pair.shapes) {
      result += mechanism.shapes[shape].mesh_file;
      for (const BodyPoint& point : mechanism.shapes[shape].points) result += text(point.at);
    }
  }
  for (const int axis : machine.task.axes) result += fmt::format("axis {} ", axis);
  return result + text(machine.task.rotation_axis) + text(mechanism.tool) +
         (machine.task.pure ? "pure" : "");
}

/// Dimensions off the file's, each by its own part of the way to its upper bound, so
/// that what coincides there by chance does not coincide here.
ParameterValues other_values(const Layout& layout) {
  ParameterValues values;
  for (const std::string& name : turnable(layout)) {
    const auto& parameter = *std::ranges::find(layout.parameters, name, &Parameter::name);
    const double part =
        static_cast<double>(std::stoul(content_hash(name).substr(0, 4), nullptr, 16)) / 0xffff;
    values[name] = std::lerp(parameter.value, parameter.max, 0.05 + 0.1 * part);
  }
  return values;
}

}  // namespace

std::string kinematic_signature(const Eligible& eligible) {
  std::string result;
  for (const ParameterValues& values : {ParameterValues{}, other_values(eligible.layout)}) {
    try {
      const Machine machine = prepare(expand(eligible.layout, values), eligible.task);
      if (!machine.legs) return "";
      result += machine_text(machine);
    } catch (const InputError&) {
      result += "does not assemble";
    }
  }
  return result;
}

std::vector<Family> group_twins(std::vector<Eligible> eligible) {
  std::vector<Family> families;
  std::map<std::string, std::size_t> by_signature;
  for (Eligible& one : eligible) {
    std::string signature = kinematic_signature(one);
    if (signature.empty()) signature = one.candidate->id;
    const auto [place, is_new] = by_signature.try_emplace(signature, families.size());
    if (is_new) families.emplace_back();
    Family& family = families[place->second];
    family.members.push_back(one.candidate);
    if (!is_new && (!family.known_as().empty() || one.candidate->known_as.empty())) continue;
    family.lead = one.candidate;
    family.layout = std::move(one.layout);
    family.task = one.task;
  }
  return families;
}

}  // namespace polyglide
