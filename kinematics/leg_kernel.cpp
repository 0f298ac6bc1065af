#include "kinematics/leg_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/condition.hpp"
#include "kinematics/limits.hpp"

namespace polyglide {
namespace {

constexpr double kSlack = 1e-9;        // [m, rad] a pose on its limit is allowed
constexpr double kDisagreement = 1e-6; // of the rod length: two rods that ask one carriage to be here

bool is_translational(const TaskSpace& task) { return task.axes == std::vector<int>{0, 1, 2}; }

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
    const bool repeats = !row.primary && row.cones.empty() && row.leg.kind == rows_[first].leg.kind &&
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
      const Vector3 at = plane.on_platform ? Vector3(tool + oriented.rotation * (point - tool)) : point;
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
  std::fill_n(block.limit, block.count, oriented.commanded ? -1 : motion_limit_);
  std::fill_n(block.orientation, block.count, static_cast<signed char>(0));
  const std::vector<int>& axes = machine_.task.axes;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::count(axes.begin(), axes.end(), axis) > 0) continue;
    const double* stray = axis == 0 ? block.x : axis == 1 ? block.y : block.z;
    for (int i = 0; i < block.count; ++i)
      if (std::abs(stray[i]) > kSlack) block.limit[i] = motion_limit_;
  }
  for (int row : oriented.rows) solve_leg(rows_[row], oriented.offsets[row], oriented, block);
  check_planes(oriented, block);

  if (is_translational(machine_.task)) condition_translations(block);
  else {
    switch (axes.size()) {
      case 1: condition<1>(oriented, block); break;
      case 2: condition<2>(oriented, block); break;
      case 3: condition<3>(oriented, block); break;
      case 4: condition<4>(oriented, block); break;
      case 5: condition<5>(oriented, block); break;
      default: condition<6>(oriented, block); break;
    }
  }
}

void LegKernel::solve_leg(const Row& row, const Vector3& a, const Oriented& oriented,
                          Block& block) const {
  const Leg& leg = row.leg;
  const Vector3 g = leg.direction;
  const double length = leg.length, square = length * length, side = leg.side;
  const bool guide = leg.kind == Leg::Kind::guide_rod;
  double* s = &block.drives[static_cast<std::size_t>(leg.drive) * kBlock];
  double* jx = &block.rows[static_cast<std::size_t>(leg.drive) * 3 * kBlock];
  double *jy = jx + kBlock, *jz = jy + kBlock;
  double place[kBlock], ux[kBlock], uy[kBlock], uz[kBlock];
  int* limit = block.limit;
  const int count = block.count;

  // Place of the drive and direction of the rod.
  for (int i = 0; i < count; ++i) {
    const double vx = a.x() + block.x[i], vy = a.y() + block.y[i], vz = a.z() + block.z[i];
    if (guide) {
      const double along = vx * g.x() + vy * g.y() + vz * g.z();
      const double px = vx - along * g.x(), py = vy - along * g.y(), pz = vz - along * g.z();
      const double left = square - (px * px + py * py + pz * pz);
      const double rise = side * std::sqrt(left > 0 ? left : 0);
      limit[i] = limit[i] < 0 && left < 0 ? row.reach : limit[i];
      place[i] = along + rise;
      ux[i] = (px - rise * g.x()) / length;
      uy[i] = (py - rise * g.y()) / length;
      uz[i] = (pz - rise * g.z()) / length;
    } else {
      const double distance = std::sqrt(vx * vx + vy * vy + vz * vz);
      limit[i] = limit[i] < 0 && !(distance > 0) ? row.reach : limit[i];
      place[i] = distance - length;
      ux[i] = vx / distance;
      uy[i] = vy / distance;
      uz[i] = vz / distance;
    }
  }
  if (row.primary) {
    const double min = leg.stroke.min - kSlack, max = leg.stroke.max + kSlack;
    for (int i = 0; i < count; ++i) {
      s[i] = place[i];
      limit[i] = limit[i] < 0 && place[i] < min ? row.stroke_min : limit[i];
      limit[i] = limit[i] < 0 && place[i] > max ? row.stroke_max : limit[i];
    }
    // u·(ṗ + ω×r) = (u·g) ṡ; for a strut u·g is 1.
    for (int i = 0; i < count; ++i) {
      const double gain = guide ? ux[i] * g.x() + uy[i] * g.y() + uz[i] * g.z() : 1;
      jx[i] = ux[i] / gain;
      jy[i] = uy[i] / gain;
      jz[i] = uz[i] / gain;
    }
  } else {
    for (int i = 0; i < count; ++i)
      limit[i] = limit[i] < 0 && !(std::abs(place[i] - s[i]) <= kDisagreement * length) ? row.reach
                                                                                        : limit[i];
  }
  for (const Cone& cone : row.cones) {
    const Vector3 axis = cone.on_platform ? Vector3(oriented.rotation * cone.axis) : cone.axis;
    for (int i = 0; i < count; ++i) {
      const double cosine = ux[i] * axis.x() + uy[i] * axis.y() + uz[i] * axis.z();
      limit[i] = limit[i] < 0 && cosine < cone.cosine ? cone.limit : limit[i];
    }
  }
}

