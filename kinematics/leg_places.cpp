#include "kinematics/leg_places.hpp"

#include <algorithm>

namespace polyglide {
namespace {

constexpr double kOnLine = 1e-9;  // of the leg's length

/// The body that is not `body` at one of a leg's ends.
int beyond(const Mechanism& mechanism, int joint, int body) {
  const auto& bodies = mechanism.joints[joint].bodies;
  return bodies[0] == body ? bodies[1] : bodies[0];
}

/// Which part of a leg a body is; nullopt when it is none.
std::optional<LegPlace::Kind> part_of_leg(const Mechanism& mechanism, const Leg& leg, int body) {
  const int top = leg_body(mechanism, leg);
  if (leg.kind == Leg::Kind::strut) {
    if (body == top) return LegPlace::Kind::upper;
    if (body == beyond(mechanism, leg.base_joint, mechanism.base)) return LegPlace::Kind::lower;
    return std::nullopt;
  }
  if (body == top) return LegPlace::Kind::rod;
  if (body != beyond(mechanism, leg.base_joint, top)) return std::nullopt;
  return leg.kind == Leg::Kind::crank_rod ? LegPlace::Kind::crank : LegPlace::Kind::carriage;
}

/// The leg that a body belongs to, and as what.
std::optional<LegPlace> leg_of(const Mechanism& mechanism, const LegMachine& machine, int body) {
  for (int i = 0; i < static_cast<int>(machine.legs.size()); ++i)
    if (const auto kind = part_of_leg(mechanism, machine.legs[i], body))
      return LegPlace{*kind, Vector3::Zero(), i, 0};
  return std::nullopt;
}

}  // namespace

std::optional<LegPlace> leg_place(const Mechanism& mechanism, const LegMachine& machine,
                                  const BodyPoint& point) {
  using Kind = LegPlace::Kind;
  if (point.body == mechanism.base) return LegPlace{Kind::fixed, point.at, -1, 0};
  if (point.body == mechanism.platform) return LegPlace{Kind::platform, point.at, -1, 0};
  std::optional<LegPlace> place = leg_of(mechanism, machine, point.body);
  if (!place) return std::nullopt;
  place->at = point.at;
  if (place->kind == Kind::carriage || place->kind == Kind::crank) return place;
  const Leg& leg = machine.legs[place->leg];
  const Vector3 line = (leg.platform_point - leg.base_point) / leg.length;
  const Vector3 from =
      point.at - (place->kind == Kind::upper ? leg.platform_point : leg.base_point);
  place->part = line.dot(from) / (place->kind == Kind::rod ? leg.length : 1);
  if (line.cross(from).norm() > kOnLine * leg.length) return std::nullopt;
  return place;
}

bool is_placed(const Mechanism& mechanism, const LegMachine& machine, int body) {
  if (body == mechanism.base || body == mechanism.platform) return true;
  const auto place = leg_of(mechanism, machine, body);
  return place && (place->kind == LegPlace::Kind::carriage || place->kind == LegPlace::Kind::crank);
}

bool shapes_are_placed(const Mechanism& mechanism, const LegMachine& machine) {
  const auto placed = [&](int index) {
    const BodyShape& shape = mechanism.shapes[index];
    if (shape.form == BodyShape::Form::mesh) return is_placed(mechanism, machine, shape.body);
    return std::ranges::all_of(shape.points, [&](const BodyPoint& point) {
      return leg_place(mechanism, machine, point).has_value();
    });
  };
  return std::ranges::all_of(mechanism.clearances, [&](const ClearanceLimit& limit) {
    return std::ranges::all_of(
        limit.pairs, [&](const auto& pair) { return placed(pair[0]) && placed(pair[1]); });
  });
}

Transform body_displacement(const Mechanism& mechanism, const LegMachine& machine, int body,
                            const Transform& platform, const Eigen::VectorXd& drives) {
  Transform motion = Transform::Identity();
  if (body == mechanism.platform) return platform;
  const auto place = leg_of(mechanism, machine, body);
  if (body == mechanism.base || !place) return motion;
  const Leg& leg = machine.legs[place->leg];
  const double q = drives[leg.drive];
  if (place->kind == LegPlace::Kind::carriage) {
    motion.translation() = q * leg.direction;
  } else {
    motion.linear() = Eigen::AngleAxisd(q, leg.direction).toRotationMatrix();
    motion.translation() = leg.centre - motion.linear() * leg.centre;
  }
  return motion;
}

}  // namespace polyglide
