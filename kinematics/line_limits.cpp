#include "kinematics/line_limits.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/limits.hpp"
#include "kinematics/real_roots.hpp"

namespace polyglide {
namespace {

constexpr double kSame = 1e-9;    // [m] rods that ask their carriage the same
constexpr double kTouch = 1e-12;  // of the machine's size: ends nearer than this are one

/// z ↦ square of a vector start + z·way, |way| = 1, as a polynomial.
Quartic squared(const Vector3& start, const Vector3& way) {
  return {start.squaredNorm(), 2 * start.dot(way), way.squaredNorm(), 0, 0};
}

/// z ↦ (a + b z)².
Quartic squared(double a, double b) { return {a * a, 2 * a * b, b * b, 0, 0}; }

Quartic minus(Quartic a, const Quartic& b, double factor = 1) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= factor * b[i];
  return a;
}

/// Equal to within what rounding does; infinities are equal.
bool same(double a, double b, double tolerance) { return a == b || std::abs(a - b) < tolerance; }

/// Product of two quadratics.
Quartic product(const Quartic& a, const Quartic& b) {
  Quartic result{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) result[i + j] += a[i] * b[j];
  return result;
}

/// Where a function whose values at a < b < c have one sign, b's the least, has the other sign
/// between.
struct Turn {
  double at, value;
};

/// By parabolas through three points; nullopt when the turn stays on its side.
template <typename Function>
std::optional<Turn> crossed_turn(const Function& f, double a, double fa, double b, double fb,
                                 double c, double fc) {
  const double sign = fb < 0 ? -1 : 1;
  fa *= sign, fb *= sign, fc *= sign;
  if (!(fb < fa && fb < fc)) return std::nullopt;
  for (int i = 0; i < 8; ++i) {
    const double p = (b - a) * (fb - fc), q = (b - c) * (fb - fa);
    const double lowest = b - ((b - a) * p - (b - c) * q) / (2 * (p - q));
    if (!(lowest > a && lowest < c) || std::abs(lowest - b) < 1e-9 * (c - a)) return std::nullopt;
    const double value = f(lowest), here = sign * value;
    if (here < 0) return Turn{lowest, value};
    if (here < fb) {
      (lowest < b ? c : a) = b;
      (lowest < b ? fc : fa) = fb;
      b = lowest;
      fb = here;
    } else {
      (lowest < b ? a : c) = lowest;
      (lowest < b ? fa : fc) = here;
    }
  }
  return std::nullopt;
}

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
      const bool along = joint.cone_axis.dot(leg.platform_point - leg.base_point) >= 0;
      const Vector3 axis = along ? joint.cone_axis : Vector3(-joint.cone_axis);
      rod.cones.push_back(
          {limits_++, on_platform ? rotation * axis : axis, std::cos(std::min(M_PI, *joint.cone))});
    }
    if (crank && !rod.cones.empty()) return false;
    if (&leg == &first) {
      drives_[leg.drive] = rod;
    } else {
      // A second rod of a carriage must be the parallel of the first, else what both ask is an
      // equation.
      const Vector3 apart = rotation * (leg.platform_point - first.platform_point) -
                            (leg.base_point - first.base_point);
      if (leg.kind != first.kind || std::abs(leg.length - first.length) > kSame ||
          leg.side != first.side || apart.norm() > kSame)
        return false;
    }
    rods_.push_back(std::move(rod));
  }
  return true;
}

