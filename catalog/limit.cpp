#include <algorithm>
#include <set>

#include "catalog/draft.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

HalfSpaceLimit read_limit(const json& value, const Reader& reader, const Mechanism& mechanism) {
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

}  // namespace

void read_limits(const Layout& layout, const Reader& reader, Mechanism& mechanism) {
  std::set<std::string> seen;
  for (const json& value : member(layout.document, "limits")) {
    mechanism.limits.push_back(read_limit(value, reader, mechanism));
    if (!seen.insert(mechanism.limits.back().name).second)
      reader.problems().add(member(value, "name"), "the name of this limit is given twice");
  }
}

}  // namespace polyglide
