#include "kinematics/legs.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/leg_places.hpp"
#include "kinematics/limits.hpp"
#include "kinematics/planar.hpp"

namespace polyglide {
namespace {

/// A rod's end: a ball or a universal joint, in planar machines a hinge.
bool turns_freely(const Joint& joint, bool planar) {
  return (joint.type == JointType::universal || joint.type == JointType::spherical ||
          (planar && joint.type == JointType::revolute)) &&
         joint.driven.empty() &&
         std::all_of(joint.range.begin(), joint.range.end(), [](const Range& range) {
           return std::isinf(range.min) && std::isinf(range.max);
         });
}

bool is_drive(const Joint& joint) {
  return joint.type == JointType::prismatic && !joint.driven.empty();
}

bool is_crank(const Joint& joint) {
  return joint.type == JointType::revolute && !joint.driven.empty();
}

/// Walks from the platform to the base, limb by limb, and ticks off every joint.
class Recogniser {
 public:
  explicit Recogniser(const Model& model)
      : model_(model),
        mechanism_(model.mechanism),
        planar_(plane_of_motion(model.mechanism).has_value()),
        joints_of_(mechanism_.bodies.size()),
        used_(mechanism_.joints.size(), false) {
    for (int j = 0; j < static_cast<int>(mechanism_.joints.size()); ++j)
      for (int body : mechanism_.joints[j].bodies) joints_of_[body].push_back(j);
  }

  std::optional<LegMachine> recognise() {
    LegMachine machine;
    for (int joint : joints_of_[mechanism_.platform]) {
      const std::optional<Leg> leg = leg_from(joint);
      if (!leg) return std::nullopt;
      machine.legs.push_back(*leg);
    }
    if (!std::all_of(used_.begin(), used_.end(), [](bool used) { return used; }))
      return std::nullopt;
    for (int drive = 0; drive < static_cast<int>(model_.drives.size()); ++drive) {
      const auto leg = std::find_if(machine.legs.begin(), machine.legs.end(),
                                    [drive](const Leg& l) { return l.drive == drive; });
      if (leg == machine.legs.end()) return std::nullopt;
      machine.primary.push_back(static_cast<int>(leg - machine.legs.begin()));
    }
    if (machine.primary.empty() || !limits_are_closed_form(machine)) return std::nullopt;
    return machine;
  }

 private:
  int other_body(int joint, int body) const {
    const auto& bodies = mechanism_.joints[joint].bodies;
    return bodies[0] == body ? bodies[1] : bodies[0];
  }

  /// The second joint of a body that has exactly two, else -1.
  int second_joint(int body, int first) const {
    const std::vector<int>& joints = joints_of_[body];
    if (joints.size() != 2) return -1;
    return joints[0] == first ? joints[1] : joints[0];
  }

  int drive_of(int joint) const {
    const int freedom = model_.first_freedom[joint];
    const auto drive = std::find(model_.drives.begin(), model_.drives.end(), freedom);
    return static_cast<int>(drive - model_.drives.begin());
  }

  std::optional<Leg> leg_from(int platform_joint) {
    if (!turns_freely(mechanism_.joints[platform_joint], planar_)) return std::nullopt;
    const int rod = other_body(platform_joint, mechanism_.platform);
    const int next = second_joint(rod, platform_joint);
    if (rod == mechanism_.base || next < 0) return std::nullopt;
    if (turns_freely(mechanism_.joints[next], planar_)) return rod_leg(platform_joint, rod, next);
    if (is_drive(mechanism_.joints[next])) return strut_leg(platform_joint, rod, next);
    return std::nullopt;
  }

  Leg leg_between(int base_joint, int platform_joint, int drive_joint) {
    used_[base_joint] = used_[platform_joint] = used_[drive_joint] = true;
    Leg leg;
    leg.drive = drive_of(drive_joint);
    leg.base_joint = base_joint;
    leg.platform_joint = platform_joint;
    leg.base_point = mechanism_.joints[base_joint].at;
    leg.platform_point = mechanism_.joints[platform_joint].at;
    leg.length = (leg.platform_point - leg.base_point).norm();
    const std::vector<Range>& range = mechanism_.joints[drive_joint].range;
    if (!range.empty()) leg.stroke = range.front();
    return leg;
  }

  /// The one drive between the base and a body that carries rods, -1 when there is none or
  /// more than one.
  int drive_from_base(int body) const {
    int drive = -1;
    for (int joint : joints_of_[body]) {
      const Joint& data = mechanism_.joints[joint];
      if ((!is_drive(data) && !is_crank(data)) || other_body(joint, body) != mechanism_.base)
        continue;
      if (drive >= 0) return -1;
      drive = joint;
    }
    return drive;
  }

  std::optional<Leg> rod_leg(int platform_joint, int rod, int carriage_joint) {
    const int drive = drive_from_base(other_body(carriage_joint, rod));
    if (drive < 0) return std::nullopt;
    Leg leg = leg_between(carriage_joint, platform_joint, drive);
    if (!(leg.length > 0)) return std::nullopt;
    const Joint& joint = mechanism_.joints[drive];
    leg.direction = joint.bodies[0] == mechanism_.base ? joint.axes[0] : Vector3(-joint.axes[0]);
    if (is_crank(joint)) return crank_leg(std::move(leg), joint.at);
    leg.side = (leg.platform_point - leg.base_point).dot(leg.direction) > 0 ? -1 : 1;
    return leg;
  }

