#include <algorithm>
#include <cmath>

#include "kinematics/region.hpp"

namespace polyglide {
namespace {

constexpr double kUnlimited = 4;  // an unlimited stroke counts as ± this many sizes of the machine

/// Where one leg lets its platform joint, and with it the tool, go.
Bounds leg_bounds(const Model& model, const Leg& leg, const Eigen::Matrix3d& rotation) {
  const Vector3& tool = model.mechanism.tool;
  const Vector3 offset = tool + rotation * (leg.platform_point - tool) - leg.base_point;
  const double unlimited = kUnlimited * (model.size + leg.length);
  const double min = std::max(leg.stroke.min, -unlimited),
               max = std::min(leg.stroke.max, unlimited);
  Bounds bounds;
  if (leg.kind == Leg::Kind::strut) {
    bounds.lower.setConstant(-(leg.length + max));
    bounds.upper.setConstant(leg.length + max);
  } else if (leg.kind == Leg::Kind::crank_rod) {
    const Vector3 back = leg.centre - leg.base_point;
    const Vector3 span = Vector3::Constant(back.norm() + leg.length);
    bounds = {back - span, back + span};
  } else {
    bounds.lower = (min * leg.direction).cwiseMin(max * leg.direction).array() - leg.length;
    bounds.upper = (min * leg.direction).cwiseMax(max * leg.direction).array() + leg.length;
  }
  bounds.lower -= offset;
  bounds.upper -= offset;
  return bounds;
}

/// How far the tool gets from home along one direction, found by doubling steps
/// until a pose fails; the true region may bulge elsewhere, hence the reserve.
double reach_along(const Probe& probe, const Vector3& direction) {
  constexpr double kReserve = 1.5;
  const double size = probe.evaluator().machine().model.size;
  const int samples = 12;
  double span = 2 * kUnlimited * size;
  for (int pass = 0; pass < 3; ++pass) {
    Points points;
    for (int i = 1; i <= samples; ++i) points.add(direction * (span * i / samples));
    const Probe::Answers answers = probe.ask(points);
    int last = 0;
    for (int i = 0; i < samples; ++i)
      if (answers.inside(i)) last = i + 1;
    if (last > samples / 4) return kReserve * span * (last + 1) / samples;
    span *= static_cast<double>(last + 1) / samples;
  }
  return kReserve * span;
}

}  // namespace

Bounds search_bounds(const Probe& probe) {
  const Machine& machine = probe.evaluator().machine();
  Bounds bounds;
  if (probe.evaluator().closed_form()) {
    const double huge = std::numeric_limits<double>::infinity();
    bounds = {Vector3::Constant(-huge), Vector3::Constant(huge)};
    for (const Leg& leg : machine.legs->legs) {
      const Bounds own = leg_bounds(machine.model, leg, probe.rotation().toRotationMatrix());
      bounds.lower = bounds.lower.cwiseMax(own.lower);
      bounds.upper = bounds.upper.cwiseMin(own.upper);
    }
    bounds.upper = bounds.upper.cwiseMax(bounds.lower);
  } else {
    for (int axis = 0; axis < 3; ++axis) {
      if (!probe.active()[axis]) continue;
      bounds.upper[axis] = reach_along(probe, Vector3::Unit(axis));
      bounds.lower[axis] = -reach_along(probe, -Vector3::Unit(axis));
    }
  }
  for (int axis = 0; axis < 3; ++axis)
    if (!probe.active()[axis]) bounds.lower[axis] = bounds.upper[axis] = 0;
  return bounds;
}

}  // namespace polyglide