void LegKernel::check_planes(const Oriented& oriented, Block& block) const {
  for (const Oriented::Plane& plane : oriented.planes) {
    const double* s = &block.drives[static_cast<std::size_t>(std::max(plane.drive, 0)) * kBlock];
    for (int i = 0; i < block.count; ++i) {
      const double height = plane.normal.x() * block.x[i] + plane.normal.y() * block.y[i] +
                            plane.normal.z() * block.z[i] + plane.slope * s[i];
      block.limit[i] = block.limit[i] < 0 && height > plane.offset ? plane.limit : block.limit[i];
    }
  }
}

/// Three translations: closed form, from JᵀJ summed over the drives.
void LegKernel::condition_translations(Block& block) const {
  Gram3 gram[kBlock];
  std::fill_n(gram, block.count, Gram3{});
  for (int d = 0; d < drives_; ++d) {
    const double* jx = &block.rows[static_cast<std::size_t>(d) * 3 * kBlock];
    const double *jy = jx + kBlock, *jz = jy + kBlock;
    for (int i = 0; i < block.count; ++i) gram[i].add(jx[i], jy[i], jz[i]);
  }
  for (int i = 0; i < block.count; ++i) block.inverse_condition[i] = inverse_condition(gram[i]);
  if (drives_ == 3) {
    const double* j = block.rows.data();
    for (int i = 0; i < block.count; ++i) {
      const auto at = [j, i](int row, int column) { return j[(3 * row + column) * kBlock + i]; };
      const double det = at(0, 0) * (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)) -
                         at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0)) +
                         at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0));
      block.orientation[i] = static_cast<signed char>((det > 0) - (det < 0));
    }
  }
  for (int i = 0; i < block.count; ++i) {
    if (block.limit[i] < 0) continue;
    block.inverse_condition[i] = 0;
    block.orientation[i] = 0;
  }
}

template <int N>
void LegKernel::condition(const Oriented& oriented, Block& block) const {
  const std::vector<int>& axes = machine_.task.axes;
  const double scale = 1 / machine_.task.characteristic_length;
  for (int i = 0; i < block.count; ++i) {
    block.inverse_condition[i] = 0;
    if (block.limit[i] >= 0) continue;
    Eigen::Matrix<double, N, N> gram = Eigen::Matrix<double, N, N>::Zero(), square;
    for (int d = 0; d < drives_; ++d) {
      const double* j = &block.rows[static_cast<std::size_t>(d) * 3 * kBlock + i];
      const Vector3 force(j[0], j[kBlock], j[2 * kBlock]);
      const Vector3 moment = oriented.arms[d].cross(force) * scale;
      Eigen::Matrix<double, N, 1> row;
      for (int k = 0; k < N; ++k) row[k] = axes[k] < 3 ? force[axes[k]] : moment[axes[k] - 3];
      gram.noalias() += row * row.transpose();
      if (d < N) square.row(d) = row;
    }
    block.inverse_condition[i] = inverse_condition<N>(gram);
    if (drives_ == N) {
      const double det = square.determinant();
      block.orientation[i] = static_cast<signed char>((det > 0) - (det < 0));
    }
  }
}

}  // namespace polyglide
