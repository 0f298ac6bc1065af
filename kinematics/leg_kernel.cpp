#include "kinematics/leg_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/batch_loops.hpp"
#include "kinematics/limits.hpp"

namespace polyglide {
namespace {

constexpr double kSlack = 1e-9;  // [m, rad] a pose on its limit is allowed
constexpr double kDisagreement =
    1e-6;  // of the rod length: two rods that ask one carriage to be here

batch::Vector vector_of(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

signed char sign_of(double value) { return static_cast<signed char>((value > 0) - (value < 0)); }

using Jacobian =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Eigen::Dynamic, batch::kMost>;

/// Fixed sizes for the common ones.
double determinant(const Jacobian& jacobian) {
  switch (jacobian.cols()) {
    case 4:
      return jacobian.topLeftCorner<4, 4>().determinant();
    case 6:
      return jacobian.topLeftCorner<6, 6>().determinant();
    default:
      return jacobian.determinant();
  }
}

}  // namespace

LegKernel::LegKernel(const Machine& machine, const std::vector<std::string>& ignored)
    : machine_(machine), drives_(static_cast<int>(machine.model.drives.size())) {
  const LegMachine& legs = *machine_.legs;
  for (int i = 0; i < static_cast<int>(legs.legs.size()); ++i)
    add_leg(legs.legs[i], legs.primary[legs.legs[i].drive] == i, ignored);
  for (const HalfSpaceLimit& limit : machine_.model.mechanism.limits) add_limit(limit, ignored);
  motion_limit_ = add_name("motion");
}

int LegKernel::add_name(std::string name) {
  limit_names_.push_back(std::move(name));
  return static_cast<int>(limit_names_.size()) - 1;
}

void LegKernel::add_leg(const Leg& leg, bool primary, const std::vector<std::string>& ignored) {
  const Mechanism& mechanism = machine_.model.mechanism;
  Row row{leg, primary, 0, 0, 0, {}};
  row.reach = add_name("reach " + mechanism.bodies[leg_body(mechanism, leg)]);
  if (primary) {
    const int joint = machine_.model.freedoms[machine_.model.drives[leg.drive]].joint;
    const std::string stroke = "stroke " + mechanism.joints[joint].name;
    row.stroke_min = add_name(stroke + " min");
    row.stroke_max = add_name(stroke + " max");
  }
  add_cone(row, leg.base_joint, false, ignored);
  add_cone(row, leg.platform_joint, true, ignored);
  rows_.push_back(std::move(row));
}

void LegKernel::add_cone(Row& row, int joint, bool on_platform,
                         const std::vector<std::string>& ignored) {
  const Joint& data = machine_.model.mechanism.joints[joint];
  if (!data.cone || is_ignored("cone " + data.name, ignored)) return;
  // The file may give the axis either way; it is meant along the rod.
  const bool along = data.cone_axis.dot(row.leg.platform_point - row.leg.base_point) >= 0;
  row.cones.push_back({joint, add_name("cone " + data.name), on_platform,
                       along ? data.cone_axis : Vector3(-data.cone_axis),
                       std::cos(std::min(M_PI, *data.cone + kSlack))});
}

void LegKernel::add_limit(const HalfSpaceLimit& limit, const std::vector<std::string>& ignored) {
  if (is_ignored(limit.name, ignored)) return;
  const Mechanism& mechanism = machine_.model.mechanism;
  const int name = add_name(limit.name);
  const int leg = carriage_leg(mechanism, *machine_.legs, limit.body);
  for (const HalfSpaceLimit::Plane& plane : limit.planes) {
    Plane check{name, plane, limit.points, limit.body == mechanism.platform, -1, Vector3::Zero()};
    if (leg >= 0) {
      check.drive = machine_.legs->legs[leg].drive;
      check.direction = machine_.legs->legs[leg].direction;
    }
    planes_.push_back(std::move(check));
  }
}

LegKernel::Oriented LegKernel::orient(const Eigen::Quaterniond& rotation) const {
  Oriented oriented;
  oriented.rotation = rotation.normalized().toRotationMatrix();
  const auto asked = coordinates_of({Vector3::Zero(), rotation.normalized()});
  const std::vector<int>& axes = machine_.task.axes;
  for (int axis = 3; axis < 6; ++axis)
    if (std::abs(asked[axis]) > kSlack && std::count(axes.begin(), axes.end(), axis) == 0)
      oriented.commanded = false;

  const Vector3& tool = machine_.model.mechanism.tool;
  oriented.arms.resize(drives_);
  for (int i = 0; i < static_cast<int>(rows_.size()); ++i) {
    const Leg& leg = rows_[i].leg;
    const Vector3 arm = oriented.rotation * (leg.platform_point - tool);
    oriented.offsets.push_back(tool + arm - leg.base_point);
    if (rows_[i].primary) oriented.arms[leg.drive] = arm;
  }
  for (int i = 0; i < static_cast<int>(rows_.size()); ++i) {
    // A rod parallel to the one that gives the drive, as in a parallelogram, asks the same again.
    const Row& row = rows_[i];
    const int first = machine_.legs->primary[row.leg.drive];
    const bool repeats = !row.primary && row.cones.empty() &&
                         row.leg.kind == rows_[first].leg.kind &&
                         std::abs(row.leg.length - rows_[first].leg.length) < 1e-12 &&
                         (oriented.offsets[i] - oriented.offsets[first]).norm() < 1e-12;
    if (!repeats) oriented.rows.push_back(i);
  }
  // The drive of a row must be solved before other rods of the carriage are compared with it.
  std::stable_partition(oriented.rows.begin(), oriented.rows.end(),
                        [this](int i) { return rows_[i].primary; });

  for (const Plane& plane : planes_) {
    double farthest = -std::numeric_limits<double>::infinity();
    for (const Vector3& point : plane.points) {
      const Vector3 at =
          plane.on_platform ? Vector3(tool + oriented.rotation * (point - tool)) : point;
      farthest = std::max(farthest, plane.plane.normal.dot(at));
    }
    oriented.planes.push_back({plane.on_platform ? plane.plane.normal : Vector3(Vector3::Zero()),
                               plane.plane.offset - farthest + kSlack,
                               plane.plane.normal.dot(plane.direction), plane.drive, plane.limit});
  }
  return oriented;
}

void LegKernel::evaluate(const Oriented& oriented, Block& block) const {
  block.drives.resize(static_cast<std::size_t>(drives_) * kBlock);
  block.rows.resize(static_cast<std::size_t>(drives_) * 3 * kBlock);
  block.code.assign(kBlock, oriented.commanded ? -1 : motion_limit_);
  const std::vector<int>& axes = machine_.task.axes;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::count(axes.begin(), axes.end(), axis) > 0) continue;
    const double* stray = axis == 0 ? block.x : axis == 1 ? block.y : block.z;
    for (int i = 0; i < block.count; ++i)
      if (std::abs(stray[i]) > kSlack) block.code[i] = motion_limit_;
  }
  for (int row : oriented.rows) solve_leg(rows_[row], oriented.offsets[row], oriented, block);
  for (const Oriented::Plane& plane : oriented.planes)
    batch::check_plane(block.count, block.x, block.y, block.z, vector_of(plane.normal),
                       &block.drives[static_cast<std::size_t>(std::max(plane.drive, 0)) * kBlock],
                       plane.slope, plane.offset, plane.limit, block.code.data());

