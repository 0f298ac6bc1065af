#include "kinematics/line_limits.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/limits.hpp"

namespace polyglide {
namespace {

/// Equal to within what rounding does; infinities are equal.
bool same(double a, double b, double tolerance) { return a == b || std::abs(a - b) < tolerance; }

/// Base axes of a frame that nothing in a machine is likely to be parallel to; in a plane x is its
/// normal.
Eigen::Matrix3d turned_frame(const std::array<bool, 3>& active, int dimensions) {
  if (dimensions == 3)
    return Eigen::Quaterniond(0.8413, 0.2371, -0.3159, 0.3697).normalized().toRotationMatrix();
  const auto still = std::find(active.begin(), active.end(), false) - active.begin();
  const Vector3 normal = Vector3::Unit(still);
  Eigen::Matrix3d frame;
  frame.col(0) = normal;
  frame.col(2) = Eigen::AngleAxisd(0.4711, normal) * Vector3::Unit((still + 1) % 3);
  frame.col(1) = frame.col(2).cross(normal);
  return frame;
}

}  // namespace

std::optional<LineLimits> LineLimits::make(const Machine& machine,
                                           const std::vector<std::string>& ignored,
                                           const Eigen::Quaterniond& rotation, const Bounds& box) {
  if (!machine.legs || !machine.task.pure || machine.task.translations < 2) return std::nullopt;
  if (!late_limit_names(machine.model.mechanism, ignored).empty()) return std::nullopt;
  LineLimits result;
  result.dimensions_ = machine.task.translations;
  result.size_ = machine.model.size;
  result.scale_ = machine.task.characteristic_length;
  result.axes_ = machine.task.axes;
  if (!result.add_rods(machine, ignored, rotation) ||
      !result.add_planes(machine, ignored, rotation))
    return std::nullopt;
  result.drop_repeats();
  result.add_box(machine, box);
  return result;
}

bool LineLimits::add_rods(const Machine& machine, const std::vector<std::string>& ignored,
                          const Eigen::Quaterniond& rotation) {
  const LegMachine& legs = *machine.legs;
  const Vector3& tool = machine.model.mechanism.tool;
  const auto& joints = machine.model.mechanism.joints;
  drives_.resize(machine.model.drives.size());
  for (int i = 0; i < static_cast<int>(legs.legs.size()); ++i) {
    const Leg &leg = legs.legs[i], &first = legs.legs[legs.primary[leg.drive]];
    Rod rod;
    rod.kind = leg.kind;
    rod.drive = leg.drive;
    rod.direction = leg.direction;
    rod.arm = rotation * (leg.platform_point - tool);
    rod.length = leg.length;
    rod.side = leg.side;
    rod.min = leg.stroke.min;
    rod.max = leg.stroke.max;
    const bool crank = leg.kind == Leg::Kind::crank_rod;
    rod.shift = tool + rod.arm - (crank ? leg.centre : leg.base_point);
    if (crank) {
      rod.outward = leg.base_point - leg.centre;
      rod.onward = leg.direction.cross(rod.outward);
      rod.radius = rod.outward.norm();
    }
    rod.reach = limits_;
    limits_ += 3;
    for (const bool on_platform : {false, true}) {
      const Joint& joint = joints[on_platform ? leg.platform_joint : leg.base_joint];
      if (!joint.cone || is_ignored("cone " + joint.name, ignored)) continue;
      if (crank && !on_platform) return false;
      const Vector3 axis = axis_along_rod(joint, leg);
      rod.cones.push_back(
          {limits_++, on_platform ? rotation * axis : axis, std::cos(std::min(M_PI, *joint.cone))});
    }
    if (crank && !rod.cones.empty()) return false;
    if (&leg == &first)
      drives_[leg.drive] = rod;
    else if (!is_parallel(leg, first, rotation))
      return false;
    rods_.push_back(std::move(rod));
  }
  return true;
}

bool LineLimits::add_planes(const Machine& machine, const std::vector<std::string>& ignored,
                            const Eigen::Quaterniond& rotation) {
  const Mechanism& mechanism = machine.model.mechanism;
  for (const auto& [limit, plane, point, on_platform, carriage] :
       watched_points(mechanism, *machine.legs, ignored)) {
    if (on_platform) {
      const Vector3 at = mechanism.tool + rotation * (point - mechanism.tool);
      planes_.push_back({plane.normal, plane.offset - plane.normal.dot(at), limits_++});
      continue;
    }
    // A plane before a carriage is an end of its stroke.
    const double left = plane.offset - plane.normal.dot(point);
    const double slope = carriage == nullptr ? 0 : plane.normal.dot(carriage->direction);
    if (slope == 0 && left < 0) return false;
    for (Rod& rod : rods_) {
      if (carriage == nullptr || rod.drive != carriage->drive) continue;
      if (slope > 0) rod.max = std::min(rod.max, left / slope);
      if (slope < 0) rod.min = std::max(rod.min, left / slope);
    }
  }
  return true;
}

void LineLimits::drop_repeats() {
  std::vector<Rod> kept;
  for (const Rod& rod : rods_) {
    const bool repeats =
        rod.cones.empty() && std::ranges::any_of(kept, [&](const Rod& other) {
          return other.kind == rod.kind && (other.shift - rod.shift).norm() < kTouch * size_ &&
                 same(other.length, rod.length, kTouch * size_) && other.side == rod.side &&
                 same(other.min, rod.min, kTouch * size_) &&
                 same(other.max, rod.max, kTouch * size_) &&
                 (rod.kind == Leg::Kind::strut ||
                  (other.direction - rod.direction).norm() < kTouch) &&
                 (other.outward - rod.outward).norm() < kTouch * size_;
        });
    if (!repeats) kept.push_back(rod);
  }
  rods_ = std::move(kept);
}

void LineLimits::add_box(const Machine& machine, const Bounds& box) {
  std::array<bool, 3> active{};
  for (int axis : machine.task.axes)
    if (axis < 3) active[axis] = true;
  frame_ = turned_frame(active, dimensions_);
  for (int axis = 0; axis < 3; ++axis) {
    if (!active[axis]) continue;
    // Where a straight end of reach is a side of the box, rounding would choose between the two.
    const double margin = 1e-6 * size_;
    planes_.push_back({Vector3::Unit(axis), box.upper[axis] + margin, limits_++});
    planes_.push_back({-Vector3::Unit(axis), margin - box.lower[axis], limits_++});
  }
  extent_ = frame_bounds(box);
}

Bounds LineLimits::frame_bounds(const Bounds& box) const {
  const Vector3 centre = frame_.transpose() * (box.lower + box.upper) / 2;
  const Vector3 half = frame_.transpose().cwiseAbs() * (box.upper - box.lower) / 2;
  return {centre - half, centre + half};
}

}  // namespace polyglide