  /// The rest of a leg on a crank that turns about `leg.direction` through a point.
  static std::optional<Leg> crank_leg(Leg leg, const Vector3& at) {
    leg.kind = Leg::Kind::crank_rod;
    leg.centre = at + leg.direction.dot(leg.base_point - at) * leg.direction;
    const Vector3 crank = leg.base_point - leg.centre;
    if (!(crank.norm() > 1e-9 * leg.length)) return std::nullopt;
    // Of the two angles home's: where the rod pulls the crank forward, or back.
    const Vector3 onward = leg.direction.cross(crank);
    leg.side = (leg.platform_point - leg.base_point).dot(onward) > 0 ? -1 : 1;
    return leg;
  }

  std::optional<Leg> strut_leg(int platform_joint, int upper, int drive_joint) {
    const int lower = other_body(drive_joint, upper);
    const int base_joint = second_joint(lower, drive_joint);
    if (base_joint < 0 || !turns_freely(mechanism_.joints[base_joint], planar_) ||
        other_body(base_joint, lower) != mechanism_.base)
      return std::nullopt;
    Leg leg = leg_between(base_joint, platform_joint, drive_joint);
    if (!(leg.length > 0)) return std::nullopt;
    leg.kind = Leg::Kind::strut;
    // The telescope must slide along the line between its ends, and grow with its drive.
    leg.direction = (leg.platform_point - leg.base_point) / leg.length;
    const Joint& joint = mechanism_.joints[drive_joint];
    const Vector3 axis = joint.bodies[0] == lower ? joint.axes[0] : Vector3(-joint.axes[0]);
    if ((axis - leg.direction).norm() > 1e-6) return std::nullopt;
    return leg;
  }

  /// A limit may only concern bodies whose place follows from pose and drives.
  bool limits_are_closed_form(const LegMachine& machine) const {
    const auto placed = [&](const auto& limit) {
      if (limit.body == mechanism_.base || limit.body == mechanism_.platform) return true;
      return carriage_leg(mechanism_, machine, limit.body) >= 0;
    };
    return std::all_of(mechanism_.limits.begin(), mechanism_.limits.end(), placed) &&
           shapes_are_placed(mechanism_, machine);
  }

  const Model& model_;
  const Mechanism& mechanism_;
  bool planar_;
  std::vector<std::vector<int>> joints_of_;
  std::vector<bool> used_;
};

}  // namespace

bool has_cranks(const LegMachine& machine) {
  return std::ranges::any_of(machine.legs,
                             [](const Leg& leg) { return leg.kind == Leg::Kind::crank_rod; });
}

int carriage_leg(const Mechanism& mechanism, const LegMachine& machine, int body) {
  for (int i = 0; i < static_cast<int>(machine.legs.size()); ++i) {
    const Leg& leg = machine.legs[i];
    if (leg.kind != Leg::Kind::guide_rod) continue;
    const int rod_end = leg_body(mechanism, leg);
    const auto& bodies = mechanism.joints[leg.base_joint].bodies;
    if (body != rod_end && (bodies[0] == body || bodies[1] == body)) return i;
  }
  return -1;
}

Vector3 axis_along_rod(const Joint& joint, const Leg& leg) {
  const bool along = joint.cone_axis.dot(leg.platform_point - leg.base_point) >= 0;
  return along ? joint.cone_axis : Vector3(-joint.cone_axis);
}

bool is_parallel(const Leg& leg, const Leg& first, const Eigen::Quaterniond& rotation) {
  constexpr double kSame = 1e-9;  // [m]
  const Vector3 apart =
      rotation * (leg.platform_point - first.platform_point) - (leg.base_point - first.base_point);
  return leg.kind == first.kind && std::abs(leg.length - first.length) < kSame &&
         leg.side == first.side && apart.norm() < kSame;
}

std::vector<WatchedPoint> watched_points(const Mechanism& mechanism, const LegMachine& machine,
                                         const std::vector<std::string>& ignored) {
  std::vector<WatchedPoint> points;
  for (const HalfSpaceLimit& limit : mechanism.limits) {
    if (is_ignored(limit.name, ignored)) continue;
    const int leg = carriage_leg(mechanism, machine, limit.body);
    for (const HalfSpaceLimit::Plane& plane : limit.planes)
      for (const Vector3& point : limit.points)
        points.push_back({limit, plane, point, limit.body == mechanism.platform,
                          leg < 0 ? nullptr : &machine.legs[leg]});
  }
  return points;
}

int leg_body(const Mechanism& mechanism, const Leg& leg) {
  const auto& bodies = mechanism.joints[leg.platform_joint].bodies;
  return bodies[0] == mechanism.platform ? bodies[1] : bodies[0];
}

std::optional<LegMachine> recognise_legs(const Model& model) {
  return Recogniser(model).recognise();
}

}  // namespace polyglide
