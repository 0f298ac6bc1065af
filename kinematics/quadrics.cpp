#include "kinematics/quadrics.hpp"

namespace polyglide {
namespace {

Interval hull(const Interval& a, const Interval& b) {
  return {std::min(a.lower(), b.lower()), std::max(a.upper(), b.upper())};
}

/// Calls visit(coefficient of a, the same of b) for all.
template <typename A, typename B, typename Visit>
void for_coefficients(A& a, B& b, const Visit& visit) {
  visit(a.constant, b.constant);
  for (int k = 0; k < 3; ++k) {
    visit(a.linear[k], b.linear[k]);
    visit(a.square[k], b.square[k]);
    visit(a.mixed[k], b.mixed[k]);
  }
}

bool same_but_for_rounding(const Quadric& a, const Quadric& b) {
  constexpr double kRounding = 1e-13;
  bool same = a.bend == b.bend;
  for_coefficients(a, b, [&](const Interval& x, const Interval& y) {
    same = same && std::abs(middle(x) - middle(y)) <= kRounding * (1 + magnitude(x));
  });
  return same;
}

void widen(Quadric& a, const Quadric& b) {
  for_coefficients(a, b, [](Interval& x, const Interval& y) { x = hull(x, y); });
}

}  // namespace

Quadric square(const Affine& a) {
  Quadric result;
  result.constant = square(a.constant);
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    result.linear[k] = 2.0 * a.constant * a.linear[k];
    result.square[k] = square(a.linear[k]);
    result.mixed[k] = 2.0 * a.linear[i] * a.linear[j];
  }
  result.bend = 1;
  return result;
}

Quadric operator+(const Quadric& a, const Quadric& b) {
  Quadric result = a;
  for_coefficients(result, b, [](Interval& x, const Interval& y) { x += y; });
  result.bend = a.bend == b.bend ? a.bend : 0;
  return result;
}

Quadric operator-(const Quadric& a, const Quadric& b) { return a + Interval(-1.0) * b; }

Quadric operator*(const Interval& factor, const Quadric& a) {
  Quadric result = a;
  for_coefficients(result, a, [&](Interval& x, const Interval& y) { x = factor * y; });
  result.bend = factor.lower() >= 0 ? a.bend : factor.upper() <= 0 ? -a.bend : 0;
  return result;
}

Quadric as_quadric(const Affine& a) {
  Quadric result;
  result.constant = a.constant;
  result.linear = a.linear;
  result.square.fill(Interval(0.0));
  result.mixed.fill(Interval(0.0));
  result.bend = 1;
  return result;
}

Quadric squared_distance(const IntervalVector& from) {
  Quadric result = as_quadric({squared_norm(from), {2.0 * from[0], 2.0 * from[1], 2.0 * from[2]}});
  result.square.fill(Interval(1.0));
  return result;
}

PlaneBound enclose(const Quadric& quadric, const Cuboid& cuboid) {
  const auto& m = cuboid.middle;
  const auto& half = cuboid.half;
  PlaneBound bound{quadric.constant, {}};
  Interval bend(0.0), tilt(0.0);
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Interval squares = quadric.square[k] * m[k];
    const Interval slope =
        quadric.linear[k] + 2.0 * squares + quadric.mixed[j] * m[i] + quadric.mixed[i] * m[j];
    bound.at += m[k] * (quadric.linear[k] + squares) + quadric.mixed[k] * m[i] * m[j];
    bound.slope[k] = middle(slope);
    tilt += radius(slope) * Interval(half[k]);
    bend += quadric.square[k] * Interval(0.0, (Interval(half[k]) * half[k]).upper()) +
            quadric.mixed[k] * Interval(half[i]) * half[j] * Interval(-1, 1);
  }
  if (quadric.bend > 0) bend = Interval(std::max(0.0, bend.lower()), bend.upper());
  if (quadric.bend < 0) bend = Interval(bend.lower(), std::min(0.0, bend.upper()));
  bound.at += bend + Interval(-1, 1) * tilt;
  return bound;
}

PlaneCut cut_of(const Cuboid& cuboid, const QuadricLimit& limit) {
  const PlaneCut value = cut_of(cuboid, enclose(limit.value, cuboid));
  if (!limit.unless || value.holds()) return value;
  const PlaneCut unless = cut_of(cuboid, enclose(*limit.unless, cuboid));
  if (unless.fails()) return value;
  if (unless.holds() || value.fails()) return unless;
  const bool first = value.part.lower() >= unless.part.lower();
  PlaneCut either = first ? value : unless;
  either.part = Interval(either.part.lower(), std::min(1.0, (value.part + unless.part).upper()));
  return either;
}

void append(std::vector<QuadricLimit>& limits, const QuadricLimit& limit) {
  for (QuadricLimit& other : limits) {
    if (other.unless.has_value() != limit.unless.has_value() ||
        !same_but_for_rounding(other.value, limit.value) ||
        (limit.unless && !same_but_for_rounding(*other.unless, *limit.unless)))
      continue;
    widen(other.value, limit.value);
    if (limit.unless) widen(*other.unless, *limit.unless);
    return;
  }
  limits.push_back(limit);
}

}  // namespace polyglide
