#include <cmath>

#include "kinematics/workspace.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

/// Six significant digits: files stay small and pages read the same.
double tidy(double value) {
  if (value == 0 || !std::isfinite(value)) return value;
  const double scale = std::pow(10, 5 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

Json json_of(const Vector3& v) { return {tidy(v.x()), tidy(v.y()), tidy(v.z())}; }

Json json_of(const Cylinder& cylinder) {
  return {{"diameter", tidy(cylinder.diameter)},
          {"height", tidy(cylinder.height)},
          {"center", json_of(cylinder.center)}};
}

Json json_of(const Box& box) {
  return {{"size", json_of(box.size)}, {"center", json_of(box.center)}};
}

Json json_of(const Sphere& sphere) {
  return {{"diameter", tidy(sphere.diameter)}, {"center", json_of(sphere.center)}};
}

/// A shape with its evidence.
template <typename Shape>
Json json_of(const Shape& shape, const ShapeEvidence& evidence) {
  Json json = json_of(shape);
  Json touches = Json::array();
  for (const auto& touch : evidence.touches)
    touches.push_back({{"limit", touch.limit}, {"at", json_of(touch.at)}});
  json["evidence"] = {{"places", evidence.places},
                      {"spacing", tidy(evidence.spacing)},
                      {"outside", evidence.outside}};
  json["touches"] = std::move(touches);
  return json;
}

Json json_of(const OrientationSamples& samples) {
  return {{"tilt", samples.set.tilt},
          {"torsion", samples.set.torsion},
          {"samples", samples.count},
          {"coarser_samples", samples.coarser},
          {"change", tidy(samples.change)}};
}

Json json_of(const std::vector<double>& values) {
  Json list = Json::array();
  for (double value : values) list.push_back(tidy(value));
  return list;
}

Json json_of(const Slice& slice) {
  Json rows = Json::array();
  for (std::size_t j = 0; j < slice.y.size(); ++j) {
    Json row = Json::array();
    for (std::size_t i = 0; i < slice.x.size(); ++i) {
      const double value = slice.inverse_condition[j * slice.x.size() + i];
      row.push_back(std::isnan(value) ? Json(nullptr) : Json(std::round(value * 1e4) / 1e4));
    }
    rows.push_back(std::move(row));
  }
  return {{"plane", "xy"},
          {"at", tidy(slice.z)},
          {"u", json_of(slice.x)},
          {"v", json_of(slice.y)},
          {"values", std::move(rows)}};
}

}  // namespace

Json to_json(const Workspace& workspace) {
  Json json;
  json["volume"] = workspace.volume;
  json["volume_bounds"] = {workspace.volume_lower, workspace.volume_upper};
  json["volume_error"] = workspace.area > 0 ? 0 : workspace.error;
  json["area"] = workspace.area;
  if (workspace.area > 0) {
    json["area_bounds"] = {workspace.area_lower, workspace.area_upper};
    json["area_error"] = workspace.error;
  }
  json["length"] = workspace.length;
  json["method"] = workspace.method;
  json["reach"] = workspace.reach ? Json(*workspace.reach) : Json(nullptr);
  if (workspace.singular_throughout) json["singular_throughout"] = true;
  if (workspace.orientations) json["orientations"] = json_of(*workspace.orientations);
  json["bounds"] = workspace.certified ? "certified" : "estimated";
  json["extent"] = {{"lower", json_of(workspace.lower)}, {"upper", json_of(workspace.upper)}};
  json["area_by_z"] = Json::array();
  for (const auto& [z, area] : workspace.area_by_z)
    json["area_by_z"].push_back({tidy(z), tidy(area)});
  json["inscribed_cylinder"] = json_of(workspace.inscribed_cylinder, workspace.cylinder_evidence);
  json["inscribed_box"] = json_of(workspace.inscribed_box, workspace.box_evidence);
  json["inscribed_sphere"] = json_of(workspace.inscribed_sphere, workspace.sphere_evidence);
  json["cylinders"] = Json::array();
  for (const Cylinder& cylinder : workspace.cylinders)
    json["cylinders"].push_back(json_of(cylinder));
  json["conditioning"] = {{"global", workspace.global_conditioning},
                          {"worst", workspace.worst},
                          {"best", workspace.best}};
  json["characteristic_length"] = workspace.characteristic_length;
  if (const auto& range = workspace.rotation_range)
    json["rotation_range"] = {{"axis", std::string(1, range->axis)},
                              {"at", json_of(range->at)},
                              {"min", range->min},
                              {"max", range->max},
                              {"min_limit", range->min_limit},
                              {"max_limit", range->max_limit}};
  if (!workspace.stopped_by.empty()) json["stopped_by"] = workspace.stopped_by;
  json["limits_hit"] = workspace.limits_hit;
  json["slices"] = Json::array();
  for (const Slice& slice : workspace.slices) json["slices"].push_back(json_of(slice));
  if (workspace.asked_box) json["zone"] = json_of(*workspace.asked_box);
  if (workspace.asked_cylinder) json["zone_cylinder"] = json_of(*workspace.asked_cylinder);
  json["poses"] = workspace.poses;
  json["seconds"] = workspace.seconds;
  return json;
}

}  // namespace polyglide