bool LineLimits::add_planes(const Machine& machine, const std::vector<std::string>& ignored,
                            const Eigen::Quaterniond& rotation) {
  const Mechanism& mechanism = machine.model.mechanism;
  for (const HalfSpaceLimit& limit : mechanism.limits) {
    if (is_ignored(limit.name, ignored)) continue;
    const int leg = carriage_leg(mechanism, *machine.legs, limit.body);
    for (const HalfSpaceLimit::Plane& plane : limit.planes)
      for (const Vector3& point : limit.points) {
        if (limit.body == mechanism.platform) {
          const Vector3 at = mechanism.tool + rotation * (point - mechanism.tool);
          planes_.push_back({plane.normal, plane.offset - plane.normal.dot(at), limits_++});
          continue;
        }
        const double left = plane.offset - plane.normal.dot(point);
        if (leg < 0) {
          if (left < 0) return false;
          continue;
        }
        // A plane before a carriage is an end of its stroke.
        const int drive = machine.legs->legs[leg].drive;
        const double slope = plane.normal.dot(machine.legs->legs[leg].direction);
        for (Rod& rod : rods_) {
          if (rod.drive != drive) continue;
          if (slope > 0) rod.max = std::min(rod.max, left / slope);
          if (slope < 0) rod.min = std::max(rod.min, left / slope);
          if (slope == 0 && left < 0) return false;
        }
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

LineLimits::Solved LineLimits::solve(const Rod& rod, const Vector3& place) {
  const Vector3 v = rod.shift + place;
  Solved solved;
  if (rod.kind == Leg::Kind::strut) {
    const double distance = v.norm();
    return {distance > 0, distance - rod.length, v};
  }
  if (rod.kind == Leg::Kind::guide_rod) {
    const double along = v.dot(rod.direction);
    const Vector3 across = v - along * rod.direction;
    const double left = rod.length * rod.length - across.squaredNorm();
    const double rise = rod.side * std::sqrt(std::max(0.0, left));
    return {left >= 0, along + rise, across - rise * rod.direction};
  }
  // |v - crank(θ)| = L is a cos θ + b sin θ = c, all times the radius.
  const double a = v.dot(rod.outward), b = v.dot(rod.onward);
  const double c = (v.squaredNorm() + rod.radius * rod.radius - rod.length * rod.length) / 2;
  const double square = a * a + b * b, left = square - c * c;
  const double s = rod.side * std::sqrt(std::max(0.0, left));
  const double cosine = (a * c - b * s) / square, sine = (b * c + a * s) / square;
  return {left >= 0, std::atan2(sine, cosine), v - cosine * rod.outward - sine * rod.onward};
}

bool LineLimits::within_limits(const Vector3& place) const {
  for (const Plane& plane : planes_)
    if (plane.normal.dot(place) > plane.offset) return false;
  return std::ranges::all_of(rods_, [&](const Rod& rod) {
    const Solved solved = solve(rod, place);
    return solved.reached && solved.place >= rod.min && solved.place <= rod.max &&
           std::ranges::all_of(rod.cones, [&](const Cone& cone) {
             return cone.axis.dot(solved.rod) >= cone.cosine * solved.rod.norm();
           });
  });
}

double LineLimits::determinant(const Vector3& place) const {
  const auto n = static_cast<Eigen::Index>(axes_.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> rows(n, n);
  for (Eigen::Index d = 0; d < n; ++d) {
    const Rod& rod = drives_[d];
    const Vector3 force = solve(rod, place).rod / rod.length;
    const Vector3 moment = rod.arm.cross(force) / scale_;
    for (Eigen::Index k = 0; k < n; ++k)
      rows(d, k) = axes_[k] < 3 ? force[axes_[k]] : moment[axes_[k] - 3];
  }
  return n == 3 ? Eigen::Matrix3d(rows).determinant() : rows.determinant();
}

bool LineLimits::keep_side_of(const Vector3& place) {
  if (drives_.size() != axes_.size()) return false;
  const double at = determinant(place);
  if (!(std::abs(at) > 1e-12)) return false;
  side_ = at > 0 ? 1 : -1;
  return true;
}

bool LineLimits::inside(const Vector3& place) const {
  return within_limits(place) && (side_ == 0 || side_ * determinant(place) > 0);
}

template <typename Add>
void LineLimits::crossings(const Rod& rod, const Vector3& start, const Add& add) const {
  const Vector3 v = rod.shift + start, way = frame_.col(2);
  const Quartic square = squared(v, way);
  const double length = rod.length * rod.length;
  if (rod.kind == Leg::Kind::strut) {
    for (const bool top : {false, true}) {
      const double reach = rod.length + (top ? rod.max : rod.min);
      if (reach > 0 && std::isfinite(reach))
        add(minus(square, {reach * reach}), rod.reach + (top ? 2 : 1));
    }
    for (const Cone& cone : rod.cones)
      add(minus(squared(cone.axis.dot(v), cone.axis.dot(way)), square, cone.cosine * cone.cosine),
          cone.limit);
    return;
  }
  const auto ball = [&](const Vector3& centre, int limit) {
    add(minus(squared(v - centre, way), {length}), limit);
  };
  if (rod.kind == Leg::Kind::guide_rod) {
    const Vector3& g = rod.direction;
    // L² - |across|², whose root is the rise of the rod.
    const Quartic left = minus(minus(squared(v.dot(g), way.dot(g)), square), {-length});
    add(left, rod.reach);
    if (std::isfinite(rod.min)) ball(rod.min * g, rod.reach + 1);
    if (std::isfinite(rod.max)) ball(rod.max * g, rod.reach + 2);
    for (const Cone& cone : rod.cones) {
      const double lean = cone.axis.dot(g);
      const Vector3 flat = cone.axis - lean * g;
      add(minus(squared(flat.dot(v) - cone.cosine * rod.length, flat.dot(way)), left, lean * lean),
          cone.limit);
    }
    return;
  }
  const auto at = [&](double angle) -> Vector3 {
    return std::cos(angle) * rod.outward + std::sin(angle) * rod.onward;
  };
  if (rod.min > -M_PI) ball(at(rod.min), rod.reach + 1);
  if (rod.max < M_PI) ball(at(rod.max), rod.reach + 2);
  Quartic c = minus(square, {length - rod.radius * rod.radius});
  for (double& each : c) each /= 2;
  const Quartic a = squared(v.dot(rod.outward), way.dot(rod.outward)),
                b = squared(v.dot(rod.onward), way.dot(rod.onward));
  add(minus(minus(product(c, c), a), b), rod.reach);
}

void LineLimits::spans(double x, double y, std::vector<Span>& result) const {
  struct Mark {
    double at;
    int limit;
  };
  thread_local std::vector<Mark> marks;
  marks.clear();
  result.clear();
  const Vector3 way = frame_.col(2), start = frame_.col(0) * x + frame_.col(1) * y;
  double low = extent_.lower.z(), high = extent_.upper.z();
  int first = 0, last = 0;
  for (const Plane& plane : planes_) {
    const double slope = plane.normal.dot(way), left = plane.offset - plane.normal.dot(start);
    const double at = left / slope;
    if (slope > 0 && at < high) {
      high = at;
      last = plane.limit;
    } else if (slope < 0 && at > low) {
      low = at;
      first = plane.limit;
    } else if (slope == 0 && left < 0) {
      return;
    }
  }
  if (!(high - low > kTouch * size_)) return;
  marks.push_back({low, first});
  marks.push_back({high, last});
  for (const Rod& rod : rods_)
    crossings(rod, start, [&](const Quartic& polynomial, int limit) {
      const Roots roots = real_roots(polynomial, low, high);
      for (int i = 0; i < roots.count; ++i) marks.push_back({roots.at[i], limit});
    });
  std::ranges::sort(marks, {}, &Mark::at);
  for (std::size_t i = 0; i + 1 < marks.size();) {
    // Ends that meet count as the one of the lowest number.
    std::size_t j = i + 1;
    Mark from = marks[i];
    while (j < marks.size() && marks[j].at - from.at < kTouch * size_)
      from.limit = std::min(from.limit, marks[j++].limit);
    if (j == marks.size()) break;
    Mark to = marks[j];
    for (std::size_t k = j + 1; k < marks.size() && marks[k].at - to.at < kTouch * size_; ++k)
      to.limit = std::min(to.limit, marks[k].limit);
    if (within_limits(start + (from.at + to.at) / 2 * way)) {
      if (!result.empty() && result.back().to == from.at)
        result.back() = {result.back().from, to.at, result.back().first, to.limit};
      else
        result.push_back({from.at, to.at, from.limit, to.limit});
    }
    i = j;
  }
  if (side_ != 0) cut_at_singularities(start, result);
}

void LineLimits::cut_at_singularities(const Vector3& start, std::vector<Span>& spans) const {
  const Vector3 way = frame_.col(2);
  const auto at = [&](double z) { return side_ * determinant(start + z * way); };
  thread_local std::vector<Span> kept;
  kept.clear();
  for (const Span& span : spans) {
    // Closer at the ends, where the rise of a rod may go with the root of the distance.
    constexpr int kSamples = 16;
    const auto place = [&](double i) {
      return span.from + (span.to - span.from) * (1 - std::cos(M_PI * i / kSamples)) / 2;
    };
    std::array<double, kSamples + 1> z, f;
    for (int i = 0; i <= kSamples; ++i) f[i] = at(z[i] = place(i));
    std::array<double, 2 * kSamples> roots;
    int count = 0;
    for (int i = 0; i < kSamples; ++i) {
      if ((f[i] < 0) != (f[i + 1] < 0)) {
        roots[count++] = zero_between(at, z[i], z[i + 1], f[i], f[i + 1]);
        continue;
      }
      if (i == 0 || (f[i - 1] < 0) != (f[i] < 0)) continue;
      // A turn towards zero between samples of one sign may cross it twice.
      const auto turn = crossed_turn(at, z[i - 1], f[i - 1], z[i], f[i], z[i + 1], f[i + 1]);
      if (!turn) continue;
      roots[count++] = zero_between(at, z[i - 1], turn->at, f[i - 1], turn->value);
      roots[count++] = zero_between(at, turn->at, z[i + 1], turn->value, f[i + 1]);
    }
    std::sort(roots.begin(), roots.begin() + count);
    double from = span.from;
    int first = span.first;
    for (int i = 0; i <= count; ++i) {
      const double to = i < count ? roots[i] : span.to;
      if (to - from > kTouch * size_ && at((from + to) / 2) > 0)
        kept.push_back({from, to, first, i < count ? kSingular : span.last});
      from = to;
      first = kSingular;
    }
  }
  spans.swap(kept);
}

}  // namespace polyglide
