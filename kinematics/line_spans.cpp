#include <algorithm>
#include <cmath>

#include "kinematics/line_limits.hpp"
#include "kinematics/real_roots.hpp"

// Where a line runs inside the limits.
namespace polyglide {
namespace {

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

/// Product of two quadratics.
Quartic product(const Quartic& a, const Quartic& b) {
  Quartic result{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) result[i + j] += a[i] * b[j];
  return result;
}

}  // namespace

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

}  // namespace polyglide
