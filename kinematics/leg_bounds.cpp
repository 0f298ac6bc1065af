#include "kinematics/leg_bounds.hpp"

#include "kinematics/limits.hpp"

namespace polyglide {

void LegBounds::add_row(const Machine& machine, int index,
                        const std::vector<std::string>& ignored) {
  const Mechanism& mechanism = machine.model.mechanism;
  Row row;
  row.leg = machine.legs->legs[index];
  row.primary = machine.legs->primary[row.leg.drive] == index;
  const IntervalVector p = vector_of(row.leg.platform_point), b = vector_of(row.leg.base_point);
  row.arm = difference(p, vector_of(tool_));
  row.base = difference(b, vector_of(tool_));
  row.length = root(squared_norm(difference(p, b)));
  if (row.leg.kind == Leg::Kind::crank_rod) {
    const IntervalVector arm = difference(b, vector_of(row.leg.centre));
    row.base = difference(vector_of(row.leg.centre), vector_of(tool_));
    row.radius = root(squared_norm(arm));
    row.outward = scaled(arm, 1.0 / row.radius);
    row.onward = cross(row.leg.direction, row.outward);
  }
  row.reach = add("reach " + mechanism.bodies[leg_body(mechanism, row.leg)]);
  if (row.primary) {
    const int joint = machine.model.freedoms[machine.model.drives[row.leg.drive]].joint;
    const std::string stroke = "stroke " + mechanism.joints[joint].name;
    if (std::isfinite(row.leg.stroke.min) && !is_ignored(stroke + " min", ignored))
      row.min = add(stroke + " min");
    if (std::isfinite(row.leg.stroke.max) && !is_ignored(stroke + " max", ignored))
      row.max = add(stroke + " max");
  }
  for (const bool on_platform : {false, true}) {
    const Joint& joint =
        mechanism.joints[on_platform ? row.leg.platform_joint : row.leg.base_joint];
    if (!joint.cone || is_ignored("cone " + joint.name, ignored)) continue;
    row.cones.push_back({add("cone " + joint.name), on_platform, axis_along_rod(joint, row.leg),
                         cosine(Interval(std::min(M_PI, *joint.cone + kSlack)))});
  }
  rows_.push_back(std::move(row));
}

void LegBounds::add_planes(const Machine& machine, const std::vector<std::string>& ignored) {
  for (const auto& [limit, plane, point, on_platform, carriage] :
       watched_points(machine.model.mechanism, *machine.legs, ignored)) {
    Plane check{add(limit.name), plane.normal,           Interval(plane.offset) + kSlack,
                on_platform,     Vector3(point - tool_), -1,
                Interval(0.0)};
    check.offset -= dot(plane.normal, on_platform ? tool_ : point);
    if (carriage != nullptr) {
      check.drive = carriage->drive;
      check.slope = dot(plane.normal, carriage->direction);
    }
    planes_.push_back(check);
  }
}

std::optional<LegBounds> LegBounds::make(const Machine& machine,
                                         const std::vector<std::string>& ignored,
                                         const Eigen::Quaterniond& fixed, bool turning) {
  if (!machine.legs || !machine.task.pure) return std::nullopt;
  LegBounds result;
  result.tool_ = machine.model.mechanism.tool;
  result.fixed_ = fixed;
  result.axes_ = machine.task.axes;
  result.drives_ = static_cast<int>(machine.model.drives.size());
  result.characteristic_length_ = machine.task.characteristic_length;
  const LegMachine& legs = *machine.legs;
  for (int i = 0; i < static_cast<int>(legs.legs.size()); ++i) {
    const Leg &leg = legs.legs[i], &first = legs.legs[legs.primary[leg.drive]];
    // A second rod of a carriage must be the parallel of the first, turned by whatever the machine
    // can turn, else what both ask of the carriage is an equation.
    const Vector3 beside = leg.platform_point - first.platform_point;
    bool same = is_parallel(leg, first, fixed);
    for (int axis : machine.task.axes)
      same = same && (!turning || axis < 3 ||
                      beside.cross(Vector3::Unit(axis - 3)).norm() < 1e-9 * beside.norm());
    if (&leg != &first && !same) return std::nullopt;
    // What repeats and carries no cone says nothing new.
    const auto& joints = machine.model.mechanism.joints;
    if (&leg != &first && !joints[leg.base_joint].cone && !joints[leg.platform_joint].cone)
      continue;
    result.add_row(machine, i, ignored);
  }
  std::stable_partition(result.rows_.begin(), result.rows_.end(),
                        [](const Row& row) { return row.primary; });
  result.add_planes(machine, ignored);
  result.legs_ = legs.legs;
  const auto& expressions = machine.model.mechanism.expressions;
  if (std::any_of(expressions.begin(), expressions.end(),
                  [&](const auto& limit) { return !is_ignored(limit.name, ignored); }) ||
      !result.add_clearances(machine, ignored))
    return std::nullopt;
  if (result.size() > kMost) return std::nullopt;
  return result;
}

void LegBounds::enclose(const PoseBox& box, const Mask& wanted, std::vector<LimitBound>& bounds,
                        const BranchPointer& /*branch*/) const {
  bounds.resize(size());
  const Turned turning = turn(box);
  std::vector<std::pair<bool, Drive>> drives(drives_);
  const auto drive_needed = [&](int d) {
    return std::any_of(planes_.begin(), planes_.end(),
                       [&](const Plane& plane) { return plane.drive == d && wanted[plane.limit]; });
  };
  for (const Row& row : rows_) {
    bool needed = wanted[row.reach] || (row.min < kMost && wanted[row.min]) ||
                  (row.max < kMost && wanted[row.max]) ||
                  (row.primary && drive_needed(row.leg.drive));
    for (const Cone& cone : row.cones) needed = needed || wanted[cone.limit];
    if (!needed) continue;
    Drive drive = solve(row, box, turning, wanted, &bounds);
    if (row.primary) drives[row.leg.drive] = {true, drive};
  }
  for (const Plane& plane : planes_) {
    if (!wanted[plane.limit]) continue;
    LimitBound& bound = bounds[plane.limit];
    bound.value = -plane.offset;
    bound.gradient.fill(Interval(0.0));
    if (plane.on_platform) {
      const IntervalVector arm = turned(turning.rotation, vector_of(plane.arm));
      const IntervalVector normal = vector_of(plane.normal);
      bound.value += dot(normal, arm) + dot(normal, IntervalVector{box[0], box[1], box[2]});
      for (int i = 0; i < 3; ++i) bound.gradient[i] = normal[i];
      for (int k = 0; k < 3; ++k)
        if (turning.varies[k]) bound.gradient[3 + k] = dot(normal, cross(turning.axes[k], arm));
    } else if (plane.drive >= 0) {
      const Drive& drive = drives[plane.drive].second;
      bound.value += plane.slope * drive.place;
      for (int i = 0; i < 3; ++i) bound.gradient[i] = plane.slope * drive.row[i];
      for (int k = 0; k < 3; ++k)
        if (turning.varies[k])
          bound.gradient[3 + k] = plane.slope * dot(drive.row, cross(turning.axes[k], drive.arm));
    }
  }
  enclose_clearances(box, wanted, bounds);
}

IntervalMatrix LegBounds::jacobian(const PoseBox& box, const BranchPointer& /*branch*/) const {
  return matrix(box, false);
}

IntervalMatrix LegBounds::rod_rows(const PoseBox& box, const BranchPointer& /*branch*/) const {
  return matrix(box, true);
}

IntervalMatrix LegBounds::matrix(const PoseBox& box, bool scaled) const {
  const int n = static_cast<int>(axes_.size());
  IntervalMatrix result(drives_, n);
  const Turned turning = turn(box);
  for (const Row& row : rows_) {
    if (!row.primary) continue;
    const Drive drive = solve(row, box, turning, {}, nullptr);
    const IntervalVector& force = scaled ? drive.along : drive.row;
    const IntervalVector moment = cross(drive.arm, force);
    for (int k = 0; k < n; ++k)
      result(row.leg.drive, k) =
          axes_[k] < 3 ? force[axes_[k]] : moment[axes_[k] - 3] / characteristic_length_;
  }
  return result;
}

std::optional<BoxLimits::MovingRows> LegBounds::moving_rows(const PoseBox& box) const {
  const int n = static_cast<int>(axes_.size());
  const IntervalMatrix zero(drives_, n);
  MovingRows result{zero, {zero, zero, zero}};
  const Turned turning = turn(box);
  for (const Row& row : rows_) {
    if (!row.primary) continue;
    const Drive drive = solve(row, box, turning, {}, nullptr);
    const auto put = [&](IntervalMatrix& matrix, const IntervalVector& force) {
      const IntervalVector moment = cross(drive.arm, force);
      for (int k = 0; k < n; ++k)
        matrix(row.leg.drive, k) =
            axes_[k] < 3 ? force[axes_[k]] : moment[axes_[k] - 3] / characteristic_length_;
    };
    put(result.rows, drive.along);
    // A strut is v, a rod changes with its base joint, too; over the length, a rod with the sign of
    // -side.
    const bool strut = row.leg.kind == Leg::Kind::strut;
    for (int j = 0; j < 3; ++j) {
      IntervalVector rate;
      for (int i = 0; i < 3; ++i) {
        rate[i] = Interval(i == j ? 1.0 : 0.0);
        if (!strut) rate[i] = -row.leg.side * (rate[i] - drive.speed[i] * drive.row[j]);
        rate[i] /= row.length;
      }
      put(result.rates[j], rate);
    }
  }
  return result;
}

}  // namespace polyglide
