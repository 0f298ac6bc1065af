// Limits of a leg machine that does not turn, as quadrics of the place. What limits say of a
// rod's rise or length is a square root compared with something linear, which is squared away.
#include "kinematics/leg_bounds.hpp"

namespace polyglide {
namespace {

Affine affine(const IntervalVector& normal, const IntervalVector& from) {
  return {dot(normal, from), normal};
}

Affine operator*(const Interval& factor, const Affine& a) {
  return {factor * a.constant, {factor * a.linear[0], factor * a.linear[1], factor * a.linear[2]}};
}

Affine operator-(const Affine& a, const Affine& b) {
  return {a.constant - b.constant,
          {a.linear[0] - b.linear[0], a.linear[1] - b.linear[1], a.linear[2] - b.linear[2]}};
}

Affine constant(const Interval& value) { return {value, {0.0, 0.0, 0.0}}; }

/// √radicand <= t: t is not negative and its square not less.
void add_at_most(std::vector<QuadricLimit>& limits, const Quadric& radicand, const Affine& t) {
  append(limits, {as_quadric(Interval(-1.0) * t), {}});
  append(limits, {radicand - square(t), {}});
}

/// √radicand >= t: t is not positive or its square not greater.
void add_at_least(std::vector<QuadricLimit>& limits, const Quadric& radicand, const Affine& t) {
  append(limits, {square(t) - radicand, as_quadric(t)});
}

/// √radicand · factor <= t.
/// @param most of the root
void add_times(std::vector<QuadricLimit>& limits, const Quadric& radicand, const Interval& factor,
               const Affine& t, const Interval& most) {
  if (factor.lower() > 0)
    add_at_most(limits, square(factor) * radicand, t);
  else if (factor.upper() < 0)
    add_at_least(limits, square(factor) * radicand, Interval(-1.0) * t);
  else
    append(limits, {as_quadric(constant(factor * Interval(0.0, most.upper())) - t), {}});
}

/// A guide's rod, or a strut, in a machine that does not turn.
struct StillRod {
  IntervalVector from;  ///< from its joint on the base at home to that on the platform, at home
  Interval length;
  bool strut;
  double side;
  Affine along;  ///< part of the rod along the guide
  Quadric left;  ///< square of the rise: L² - |across|²; of a strut, of its length
};

StillRod rod_of(const Leg& leg, const IntervalVector& from, const Interval& length) {
  StillRod rod{from,     length,        leg.kind == Leg::Kind::strut,
               leg.side, constant(0.0), squared_distance(from)};
  if (rod.strut) return rod;
  const IntervalVector g = vector_of(leg.direction);
  rod.along = affine(g, from);
  // |v - (v·g) g|² = |v|² - (2 - |g|²)(v·g)², which is never negative, though |g| be 1 but nearly.
  Quadric across = rod.left - (2.0 - squared_norm(g)) * square(rod.along);
  across.bend = 1;
  rod.left = as_quadric(constant(square(length))) - across;
  rod.left.bend = -1;
  return rod;
}

/// The drive's place <= end, or >= end.
void add_end(std::vector<QuadricLimit>& limits, const StillRod& rod, bool most,
             const Interval& end) {
  // A strut's length against the end's, or side·rise against what is left to the end.
  const Affine t =
      rod.strut ? constant(end + rod.length) : Interval(rod.side) * (constant(end) - rod.along);
  if (most == (rod.strut || rod.side > 0))
    add_at_most(limits, rod.left, t);
  else
    add_at_least(limits, rod.left, t);
}

}  // namespace

std::vector<QuadricLimit> LegBounds::quadrics(Mask& rest) const {
  std::vector<QuadricLimit> limits;
  rest.reset();
  PoseBox home;
  home.fill(Interval(0.0));
  const IntervalRotation rotation = turn(home).rotation;
  const auto still = [&](const Row& row) {
    const IntervalVector arm = turned(rotation, row.arm);
    return rod_of(row.leg, {arm[0] - row.base[0], arm[1] - row.base[1], arm[2] - row.base[2]},
                  row.length);
  };
  for (const Row& row : rows_) {
    if (row.leg.kind == Leg::Kind::crank_rod) {
      // Of higher degree: a torus about the crank's circle, ends of its angle.
      rest.set(row.reach);
      for (const std::size_t end : {row.min, row.max})
        if (end < kMost) rest.set(end);
      for (const Cone& cone : row.cones) rest.set(cone.limit);
      continue;
    }
    const StillRod rod = still(row);
    if (!rod.strut) append(limits, {Interval(-1.0) * rod.left, {}});
    if (row.min < kMost) add_end(limits, rod, false, row.leg.stroke.min - Interval(kSlack));
    if (row.max < kMost) add_end(limits, rod, true, row.leg.stroke.max + Interval(kSlack));
    for (const Cone& cone : row.cones) {
      IntervalVector axis = vector_of(cone.axis);
      if (cone.on_platform) axis = turned(rotation, axis);
      // cos·L <= axis·(v - place·g), place = along + side·rise; of a strut cos·|v| <= axis·v.
      const Interval lean = dot(axis, row.leg.direction);
      const Affine height = affine(axis, rod.from);
      if (rod.strut && zero_in(cone.cosine))
        rest.set(cone.limit);
      else if (rod.strut)
        add_times(limits, rod.left, cone.cosine, height, Interval(0.0));
      else
        add_times(limits, rod.left, rod.side * lean,
                  height - lean * rod.along - constant(cone.cosine * row.length), row.length);
    }
  }
  for (const Plane& plane : planes_) {
    if (plane.on_platform) {
      Affine height = affine(vector_of(plane.normal), turned(rotation, vector_of(plane.arm)));
      height.constant -= plane.offset;
      append(limits, {as_quadric(height), {}});
    } else if (plane.drive < 0 || magnitude(plane.slope) == 0) {
      append(limits, {as_quadric(constant(-plane.offset)), {}});
    } else if (zero_in(plane.slope)) {
      rest.set(plane.limit);
    } else {
      // A plane before a carriage is an end of its stroke.
      for (const Row& row : rows_)
        if (row.primary && row.leg.drive == plane.drive)
          add_end(limits, still(row), plane.slope.lower() > 0, plane.offset / plane.slope);
    }
  }
  for (const Clearance& pair : clearances_) rest.set(pair.limit);
  return limits;
}

}  // namespace polyglide
