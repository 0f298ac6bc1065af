#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "catalog/layout.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

/// A whole number without a point, anything else as it is.
Json tidy(double value) {
  if (value == std::trunc(value) && std::abs(value) < 1e15) return static_cast<std::int64_t>(value);
  return value;
}

/// The shortest decimal in file units that reads back as exactly `si`.
Json in_unit(double si, double unit) {
  if (std::isinf(si)) return nullptr;
  const double value = si / unit;
  for (int digits = 6; digits <= 17; ++digits) {
    const double decimal = std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);
    if (decimal * unit == si) return tidy(decimal);
  }
  return value;
}

Json in_unit(const Vector3& vector, double unit) {
  return {in_unit(vector.x(), unit), in_unit(vector.y(), unit), in_unit(vector.z(), unit)};
}

Json direction(const Vector3& vector) {
  return {tidy(vector.x()), tidy(vector.y()), tidy(vector.z())};
}

/// Advance per turn; the reader divides by one turn after changing units.
Json pitch_per_turn(double pitch, const Units& units) {
  const double turn = 2 * std::numbers::pi;
  const double metres = pitch * turn;
  for (const double near : {metres, std::nextafter(metres, 0), std::nextafter(metres, 2 * metres)})
    if (near / turn == pitch) return in_unit(near, units.metres);
  return in_unit(metres, units.metres);
}

Json drive(const Joint& joint) {
  if (freedoms(joint.type) == 1) return true;
  return joint.driven;
}

Json ranges(const Joint& joint, const Units& units) {
  Json pairs = Json::array();
  for (std::size_t i = 0; i < joint.range.size(); ++i) {
    const double unit =
        is_translation(joint.type, static_cast<int>(i)) ? units.metres : units.radians;
    pairs.push_back({in_unit(joint.range[i].min, unit), in_unit(joint.range[i].max, unit)});
  }
  return freedoms(joint.type) == 1 ? pairs[0] : pairs;
}

bool has_axis(JointType type) {
  return type != JointType::universal && type != JointType::spherical && type != JointType::weld;
}

Json joint_to_json(const Joint& joint, const Mechanism& mechanism) {
  const Units& units = mechanism.units;
  Json written;
  written["name"] = joint.name;
  written["type"] = to_string(joint.type);
  written["between"] = {mechanism.bodies[joint.bodies[0]], mechanism.bodies[joint.bodies[1]]};
  written["at"] = in_unit(joint.at, units.metres);
  if (joint.type == JointType::universal)
    written["axes"] = {direction(joint.axes[0]), direction(joint.axes[1])};
  if (has_axis(joint.type)) written["axis"] = direction(joint.axes[0]);
  if (joint.type == JointType::helical) written["pitch"] = pitch_per_turn(joint.pitch, units);
  if (!joint.driven.empty()) written["drive"] = drive(joint);
  if (!joint.range.empty()) written["range"] = ranges(joint, units);
  if (joint.cone) {
    written["cone"] = in_unit(*joint.cone, units.radians);
    written["cone_axis"] = direction(joint.cone_axis);
  }
  return written;
}

Json limit_to_json(const HalfSpaceLimit& limit, const Mechanism& mechanism) {
  const double metres = mechanism.units.metres;
  Json written;
  written["name"] = limit.name;
  written["body"] = mechanism.bodies[limit.body];
  written["points"] = Json::array();
  for (const Vector3& point : limit.points) written["points"].push_back(in_unit(point, metres));
  written["inside"] = Json::array();
  for (const auto& plane : limit.planes)
    written["inside"].push_back(
        {{"normal", direction(plane.normal)}, {"offset", in_unit(plane.offset, metres)}});
  return written;
}

Json limit_to_json(const ClearanceLimit& limit, const Mechanism& mechanism) {
  Json written{{"name", limit.name}, {"clearance", in_unit(limit.distance, mechanism.units.metres)}};
  if (!limit.between[0].empty()) written["between"] = limit.between;
  if (limit.joined) written["joined"] = true;
  return written;
}

Json limit_to_json(const ExpressionLimit& limit) {
  Json written{{"name", limit.name}, {"expression", limit.expression}};
  if (std::isfinite(limit.range.min)) written["min"] = tidy(limit.range.min);
  if (std::isfinite(limit.range.max)) written["max"] = tidy(limit.range.max);
  return written;
}

Json shape_to_json(const BodyShape& shape, const Mechanism& mechanism) {
  const Units& units = mechanism.units;
  Json written{{"of", shape.name}};
  if (shape.radius > 0) written["diameter"] = in_unit(2 * shape.radius, units.metres);
  if (shape.form == BodyShape::Form::mesh) {
    written["mesh"] = shape.mesh_file;
    written["at"] = in_unit(shape.mesh_at, units.metres);
    written["turn"] = in_unit(shape.mesh_turn, units.radians);
    return written;
  }
  written["form"] = shape.form == BodyShape::Form::plate ? "plate" : "line";
  for (const BodyPoint& point : shape.points)
    written["points"].push_back(in_unit(point.at, units.metres));
  return written;
}

}  // namespace

Json to_json(const Mechanism& mechanism) {
  Json written;
  written["format"] = "polyglide/mechanism/1";
  written["name"] = mechanism.name;
  if (!mechanism.title.empty()) written["title"] = mechanism.title;
  if (!mechanism.source.empty()) written["source"] = mechanism.source;
  if (!mechanism.about.empty()) written["about"] = mechanism.about;
  written["units"] = {{"length", mechanism.units.length}, {"angle", mechanism.units.angle}};
  written["base"] = mechanism.bodies[mechanism.base];
  written["platform"] = mechanism.bodies[mechanism.platform];
  written["tool"] = in_unit(mechanism.tool, mechanism.units.metres);
  written["joints"] = Json::array();
  for (const Joint& joint : mechanism.joints)
    written["joints"].push_back(joint_to_json(joint, mechanism));
  for (const BodyShape& shape : mechanism.shapes)
    written["shapes"].push_back(shape_to_json(shape, mechanism));
  for (const HalfSpaceLimit& limit : mechanism.limits)
    written["limits"].push_back(limit_to_json(limit, mechanism));
  for (const ExpressionLimit& limit : mechanism.expressions)
    written["limits"].push_back(limit_to_json(limit));
  for (const ClearanceLimit& limit : mechanism.clearances)
    written["limits"].push_back(limit_to_json(limit, mechanism));
  return written;
}

}  // namespace polyglide
