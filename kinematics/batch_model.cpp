#include "kinematics/batch_model.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "kinematics/limits.hpp"

namespace polyglide {
namespace {

using batch::ConeData;
using batch::KernelModel;
using batch::LegData;
using batch::LegKind;
using batch::PlaneData;

constexpr double kLimitSlack = 1e-9;    // [m, rad] a pose on its limit is allowed
constexpr double kDisagreement = 1e-6;  // of the rod length, between rods of one carriage
constexpr double kSameRod = 1e-12;      // [m] rods that ask their carriage the same

void put(double (&to)[3], const Vector3& v) { std::copy_n(v.data(), 3, to); }
Vector3 vector_of(const double* v) { return {v[0], v[1], v[2]}; }

void add(double (&to)[3], const Vector3& v) {
  for (int k = 0; k < 3; ++k) to[k] += v[k];
}

LegKind kind_of(const Leg& leg) {
  switch (leg.kind) {
    case Leg::Kind::strut:
      return LegKind::strut;
    case Leg::Kind::crank_rod:
      return LegKind::crank_rod;
    default:
      return LegKind::guide_rod;
  }
}

/// Leaves out rods that ask their drive what the one that gives it asks already, as in a
/// parallelogram: parallel to it at every rotation still to come, of which `stays` tells
/// whether they leave the difference of two platform joints as it is.
template <typename Stays>
void drop_repeats(KernelModel& model, const Stays& stays) {
  const auto repeats = [&](const LegData& leg) {
    if (leg.primary || leg.first_cone < leg.last_cone) return false;
    const LegData& first = *std::find_if(
        model.legs.begin(), model.legs.end(),
        [&](const LegData& other) { return other.primary && other.drive == leg.drive; });
    const Vector3 difference = vector_of(leg.arm) - vector_of(first.arm);
    const Vector3 whole = vector_of(leg.shift) - vector_of(first.shift);
    return leg.kind == first.kind && std::abs(leg.length - first.length) < kSameRod &&
           stays(difference, whole);
  };
  std::vector<LegData> kept;
  std::copy_if(model.legs.begin(), model.legs.end(), std::back_inserter(kept),
               [&](const LegData& leg) { return !repeats(leg); });
  model.legs = std::move(kept);
}

}  // namespace

BatchModel::BatchModel(const Machine& machine, const std::vector<std::string>& ignored) {
  const TaskSpace& task = machine.task;
  all_.drives = static_cast<int>(machine.model.drives.size());
  all_.columns = static_cast<int>(task.axes.size());
  for (int k = 0; k < all_.columns; ++k) {
    all_.axes[k] = task.axes[k];
    all_.free[task.axes[k]] = true;
    all_.moments = all_.moments || task.axes[k] >= 3;
  }
  all_.scale = 1 / task.characteristic_length;
  all_.lever.assign(all_.drives, 1);
  const LegMachine& legs = *machine.legs;
  for (int i = 0; i < static_cast<int>(legs.legs.size()); ++i)
    add_leg(machine, legs.legs[i], legs.primary[legs.legs[i].drive] == i, ignored);
  // The rod that gives a drive comes before those that must agree with it.
  std::stable_partition(all_.legs.begin(), all_.legs.end(),
                        [](const LegData& leg) { return leg.primary; });
  for (const HalfSpaceLimit& limit : machine.model.mechanism.limits)
    add_limit(machine, limit, ignored);
  for (const std::string& name : late_limit_names(machine.model.mechanism, ignored)) add_name(name);
  all_.motion = add_name("motion");
  all_.not_finite = add_name("not finite");

  turning_ = all_;
  const Vector3 turns(all_.free[3], all_.free[4], all_.free[5]);
  drop_repeats(turning_, [&](const Vector3& arm, const Vector3& shift) {
    const bool stays = turns.sum() == 0   ? true
                       : turns.sum() == 1 ? arm.cross(turns).norm() < kSameRod
                                          : arm.norm() < kSameRod;
    return stays && (arm + shift).norm() < kSameRod;
  });
}

int BatchModel::add_name(std::string name) {
  limit_names_.push_back(std::move(name));
  return static_cast<int>(limit_names_.size()) - 1;
}

void BatchModel::add_leg(const Machine& machine, const Leg& leg, bool primary,
                         const std::vector<std::string>& ignored) {
  const Mechanism& mechanism = machine.model.mechanism;
  LegData data;
  data.kind = kind_of(leg);
  data.drive = leg.drive;
  data.primary = primary;
  data.length = leg.length;
  data.side = leg.side;
  data.min = leg.stroke.min - kLimitSlack;
  data.max = leg.stroke.max + kLimitSlack;
  data.tolerance = kDisagreement * leg.length;
  put(data.direction, leg.direction);
  put(data.arm, leg.platform_point - mechanism.tool);
  put(data.shift, mechanism.tool - leg.base_point);
  if (leg.kind == Leg::Kind::crank_rod) {
    const Vector3 crank = leg.base_point - leg.centre;
    data.radius = crank.norm();
    data.tolerance /= data.radius;
    put(data.shift, mechanism.tool - leg.centre);
    put(data.outward, crank / data.radius);
    put(data.onward, leg.direction.cross(crank) / data.radius);
    all_.lever[leg.drive] = data.radius;
  }
  data.reach = add_name("reach " + mechanism.bodies[leg_body(mechanism, leg)]);
  if (primary) {
    const int joint = machine.model.freedoms[machine.model.drives[leg.drive]].joint;
    const std::string stroke = "stroke " + mechanism.joints[joint].name;
    data.min_limit = add_name(stroke + " min");
    data.max_limit = add_name(stroke + " max");
  }
  data.first_cone = static_cast<int>(all_.cones.size());
  add_cone(machine, leg, leg.base_joint, false, ignored);
  add_cone(machine, leg, leg.platform_joint, true, ignored);
  data.last_cone = static_cast<int>(all_.cones.size());
  all_.legs.push_back(data);
}

void BatchModel::add_cone(const Machine& machine, const Leg& leg, int joint, bool on_platform,
                          const std::vector<std::string>& ignored) {
  const Joint& data = machine.model.mechanism.joints[joint];
  if (!data.cone || is_ignored("cone " + data.name, ignored)) return;
  ConeData cone;
  cone.on = on_platform                        ? ConeData::On::platform
            : leg.kind == Leg::Kind::crank_rod ? ConeData::On::crank
                                               : ConeData::On::base;
  put(cone.axis, axis_along_rod(data, leg));
  cone.cosine = std::cos(std::min(M_PI, *data.cone + kLimitSlack));
  cone.limit = add_name("cone " + data.name);
  all_.cones.push_back(cone);
}

void BatchModel::add_limit(const Machine& machine, const HalfSpaceLimit& limit,
                           const std::vector<std::string>& ignored) {
  if (is_ignored(limit.name, ignored)) return;
  const Mechanism& mechanism = machine.model.mechanism;
  const int name = add_name(limit.name);
  const int leg = carriage_leg(mechanism, *machine.legs, limit.body);
  for (const HalfSpaceLimit::Plane& plane : limit.planes) {
    PlaneData data;
    data.limit = name;
    data.offset = plane.offset + kLimitSlack;
    data.first_arm = data.last_arm = static_cast<int>(all_.arms.size()) / 3;
    if (limit.body == mechanism.platform) {
      put(data.normal, plane.normal);
      data.offset -= plane.normal.dot(mechanism.tool);
      for (const Vector3& point : limit.points) {
        const Vector3 arm = point - mechanism.tool;
        all_.arms.insert(all_.arms.end(), arm.data(), arm.data() + 3);
        ++data.last_arm;
      }
    } else {
      double farthest = -std::numeric_limits<double>::infinity();
      for (const Vector3& point : limit.points)
        farthest = std::max(farthest, plane.normal.dot(point));
      data.offset -= farthest;
    }
    if (leg >= 0) {
      data.drive = machine.legs->legs[leg].drive;
      data.slope = plane.normal.dot(machine.legs->legs[leg].direction);
    }
    all_.planes.push_back(data);
  }
}

bool BatchModel::commands(const Eigen::Quaterniond& rotation) const {
  const auto asked = coordinates_of({Vector3::Zero(), rotation.normalized()});
  for (int axis = 3; axis < 6; ++axis)
    if (!(std::abs(asked[axis]) <= kLimitSlack) && !all_.free[axis]) return false;
  return true;
}

KernelModel BatchModel::turned(const Eigen::Quaterniond& rotation) const {
  const Eigen::Matrix3d turn = rotation.normalized().toRotationMatrix();
  KernelModel model = all_;
  for (LegData& leg : model.legs) {
    const Vector3 arm = turn * vector_of(leg.arm);
    put(leg.arm, arm);
    add(leg.shift, arm);
    for (int c = leg.first_cone; c < leg.last_cone; ++c) {
      ConeData& cone = model.cones[c];
      if (cone.on == ConeData::On::platform) put(cone.axis, turn * vector_of(cone.axis));
    }
  }
  // The shift holds all of a rod's offset by now.
  drop_repeats(model, [](const Vector3&, const Vector3& shift) { return shift.norm() < kSameRod; });
  for (PlaneData& plane : model.planes) {
    double farthest = -std::numeric_limits<double>::infinity();
    for (int i = plane.first_arm; i < plane.last_arm; ++i)
      farthest =
          std::max(farthest, vector_of(plane.normal).dot(turn * vector_of(&model.arms[3 * i])));
    if (plane.first_arm < plane.last_arm) plane.offset -= farthest;
    plane.first_arm = plane.last_arm = 0;
  }
  return model;
}

}  // namespace polyglide
