// Rods and struts solved for their drives, on boxes of poses.
#include "kinematics/leg_bounds.hpp"

namespace polyglide {
namespace {

const IntervalVector kAnyVector{kAnything, kAnything, kAnything};
constexpr double kBelowHalfTurn = 3.14;  // angles nearer to it may be on either side of the jump

}  // namespace

LegBounds::Turned LegBounds::turn(const PoseBox& box) const {
  const bool as_at_home = fixed_.vec().isZero(0);
  const IntervalRotation fixed = as_at_home ? no_rotation() : rotation_of(fixed_);
  Turned result;
  bool turns = false;
  for (int i = 0; i < 3; ++i) {
    result.varies[i] = magnitude(box[3 + i]) > 0;
    turns = turns || result.varies[i];
  }
  if (!turns) {
    result.rotation = fixed;  // and the axes, about which nothing turns, are not asked
    return result;
  }
  const TurnByAngles turn = turn_by({box[3], box[4], box[5]});
  result.axes = turn.axes;
  result.rotation = product(turn.rotation, fixed);
  return result;
}

LegBounds::Drive LegBounds::drive_of_guide(const Row& row, const IntervalVector& v) {
  Drive drive;
  const IntervalVector g = vector_of(row.leg.direction);
  const Interval along = dot(v, g);
  const IntervalVector across = difference(v, scaled(g, along));
  const Interval left = square(row.length) - squared_norm(across);
  const Interval rise = row.leg.side * root(left);
  drive.reach = -left;
  drive.reach_row = scaled(across, 2.0);
  drive.smooth = left.lower() > 0;
  drive.place = along + rise;
  drive.speed = g;
  drive.rod = difference(across, scaled(g, rise));
  drive.along = scaled(drive.rod, -row.leg.side / row.length);
  drive.row = drive.smooth ? difference(drive.speed, scaled(across, 1.0 / rise)) : kAnyVector;
  return drive;
}

LegBounds::Drive LegBounds::drive_of_strut(const Row& row, const IntervalVector& v) {
  Drive drive;
  const Interval distance = root(squared_norm(v));
  drive.reach = -distance;
  drive.reach_row = kAnyVector;
  drive.smooth = distance.lower() > 0;
  drive.place = distance - row.length;
  drive.rod = v;
  drive.along = scaled(v, 1.0 / row.length);
  drive.row = kAnyVector;
  if (drive.smooth)
    for (int i = 0; i < 3; ++i) drive.row[i] = common(v[i] / distance, Interval(-1, 1));
  return drive;
}

/// With A, B the parts of v outward and onward and C = (|v|² + r² - L²)/2r, the arm at the angle θ
/// holds the rod's end where A cos θ + B sin θ = C; with S = side·√(A² + B² - C²) there is
/// (cos θ, sin θ) = (A C - B S, B C + A S)/(A² + B²).
LegBounds::Drive LegBounds::crank_at(const Row& row, const IntervalVector& v,
                                     const CrankKnown& known) {
  Drive drive;
  const Interval a = dot(v, row.outward), b = dot(v, row.onward);
  const Interval c =
      (squared_norm(v) + square(row.radius) - square(row.length)) / (2.0 * row.radius);
  const Interval around = square(a) + square(b);
  const Interval left = common(known.left, around - square(c));
  const Interval s = row.leg.side * root(left);
  drive.reach = -left;
  for (int i = 0; i < 3; ++i)
    drive.reach_row[i] = 2.0 * (c * v[i] / row.radius - a * row.outward[i] - b * row.onward[i]);
  drive.smooth = left.lower() > 0 && around.lower() > 0;
  Interval cosine = known.cosine, sine = known.sine;
  if (around.lower() > 0) {
    cosine = common(cosine, (a * c - b * s) / around);
    sine = common(sine, (b * c + a * s) / around);
  }
  drive.place = common(known.place, angle_of(cosine, sine));
  drive.turn = rotation_about(vector_of(row.leg.direction), cosine, sine);
  for (int i = 0; i < 3; ++i) {
    drive.rod[i] = v[i] - row.radius * (cosine * row.outward[i] + sine * row.onward[i]);
    drive.speed[i] = row.radius * (cosine * row.onward[i] - sine * row.outward[i]);
  }
  drive.along = scaled(drive.rod, -row.leg.side / row.length);
  drive.row = drive.smooth ? scaled(drive.rod, 1.0 / (-row.radius * s)) : kAnyVector;
  return drive;
}

/// Twice: A, B, C and S change together with v, of which the formulas know nothing. What angle and
/// radicand are in the middle, and how fast they change, tells them better.
LegBounds::Drive LegBounds::drive_of_crank(const Row& row, const IntervalVector& v) {
  const Drive first = crank_at(row, v, {});
  if (!first.smooth) return first;
  IntervalVector centre, way;
  for (int i = 0; i < 3; ++i) {
    centre[i] = middle(v[i]);
    way[i] = v[i] - centre[i];
  }
  const Drive there = crank_at(row, centre, {});
  CrankKnown known;
  known.left = -(there.reach + dot(first.reach_row, way));
  // The angle jumps at the half turn, where what follows from its rate goes on.
  const Interval place = there.place + dot(first.row, way);
  if (magnitude(place) < kBelowHalfTurn) {
    known.place = place;
    known.cosine = cosine(place);
    known.sine = sine(place);
  }
  return crank_at(row, v, known);
}

/// The end of a crank's stroke as the ball about the rod's end there: tighter than by the angle. On
/// the half turn where C - A cos θ - B sin θ rises (or falls) as at the root, its sign at the end
/// says on which side of the end the root is. Where the end may be on the other half turn the
/// angle gives the sign alone, so that a box and its middle never say two things of one limit.
LegBounds::Ranged LegBounds::crank_end(const Row& row, const IntervalVector& v, const Drive& drive,
                                       const Interval& end, bool most) {
  const double way = most ? 1 : -1;
  const Interval beyond = way * (drive.place - end);
  if (!(magnitude(end) < kBelowHalfTurn)) {
    const bool jumps = !(magnitude(drive.place) < kBelowHalfTurn);
    return {beyond, jumps ? kAnyVector : scaled(drive.row, way)};
  }
  const Interval c = cosine(end), s = sine(end);
  const Interval rate = dot(v, row.onward) * c - dot(v, row.outward) * s;
  if (magnitude(drive.place - end) < kBelowHalfTurn && (row.leg.side * rate).upper() < 0) {
    IntervalVector rod;
    for (int i = 0; i < 3; ++i)
      rod[i] = v[i] - row.radius * (c * row.outward[i] + s * row.onward[i]);
    const double outward = -way * row.leg.side;
    return {outward * (squared_norm(rod) - square(row.length)), scaled(rod, 2 * outward)};
  }
  if (beyond.upper() <= 0) return {Interval(kAnything.lower(), 0), kAnyVector};
  if (beyond.lower() > 0)
    return {Interval(std::numeric_limits<double>::denorm_min(), kAnything.upper()), kAnyVector};
  return {kAnything, kAnyVector};
}

LegBounds::Ranged LegBounds::lean(const Row& row, const Cone& cone, const Drive& drive,
                                  const IntervalVector& axis) {
  if (row.leg.kind == Leg::Kind::strut) {
    const Interval length = drive.place + row.length;
    return {cone.cosine * length - dot(axis, drive.rod),
            difference(scaled(drive.row, cone.cosine), axis)};
  }
  // The rod changes with v, and by -speed with its drive; a crank takes the axis along.
  Interval slope = dot(axis, drive.speed);
  if (row.leg.kind == Leg::Kind::crank_rod && !cone.on_platform)
    slope -= dot(cross(row.leg.direction, axis), drive.rod);
  IntervalVector by_v = kAnyVector;
  if (drive.smooth) by_v = difference(scaled(drive.row, slope), axis);
  return {cone.cosine * row.length - dot(axis, drive.rod), by_v};
}

LegBounds::Drive LegBounds::solve(const Row& row, const PoseBox& box, const Turned& turn,
                                  const Mask& wanted, std::vector<LimitBound>* bounds) const {
  using Kind = Leg::Kind;
  const IntervalVector arm = turned(turn.rotation, row.arm);
  IntervalVector v;
  for (int i = 0; i < 3; ++i) v[i] = arm[i] + box[i] - row.base[i];
  Drive drive = row.leg.kind == Kind::guide_rod ? drive_of_guide(row, v)
                : row.leg.kind == Kind::strut   ? drive_of_strut(row, v)
                                                : drive_of_crank(row, v);
  drive.arm = arm;
  if (bounds != nullptr) bound_limits(row, v, drive, turn, wanted, *bounds);
  return drive;
}

void LegBounds::bound_limits(const Row& row, const IntervalVector& v, const Drive& drive,
                             const Turned& turn, const Mask& wanted,
                             std::vector<LimitBound>& bounds) const {
  using Kind = Leg::Kind;
  std::array<IntervalVector, 3> swing;
  for (int k = 0; k < 3; ++k)
    if (turn.varies[k]) swing[k] = cross(turn.axes[k], drive.arm);
  /// Fills a limit from its value and its derivative by v.
  const auto set = [&](std::size_t limit, const Interval& value, const IntervalVector& by_v) {
    if (limit >= kMost || !wanted[limit]) return;
    LimitBound& bound = bounds[limit];
    bound.value = value;
    for (int i = 0; i < 3; ++i) bound.gradient[i] = by_v[i];
    for (int k = 0; k < 3; ++k)
      bound.gradient[3 + k] = turn.varies[k] ? dot(by_v, swing[k]) : Interval(0.0);
  };
  set(row.reach, drive.reach, drive.reach_row);
  for (const bool most : {false, true}) {
    const std::size_t limit = most ? row.max : row.min;
    if (limit >= kMost || !wanted[limit]) continue;
    const double way = most ? 1 : -1;
    const Interval end = (most ? row.leg.stroke.max : row.leg.stroke.min) + Interval(way * kSlack);
    const auto [value, by_v] = row.leg.kind == Kind::crank_rod
                                   ? crank_end(row, v, drive, end, most)
                                   : Ranged{way * (drive.place - end), scaled(drive.row, way)};
    set(limit, value, by_v);
  }
  for (const Cone& cone : row.cones) {
    if (!wanted[cone.limit]) continue;
    IntervalVector axis = vector_of(cone.axis);
    if (cone.on_platform)
      axis = turned(turn.rotation, axis);
    else if (row.leg.kind == Kind::crank_rod)
      axis = turned(drive.turn, axis);
    const auto [value, by_v] = lean(row, cone, drive, axis);
    set(cone.limit, value, by_v);
    if (!cone.on_platform) continue;
    for (int k = 0; k < 3; ++k)
      if (turn.varies[k])
        bounds[cone.limit].gradient[3 + k] -= dot(cross(turn.axes[k], axis), drive.rod);
  }
}

}  // namespace polyglide
