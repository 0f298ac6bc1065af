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
  Json json;
  json["name"] = joint.name;
  json["type"] = to_string(joint.type);
  json["between"] = {mechanism.bodies[joint.bodies[0]], mechanism.bodies[joint.bodies[1]]};
  json["at"] = in_unit(joint.at, units.metres);
  if (joint.type == JointType::universal)
    json["axes"] = {direction(joint.axes[0]), direction(joint.axes[1])};
  if (has_axis(joint.type)) json["axis"] = direction(joint.axes[0]);
  if (joint.type == JointType::helical) json["pitch"] = pitch_per_turn(joint.pitch, units);
  if (!joint.driven.empty()) json["drive"] = drive(joint);
  if (!joint.range.empty()) json["range"] = ranges(joint, units);
  if (joint.cone) {
    json["cone"] = in_unit(*joint.cone, units.radians);
    json["cone_axis"] = direction(joint.cone_axis);
  }
  return json;
}

Json limit_to_json(const HalfSpaceLimit& limit, const Mechanism& mechanism) {
  const double metres = mechanism.units.metres;
  Json json;
  json["name"] = limit.name;
  json["body"] = mechanism.bodies[limit.body];
  json["points"] = Json::array();
  for (const Vector3& point : limit.points) json["points"].push_back(in_unit(point, metres));
  json["inside"] = Json::array();
  for (const auto& plane : limit.planes)
    json["inside"].push_back(
        {{"normal", direction(plane.normal)}, {"offset", in_unit(plane.offset, metres)}});
  return json;
}

Json limit_to_json(const ClearanceLimit& limit, const Mechanism& mechanism) {
  Json json{{"name", limit.name}, {"clearance", in_unit(limit.distance, mechanism.units.metres)}};
  if (!limit.between[0].empty()) json["between"] = limit.between;
  if (limit.joined) json["joined"] = true;
  return json;
}

Json limit_to_json(const ExpressionLimit& limit) {
  Json json{{"name", limit.name}, {"expression", limit.expression}};
  if (std::isfinite(limit.range.min)) json["min"] = tidy(limit.range.min);
  if (std::isfinite(limit.range.max)) json["max"] = tidy(limit.range.max);
  return json;
}

Json shape_to_json(const BodyShape& shape, const Mechanism& mechanism) {
  const Units& units = mechanism.units;
  Json json{{"of", shape.name}};
  if (shape.radius > 0) json["diameter"] = in_unit(2 * shape.radius, units.metres);
  if (shape.form == BodyShape::Form::mesh) {
    json["mesh"] = shape.mesh_file;
    json["at"] = in_unit(shape.mesh_at, units.metres);
    json["turn"] = in_unit(shape.mesh_turn, units.radians);
    return json;
  }
  json["form"] = shape.form == BodyShape::Form::plate ? "plate" : "line";
  for (const BodyPoint& point : shape.points)
    json["points"].push_back(in_unit(point.at, units.metres));
  return json;
}

}  // namespace

Json to_json(const Mechanism& mechanism) {
  Json json;
  json["format"] = "polyglide/mechanism/1";
  json["name"] = mechanism.name;
  if (!mechanism.title.empty()) json["title"] = mechanism.title;
  if (!mechanism.source.empty()) json["source"] = mechanism.source;
  if (!mechanism.about.empty()) json["about"] = mechanism.about;
  json["units"] = {{"length", mechanism.units.length}, {"angle", mechanism.units.angle}};
  json["base"] = mechanism.bodies[mechanism.base];
  json["platform"] = mechanism.bodies[mechanism.platform];
  json["tool"] = in_unit(mechanism.tool, mechanism.units.metres);
  json["joints"] = Json::array();
  for (const Joint& joint : mechanism.joints)
    json["joints"].push_back(joint_to_json(joint, mechanism));
  for (const BodyShape& shape : mechanism.shapes)
    json["shapes"].push_back(shape_to_json(shape, mechanism));
  for (const HalfSpaceLimit& limit : mechanism.limits)
    json["limits"].push_back(limit_to_json(limit, mechanism));
  for (const ExpressionLimit& limit : mechanism.expressions)
    json["limits"].push_back(limit_to_json(limit));
  for (const ClearanceLimit& limit : mechanism.clearances)
    json["limits"].push_back(limit_to_json(limit, mechanism));
  return json;
}

}  // namespace polyglide