  if (axes == std::vector<int>{0, 1, 2})
    condition_translations(block);
  else
    condition(oriented, block);
  for (int i = 0; i < block.count; ++i) {
    block.limit[i] = static_cast<int>(block.code[i]);
    if (block.limit[i] < 0) continue;
    block.inverse_condition[i] = 0;
    block.orientation[i] = 0;
  }
}

void LegKernel::solve_leg(const Row& row, const Vector3& offset, const Oriented& oriented,
                          Block& block) const {
  const Leg& leg = row.leg;
  const bool guide = leg.kind == Leg::Kind::guide_rod;
  double* place_of_drive = &block.drives[static_cast<std::size_t>(leg.drive) * kBlock];
  double own_place[kBlock], along[3 * kBlock];
  double* place = row.primary ? place_of_drive : own_place;
  double* code = block.code.data();
  const int count = block.count;
  const double reach = row.reach;
  if (guide)
    batch::solve_rod(count, block.x, block.y, block.z,
                     {vector_of(offset), vector_of(leg.direction), leg.length, leg.side, reach},
                     place, along, code);
  else
    batch::solve_strut(count, block.x, block.y, block.z, {vector_of(offset), leg.length, reach},
                       place, along, code);
  if (row.primary) {
    batch::check_range(count, place, leg.stroke.min - kSlack, row.stroke_min,
                       leg.stroke.max + kSlack, row.stroke_max, code);
    // u·(ṗ + ω×r) = (u·g) ṡ; for a strut u·g is 1.
    double* j = &block.rows[static_cast<std::size_t>(leg.drive) * 3 * kBlock];
    if (guide)
      batch::rod_row(count, along, vector_of(leg.direction), j);
    else
      std::copy_n(along, 3 * kBlock, j);
  } else {
    batch::check_agreement(count, place, place_of_drive, kDisagreement * leg.length, reach, code);
  }
  for (const Cone& cone : row.cones)
    batch::check_cone(
        count, along,
        vector_of(cone.on_platform ? Vector3(oriented.rotation * cone.axis) : cone.axis),
        cone.cosine, cone.limit, code);
}

