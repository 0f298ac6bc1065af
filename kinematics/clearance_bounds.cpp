// Clearances on boxes of poses. Two pieces are at least as far apart as a plane between them
// tells, and at most as two of their points: both are smooth in the pose, and in the middle of the
// box, where plane and points are chosen, both are the distance itself.
#include "kinematics/clearance.hpp"
#include "kinematics/leg_bounds.hpp"
#include "kinematics/limits.hpp"
#include "kinematics/piece_distance.hpp"

namespace polyglide {
namespace {

using Piece = pieces::Piece<double>;

/// Weights of the corners that give the nearest points of two pieces, to rounding.
struct Nearest {
  double square = pieces::kFar;
  std::array<double, 3> a{1, 0, 0}, b{1, 0, 0};
};

void look_at_edges(const Piece& a, const Piece& b, Nearest& best) {
  for (int i = 0; i < a.edges(); ++i)
    for (int k = 0; k < b.edges(); ++k) {
      const double square = pieces::squared_distance(a.from(i), a.to(i), b.from(k), b.to(k));
      if (square >= best.square) continue;
      double along = 0, onto = 0;
      pieces::nearest_parts(a.from(i), a.to(i), b.from(k), b.to(k), along, onto);
      best = {square, {0, 0, 0}, {0, 0, 0}};
      best.a[i] += 1 - along;
      best.a[(i + 1) % a.corners] += along;
      best.b[k] += 1 - onto;
      best.b[(k + 1) % b.corners] += onto;
    }
}

/// Corners of `b` above the triangle `a`.
void look_at_inside(const Piece& a, const Piece& b, Nearest& best, bool swapped) {
  if (a.corners != 3) return;
  const auto u = a.corner[1] - a.corner[0], v = a.corner[2] - a.corner[0];
  const auto n = pieces::cross(u, v);
  for (int k = 0; k < b.corners; ++k) {
    const double square = pieces::squared_height(b.corner[k], a);
    if (square >= best.square) continue;
    const auto w = b.corner[k] - a.corner[0];
    const double scale = 1 / pieces::dot(n, n);
    const double second = pieces::dot(pieces::cross(w, v), n) * scale,
                 third = pieces::dot(pieces::cross(u, w), n) * scale;
    std::array<double, 3> inside{1 - second - third, second, third}, corner{};
    corner[k] = 1;
    best = swapped ? Nearest{square, corner, inside} : Nearest{square, inside, corner};
  }
}

Nearest nearest(const Piece& a, const Piece& b) {
  Nearest best;
  look_at_edges(a, b, best);
  look_at_inside(a, b, best, false);
  look_at_inside(b, a, best, true);
  return best;
}

double infinity() { return std::numeric_limits<double>::infinity(); }

/// The common hull.
Interval joined(const Interval& a, const Interval& b) {
  return {std::min(a.lower(), b.lower()), std::max(a.upper(), b.upper())};
}

}  // namespace

/// Where a corner is, and how it changes with each coordinate of the box.
struct LegBounds::Moved {
  IntervalVector at;
  std::array<IntervalVector, 6> by;
};

bool LegBounds::add_clearances(const Machine& machine, const std::vector<std::string>& ignored) {
  const Mechanism& mechanism = machine.model.mechanism;
  const auto pieces_of = [&](const BodyShape& shape) {
    std::vector<std::vector<LegPlace>> result;
    for (const clearance::PieceData& part : cut(shape)) {
      std::vector<LegPlace>& corners = result.emplace_back();
      for (int k = 0; k < part.corners; ++k)
        corners.push_back(*leg_place(mechanism, *machine.legs, shape.points[part.corner[k]]));
    }
    return result;
  };
  for (const WatchedPair& pair : watched_pairs(mechanism, ignored)) {
    const BodyShape &a = mechanism.shapes[pair.shapes[0]], &b = mechanism.shapes[pair.shapes[1]];
    if (a.form == BodyShape::Form::mesh || b.form == BodyShape::Form::mesh) return false;
    for (const auto& one : pieces_of(a))
      for (const auto& other : pieces_of(b))
        clearances_.push_back({add(pair.name), Interval(pair.apart) - kClearanceSlack, one, other});
  }
  return true;
}

LegBounds::Place LegBounds::place(const PoseBox& box) const {
  Place result{box, turn(box), std::vector<Drive>(drives_)};
  for (const Row& row : rows_)
    if (row.primary) result.drives[row.leg.drive] = solve(row, box, result.turning, {}, nullptr);
  return result;
}

LegBounds::Moved LegBounds::move(const LegPlace& corner, const Place& now) const {
  using Kind = LegPlace::Kind;
  Moved moved;
  moved.at = vector_of(corner.at);
  for (auto& column : moved.by) column.fill(Interval(0.0));
  if (corner.kind == Kind::fixed) return moved;
  if (corner.kind == Kind::platform) {
    IntervalVector arm;
    for (int i = 0; i < 3; ++i) arm[i] = Interval(corner.at[i]) - tool_[i];
    arm = turned(now.turning.rotation, arm);
    for (int i = 0; i < 3; ++i) {
      moved.at[i] = Interval(tool_[i]) + arm[i] + now.box[i];
      moved.by[i][i] = Interval(1.0);
      if (now.turning.varies[i]) moved.by[3 + i] = cross(now.turning.axes[i], arm);
    }
    return moved;
  }
  const Leg& leg = legs_[corner.leg];
  if (corner.kind == Kind::carriage || corner.kind == Kind::crank) {
    const Drive& drive = now.drives[leg.drive];
    IntervalVector speed = vector_of(leg.direction);
    if (corner.kind == Kind::carriage) {
      for (int i = 0; i < 3; ++i) moved.at[i] += speed[i] * drive.place;
    } else {
      const IntervalVector arm = turned(drive.turn, difference(moved.at, vector_of(leg.centre)));
      for (int i = 0; i < 3; ++i) moved.at[i] = leg.centre[i] + arm[i];
      speed = cross(leg.direction, arm);
    }
    for (int k = 0; k < 6; ++k) {
      Interval rate = k < 3 ? drive.row[k] : Interval(0.0);
      if (k >= 3 && now.turning.varies[k - 3])
        rate = dot(drive.row, cross(now.turning.axes[k - 3], drive.arm));
      for (int i = 0; i < 3; ++i) moved.by[k][i] = speed[i] * rate;
    }
    return moved;
  }
  const bool strut = leg.kind == Leg::Kind::strut;
  const Kind carrier = strut                              ? Kind::fixed
                       : leg.kind == Leg::Kind::crank_rod ? Kind::crank
                                                          : Kind::carriage;
  const Moved base = move({carrier, leg.base_point, corner.leg, 0}, now);
  const Moved top = move({Kind::platform, leg.platform_point, -1, 0}, now);
  IntervalVector way;
  for (int i = 0; i < 3; ++i) way[i] = top.at[i] - base.at[i];
  const Interval length = root(squared_norm(way));
  const Moved& from = corner.kind == Kind::upper ? top : base;
  for (int i = 0; i < 3; ++i) {
    moved.at[i] = from.at[i] + (strut ? corner.part / length : Interval(corner.part)) * way[i];
    if (strut) way[i] = common(way[i] / length, Interval(-1, 1));
  }
  for (int k = 0; k < 6; ++k) {
    IntervalVector swing;
    for (int i = 0; i < 3; ++i) swing[i] = top.by[k][i] - base.by[k][i];
    const Interval stretch = strut ? dot(way, swing) : Interval(0.0);
    for (int i = 0; i < 3; ++i) {
      // A part of fixed length along the strut only turns.
      const Interval rate = strut ? (swing[i] - way[i] * stretch) / length : swing[i];
      moved.by[k][i] = from.by[k][i] + corner.part * rate;
    }
  }
  return moved;
}

/// The pair on a box; the value without regard to the gradient.
LimitBound LegBounds::enclose_pair(const Clearance& pair, const Place& whole,
                                   const Place& centre) const {
  LimitBound bound;
  const auto all = [&](const std::vector<LegPlace>& places, std::vector<Moved>& moved) {
    Piece piece;
    piece.corners = static_cast<int>(places.size());
    for (int k = 0; k < piece.corners; ++k) {
      moved.push_back(move(places[k], whole));
      const Moved there = move(places[k], centre);
      piece.corner[k] = {middle(there.at[0]), middle(there.at[1]), middle(there.at[2])};
    }
    return piece;
  };
  std::vector<Moved> a, b;
  const Piece first = all(pair.a, a), second = all(pair.b, b);
  const bool meet = pieces::squared_distance(first, second) <= 0;
  const Nearest near = nearest(first, second);

  // Upper bound of the distance: two points of the pieces, as the first corner and ways from it.
  const auto point = [](const std::vector<Moved>& corners, const std::array<double, 3>& weights) {
    Moved sum = corners[0];
    double rest = 1;
    for (std::size_t c = 1; c < corners.size(); ++c) {
      const double weight = std::clamp(weights[c], 0.0, std::max(0.0, std::nextafter(rest, 0)));
      rest -= weight;
      for (int i = 0; i < 3; ++i) {
        sum.at[i] += weight * (corners[c].at[i] - corners[0].at[i]);
        for (int k = 0; k < 6; ++k)
          sum.by[k][i] += weight * (corners[c].by[k][i] - corners[0].by[k][i]);
      }
    }
    return sum;
  };
  const Moved from = point(a, near.a), to = point(b, near.b);
  IntervalVector gap, way;
  gap = difference(to.at, from.at);
  const Interval most = root(squared_norm(gap));
  for (int i = 0; i < 3; ++i)
    way[i] = most.lower() > 0 ? common(gap[i] / most, Interval(-1, 1)) : Interval(-1, 1);
  for (int k = 0; k < 6; ++k) bound.gradient[k] = -dot(way, difference(to.by[k], from.by[k]));

  // Lower bound: a plane between them, across the gap in the middle of the box.
  Vector3 normal = Vector3::Zero();
  if (!meet)
    for (int i = 0; i < 3; ++i) {
      double from_there = 0, to_there = 0;
      const auto coordinate = [i](const pieces::Point<double>& p) {
        return i == 0 ? p.x : i == 1 ? p.y : p.z;
      };
      for (int k = 0; k < first.corners; ++k) from_there += near.a[k] * coordinate(first.corner[k]);
      for (int k = 0; k < second.corners; ++k) to_there += near.b[k] * coordinate(second.corner[k]);
      normal[i] = to_there - from_there;
    }
  const Interval norm = root(dot(normal, normal));
  double least = 0;
  if (norm.lower() > 0) {
    std::vector<Interval> heights;
    double nearest_at_most = infinity();
    for (const Moved& one : a)
      for (const Moved& other : b) {
        heights.push_back(dot(normal, difference(other.at, one.at)) / norm);
        nearest_at_most = std::min(nearest_at_most, heights.back().upper());
      }
    least = infinity();
    for (std::size_t i = 0; i < heights.size(); ++i) {
      least = std::min(least, heights[i].lower());
      // Corners that are never the nearest ones to the plane do not tell how the limit changes.
      if (heights[i].lower() > nearest_at_most) continue;
      const Moved &one = a[i / b.size()], &other = b[i % b.size()];
      for (int k = 0; k < 6; ++k)
        bound.gradient[k] =
            joined(bound.gradient[k], -(dot(normal, difference(other.by[k], one.by[k])) / norm));
    }
  }
  bound.value = pair.apart - Interval(std::min(least, most.upper()), most.upper());
  // No plane says more than that a distance is not negative: that does not change with the pose.
  if (!(norm.lower() > 0))
    for (Interval& gradient : bound.gradient) gradient = joined(gradient, Interval(0.0));
  return bound;
}

void LegBounds::enclose_clearances(const PoseBox& box, const Mask& wanted,
                                   std::vector<LimitBound>& bounds) const {
  if (std::none_of(clearances_.begin(), clearances_.end(),
                   [&](const Clearance& pair) { return wanted[pair.limit]; }))
    return;
  const Place whole = place(box), centre = place(middle_of(box));
  const bool smooth = std::all_of(whole.drives.begin(), whole.drives.end(), [](const Drive& drive) {
    return std::all_of(drive.row.begin(), drive.row.end(),
                       [](const Interval& rate) { return magnitude(rate) < infinity(); });
  });
  for (const Clearance& pair : clearances_) {
    if (!wanted[pair.limit]) continue;
    bounds[pair.limit] = enclose_pair(pair, whole, centre);
    if (!smooth) bounds[pair.limit].gradient.fill(Interval(-infinity(), infinity()));
  }
}

}  // namespace polyglide
