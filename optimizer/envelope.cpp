#include "optimizer/envelope.hpp"

#include <cmath>
#include <map>

namespace polyglide {
namespace {

/// Strokes of carriages as displacements, by body.
using Strokes = std::map<int, std::vector<Vector3>>;

Strokes carriage_strokes(const Mechanism& mechanism) {
  Strokes strokes;
  for (const Joint& joint : mechanism.joints) {
    if (joint.type != JointType::prismatic || joint.driven.empty()) continue;
    const bool from_base = joint.bodies[0] == mechanism.base;
    if (!from_base && joint.bodies[1] != mechanism.base) continue;
    auto& ends = strokes[joint.bodies[from_base ? 1 : 0]];
    ends = {Vector3::Zero()};
    if (joint.range.empty()) continue;
    for (const double end : {joint.range[0].min, joint.range[0].max})
      if (std::isfinite(end)) ends.push_back((from_base ? end : -end) * joint.axes[0]);
  }
  return strokes;
}

bool is_driven_slide(const Joint& joint) {
  return joint.type == JointType::prismatic && !joint.driven.empty();
}

Eigen::AlignedBox3d box_around(const std::vector<Vector3>& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3& point : points) box.extend(point);
  return box;
}

}  // namespace

Eigen::AlignedBox3d envelope(const Machine& machine, const std::vector<Vector3>& positions,
                             const std::vector<Eigen::Quaterniond>& turns) {
  const Mechanism& mechanism = machine.model.mechanism;
  const Strokes strokes = carriage_strokes(mechanism);
  const Eigen::AlignedBox3d moves = box_around(positions);
  Eigen::AlignedBox3d box;
  const auto add_platform_point = [&](const Vector3& point) {
    for (const Eigen::Quaterniond& turn : turns) {
      const Vector3 turned = mechanism.tool + turn * (point - mechanism.tool);
      box.extend(turned + moves.min());
      box.extend(turned + moves.max());
    }
  };
  for (const Joint& joint : mechanism.joints) {
    if (is_driven_slide(joint)) continue;
    for (const int body : joint.bodies) {
      if (body == mechanism.platform) {
        add_platform_point(joint.at);
      } else if (const auto carriage = strokes.find(body); carriage != strokes.end()) {
        for (const Vector3& end : carriage->second) box.extend(joint.at + end);
      } else if (body == mechanism.base) {
        box.extend(joint.at);
      }
    }
  }
  add_platform_point(mechanism.tool);
  return box;
}

Eigen::AlignedBox3d reach_box(const Machine& machine) {
  const Vector3 far = Vector3::Constant(2 * machine.model.size);
  Eigen::AlignedBox3d box(-far, far);
  if (!machine.legs) return box;
  for (const Leg& leg : machine.legs->legs) {
    Eigen::AlignedBox3d places;
    double reach = leg.length;
    places.extend(leg.base_point);
    if (leg.kind == Leg::Kind::strut) {
      reach += leg.stroke.max;
    } else if (leg.kind == Leg::Kind::crank_rod) {
      reach += (leg.base_point - leg.centre).norm();
      places = Eigen::AlignedBox3d(leg.centre);
    } else {
      if (!std::isfinite(leg.stroke.min) || !std::isfinite(leg.stroke.max)) continue;
      places = Eigen::AlignedBox3d();
      places.extend(leg.base_point + leg.stroke.min * leg.direction);
      places.extend(leg.base_point + leg.stroke.max * leg.direction);
    }
    if (!std::isfinite(reach)) continue;
    const Vector3 around = Vector3::Constant(reach);
    box = box.intersection(Eigen::AlignedBox3d(places.min() - around - leg.platform_point,
                                               places.max() + around - leg.platform_point));
  }
  return box;
}

}  // namespace polyglide