void LegKernel::condition_translations(Block& block) const {
  const bool square = drives_ == 3;
  if (block.conditioning || !square)
    batch::condition3(block.count, drives_, block.rows.data(), block.inverse_condition);
  std::fill_n(block.orientation, block.count, static_cast<signed char>(0));
  if (!square) return;
  double det[kBlock];
  batch::determinant3(block.count, block.rows.data(), det);
  for (int i = 0; i < block.count; ++i) block.orientation[i] = sign_of(det[i]);
  if (!block.conditioning)
    for (int i = 0; i < block.count; ++i) block.inverse_condition[i] = det[i] != 0;
}

void LegKernel::condition(const Oriented& oriented, Block& block) const {
  const std::vector<int>& axes = machine_.task.axes;
  const int n = static_cast<int>(axes.size());
  const bool square = drives_ == n, conditioning = block.conditioning || !square;
  const double scale = 1 / machine_.task.characteristic_length;
  batch::Grams grams;
  double inverse[batch::kLanes];
  Jacobian jacobian(drives_, n);
  for (int begin = 0; begin < block.count; begin += batch::kLanes) {
    const int lanes = std::min(batch::kLanes, block.count - begin);
    std::fill_n(&grams.entry[0][0][0], batch::kMost * batch::kMost * batch::kLanes, 0.0);
    std::fill_n(inverse, batch::kLanes, 1.0);
    for (int i = 0; i < lanes; ++i) {
      block.orientation[begin + i] = 0;
      if (block.code[begin + i] >= 0) continue;
      for (int d = 0; d < drives_; ++d) {
        const double* j = &block.rows[static_cast<std::size_t>(d) * 3 * kBlock + begin + i];
        const Vector3 force(j[0], j[kBlock], j[2 * kBlock]);
        const Vector3 moment = oriented.arms[d].cross(force) * scale;
        for (int k = 0; k < n; ++k)
          jacobian(d, k) = axes[k] < 3 ? force[axes[k]] : moment[axes[k] - 3];
        for (int k = 0; conditioning && k < n; ++k)
          for (int l = k; l < n; ++l) grams.entry[k][l][i] += jacobian(d, k) * jacobian(d, l);
      }
      if (!square) continue;
      block.orientation[begin + i] = sign_of(determinant(jacobian));
      if (!conditioning) inverse[i] = block.orientation[begin + i] != 0;
    }
    if (conditioning) batch::condition_n(n, grams, inverse);
    std::copy_n(inverse, lanes, block.inverse_condition + begin);
  }
}

}  // namespace polyglide
