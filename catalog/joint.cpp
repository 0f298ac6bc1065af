#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "catalog/draft.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

/// The members a joint kind cannot do without.
std::vector<const char*> needed(JointType type) {
  switch (type) {
    case JointType::revolute:
    case JointType::cylindrical:
      return {"at", "axis"};
    case JointType::helical:
      return {"at", "axis", "pitch"};
    case JointType::universal:
      return {"at", "axes"};
    case JointType::spherical:
      return {"at"};
    case JointType::prismatic:
    case JointType::planar:
      return {"axis"};
    case JointType::weld:
      return {};
  }
  return {};
}

void read_axes(const json& value, const Reader& reader, const Compass& compass, Joint& joint) {
  if (joint.type != JointType::universal) {
    const json& axis = member(value, "axis");
    if (joint.type != JointType::spherical && joint.type != JointType::weld && !axis.is_null())
      joint.axes[0] = reader.direction(axis, compass);
    return;
  }
  const json& axes = member(value, "axes");
  if (!axes.is_array() || axes.size() != 2) return;
  for (int i = 0; i < 2; ++i) joint.axes[i] = reader.direction(axes[i], compass);
  if (joint.axes[0].cross(joint.axes[1]).norm() < 1e-9)
    reader.problems().add(axes, "the two axes of a universal joint must not be parallel");
}

void read_drive(const json& value, const Reader& reader, Joint& joint) {
  const json& drive = member(value, "drive");
  const int count = freedoms(joint.type);
  if (drive.is_boolean() && drive.get<bool>()) {
    joint.driven = {0};
    if (count != 1)
      reader.problems().add(drive, fmt::format("a {} joint has {} freedoms: list the driven ones, "
                                               "for example [0]",
                                               to_string(joint.type), count));
  }
  if (!drive.is_array()) return;
  for (const json& index : drive) {
    if (!index.is_number_integer()) continue;
    const int freedom = index.get<int>();
    if (freedom < 0 || freedom >= count) {
      reader.problems().add(index,
                            fmt::format("the freedoms of a {} joint number {}, counted from 0",
                                        to_string(joint.type), count));
    } else if (std::ranges::find(joint.driven, freedom) != joint.driven.end()) {
      reader.problems().add(index, "a freedom can be driven only once");
    } else {
      joint.driven.push_back(freedom);
    }
  }
  std::ranges::sort(joint.driven);
}

void read_range(const json& value, const Reader& reader, Joint& joint) {
  const json& range = member(value, "range");
  if (!range.is_array()) return;
  const int count = freedoms(joint.type);
  if (joint.type == JointType::spherical || joint.type == JointType::weld) {
    reader.problems().add(range, "a " + to_string(joint.type) +
                                     " joint has no joint coordinate"
                                     " to limit; a spherical joint is limited by \"cone\"");
    return;
  }
  const auto unit = [&](int i) {
    return is_translation(joint.type, i) ? reader.units().metres : reader.units().radians;
  };
  const bool nested = !range.empty() && range[0].is_array();
  if (!nested && count == 1) {
    joint.range = {reader.interval(range, unit(0))};
  } else if (nested && static_cast<int>(range.size()) == count) {
    for (int i = 0; i < count; ++i) joint.range.push_back(reader.interval(range[i], unit(i)));
  } else {
    reader.problems().add(
        range, fmt::format("the range of a {} joint must be {}", to_string(joint.type),
                           count == 1 ? "[min, max]"
                                      : fmt::format("a list of {} pairs [min, max]", count)));
  }
}

void read_cone(const json& value, const Reader& reader, const Compass& compass, Joint& joint) {
  const json& cone = member(value, "cone");
  if (cone.is_null()) return;
  if (joint.type != JointType::spherical && joint.type != JointType::universal) {
    reader.problems().add(cone, "only a spherical or universal joint has a cone");
    return;
  }
  joint.cone = reader.angle(cone);
  if (*joint.cone <= 0 || *joint.cone > std::numbers::pi)
    reader.problems().add(cone, "a cone's half angle must be above zero and at most half a turn");
  const json& axis = member(value, "cone_axis");
  if (!axis.is_null()) joint.cone_axis = reader.direction(axis, compass);
}

}  // namespace

JointDraft read_joint(const json& value, const Reader& reader, const Compass& compass) {
  JointDraft draft;
  draft.origin = &value;
  const auto type = joint_type(text(member(value, "type")));
  if (!type) return draft;  // told by the schema; anything else depends on the kind
  Joint& joint = draft.joint;
  joint.type = *type;
  for (const char* key : needed(*type))
    if (member(value, key).is_null())
      reader.problems().add_missing(value,
                                    fmt::format("a {} joint needs \"{}\"", to_string(*type), key));

  const json& at = member(value, "at");
  draft.placed = !at.is_null();
  if (draft.placed) joint.at = reader.point(at, compass);
  read_axes(value, reader, compass, joint);
  if (*type == JointType::helical)
    joint.pitch = reader.length(member(value, "pitch")) / (2 * std::numbers::pi);
  read_drive(value, reader, joint);
  read_range(value, reader, joint);
  read_cone(value, reader, compass, joint);
  return draft;
}

}  // namespace polyglide
