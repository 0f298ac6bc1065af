#pragma once

#include "kinematics/simd.hpp"

/// Distances of points, segments and triangles in closed form, written once for a number or a
/// register of numbers V, without branches on values of V.
namespace polyglide::pieces {

using simd::max;
using simd::min;
using simd::select;

constexpr double kTiny = 1e-300;  ///< instead of zero as a divisor
constexpr double kFar = 1e300;    ///< no distance found

template <class V>
struct Point {
  V x, y, z;
};
template <class V>
inline Point<V> operator-(const Point<V>& a, const Point<V>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class V>
inline V dot(const Point<V>& a, const Point<V>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class V>
inline Point<V> cross(const Point<V>& a, const Point<V>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class V>
inline V unit_interval(const V& value) {
  return max(V(0), min(V(1), value));
}

/// A point, a segment or a triangle.
template <class V>
struct Piece {
  int corners = 1;
  Point<V> corner[3];
  [[nodiscard]] int edges() const { return corners == 2 ? 1 : corners; }
  /// Both ends of an edge; of a point the same twice.
  [[nodiscard]] const Point<V>& from(int edge) const { return corner[edge]; }
  [[nodiscard]] const Point<V>& to(int edge) const { return corner[(edge + 1) % corners]; }
};

/// Nearest points of the segments p–q and r–s: parts of the way from p to q and from r to s.
/// Parallel segments, and such of no length, are legal. (Ericson, Real-Time Collision Detection
/// 2005, 5.1.9: nearest points of the lines, brought back to the segments one after the other.)
template <class V>
inline void nearest_parts(const Point<V>& p, const Point<V>& q, const Point<V>& r,
                          const Point<V>& s, V& along, V& onto) {
  const Point<V> u = q - p, v = s - r, w = p - r;
  const V a = dot(u, u), e = dot(v, v), b = dot(u, v), c = dot(u, w), f = dot(v, w);
  const V across = a * e - b * b;  // a·e·sin²
  const V first = select(across > V(1e-14) * a * e,
                         unit_interval((b * f - c * e) / max(across, V(kTiny))), V(0));
  onto = unit_interval((b * first + f) / max(e, V(kTiny)));
  along = unit_interval((b * onto - c) / max(a, V(kTiny)));
}

/// Squared distance of the segments p–q and r–s.
template <class V>
inline V squared_distance(const Point<V>& p, const Point<V>& q, const Point<V>& r,
                          const Point<V>& s) {
  V along, onto;
  nearest_parts(p, q, r, s, along, onto);
  const Point<V> u = q - p, v = s - r, w = p - r;
  const Point<V> gap{w.x + u.x * along - v.x * onto, w.y + u.y * along - v.y * onto,
                     w.z + u.z * along - v.z * onto};
  return dot(gap, gap);
}

/// Squared distance of a point from the plane of a triangle where it stands above the
/// triangle, else far.
template <class V>
inline V squared_height(const Point<V>& point, const Piece<V>& triangle) {
  const Point<V> n =
      cross(triangle.corner[1] - triangle.corner[0], triangle.corner[2] - triangle.corner[0]);
  V least(1);
  for (int k = 0; k < 3; ++k)
    least = min(least, dot(n, cross(triangle.to(k) - triangle.from(k), point - triangle.from(k))));
  const V height = dot(n, point - triangle.corner[0]), square = dot(n, n);
  return select(least >= V(0),
                select(square > V(kTiny), height * height / max(square, V(kTiny)), V(kFar)),
                V(kFar));
}

/// Zero where the segment p–q crosses the triangle, else far.
template <class V>
inline V crossing(const Point<V>& p, const Point<V>& q, const Piece<V>& triangle) {
  const Point<V> n =
      cross(triangle.corner[1] - triangle.corner[0], triangle.corner[2] - triangle.corner[0]);
  const V sides = dot(n, p - triangle.corner[0]) * dot(n, q - triangle.corner[0]);
  const Point<V> way = q - p;
  V least(kFar), most(-kFar);
  for (int k = 0; k < 3; ++k) {
    const V volume = dot(way, cross(triangle.from(k) - p, triangle.to(k) - p));
    least = min(least, volume);
    most = max(most, volume);
  }
  // The line passes all edges on the same side.
  const V through = max(least, V(0) - most);
  return select(sides < V(0), select(through >= V(0), V(0), V(kFar)), V(kFar));
}

/// What the inside of a triangle `a` adds to the distances of its edges from another piece.
template <class V>
inline V squared_inside(const Piece<V>& a, const Piece<V>& b) {
  V least(kFar);
  for (int k = 0; k < b.corners; ++k) least = min(least, squared_height(b.corner[k], a));
  if (b.corners > 1)
    for (int k = 0; k < b.edges(); ++k) least = min(least, crossing(b.from(k), b.to(k), a));
  return least;
}

/// Squared distance of two pieces; zero where they meet.
template <class V>
inline V squared_distance(const Piece<V>& a, const Piece<V>& b) {
  V least(kFar);
  for (int i = 0; i < a.edges(); ++i)
    for (int k = 0; k < b.edges(); ++k)
      least = min(least, squared_distance(a.from(i), a.to(i), b.from(k), b.to(k)));
  if (a.corners == 3) least = min(least, squared_inside(a, b));
  if (b.corners == 3) least = min(least, squared_inside(b, a));
  return least;
}

}  // namespace polyglide::pieces
