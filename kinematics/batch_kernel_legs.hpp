#pragma once

#include <limits>

#include "kinematics/batch_kernels.hpp"
#include "kinematics/simd.hpp"

/// Inverse kinematics of a pack of poses: places of the drives, first limit met, rows of J.
namespace polyglide::batch::detail {

using simd::abs;
using simd::any;
using simd::atan2;
using simd::kTiny;
using simd::Lanes;
using simd::MaskOf;
using simd::max;
using simd::min;
using simd::select;
using simd::sqrt;

template <class V>
struct Vec {
  V x, y, z;
};
template <class V>
inline Vec<V> spread(const double* v) {
  return {V(v[0]), V(v[1]), V(v[2])};
}
template <class V>
inline Vec<V> operator+(const Vec<V>& a, const Vec<V>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class V>
inline V dot(const Vec<V>& a, const Vec<V>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class V>
inline V dot(const Vec<V>& a, const double* b) {
  return a.x * V(b[0]) + a.y * V(b[1]) + a.z * V(b[2]);
}
template <class V>
inline Vec<V> cross(const Vec<V>& a, const Vec<V>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class V>
inline Vec<V> scaled(const Vec<V>& a, const V& s) {
  return {a.x * s, a.y * s, a.z * s};
}

template <class V>
struct Rotation {
  Vec<V> row[3];
  Vec<V> operator()(const double* v) const {
    return {dot(row[0], v), dot(row[1], v), dot(row[2], v)};
  }
};

template <class V>
inline Rotation<V> rotation_of(const V& w, const V& x, const V& y, const V& z) {
  const V s = V(2) / (w * w + x * x + y * y + z * z);
  const V one(1), sx = s * x, sy = s * y, sz = s * z;
  return {{{one - sy * y - sz * z, sx * y - sz * w, sx * z + sy * w},
           {sx * y + sz * w, one - sx * x - sz * z, sy * z - sx * w},
           {sx * z - sy * w, sy * z + sx * w, one - sx * x - sy * y}}};
}

/// Rz(c)·Ry(b)·Rx(a).
template <class V>
inline Rotation<V> rotation_of(const double* const (&angle)[3], int i) {
  V s[3], c[3];
  for (int k = 0; k < 3; ++k) {
    s[k] = V(0), c[k] = V(1);
    if (angle[k]) simd::sincos(Lanes<V>::load(angle[k] + i), s[k], c[k]);
  }
  const V cs = c[2] * s[1], ss = s[2] * s[1];
  return {{{c[2] * c[1], cs * s[0] - s[2] * c[0], cs * c[0] + s[2] * s[0]},
           {s[2] * c[1], ss * s[0] + c[2] * c[0], ss * c[0] - c[2] * s[0]},
           {V(0) - s[1], c[1] * s[0], c[1] * c[0]}}};
}

/// What the compiler knows of the legs beforehand: nothing.
struct AnyLegs {
  static constexpr bool kAlike = false;
  static constexpr int kMost = kMostDrives;
  static int drives(const KernelModel& model) { return model.drives; }
  static bool moments(const KernelModel& model) { return model.moments; }
  static LegKind kind(const LegData& leg) { return leg.kind; }
  static bool primary(const LegData& leg) { return leg.primary; }
};

/// That every drive d has leg d and no other, all of one kind, and that the columns of J
/// are the three translations or all six: loops unroll and J stays in registers.
template <LegKind kKind, int kColumns>
struct AlikeLegs {
  static constexpr bool kAlike = true;
  static constexpr int kMost = kColumns;
  static int drives(const KernelModel&) { return kColumns; }
  static bool moments(const KernelModel&) { return kColumns == 6; }
  static LegKind kind(const LegData&) { return kKind; }
  static bool primary(const LegData&) { return true; }
};

/// Calls work(d) for every drive.
template <class Legs, class Work>
[[gnu::always_inline]] inline void for_drives(const KernelModel& model, const Work& work) {
  if constexpr (Legs::kAlike) {
#pragma GCC unroll 8
    for (int d = 0; d < Legs::kMost; ++d) work(d);
  } else {
    for (int d = 0; d < model.drives; ++d) work(d);
  }
}

/// A pack of poses on its way through the kernel.
template <class V, class Legs>
struct Pack {
  Vec<V> t;
  Rotation<V> rotation;  ///< only when turning
  V limit;               ///< first limit met, -1 where there is none
  V place[Legs::kMost];
  V rows[Legs::kMost][6];  ///< force, moment/characteristic length
  Vec<V> arms[Legs::kMost];

  /// Limits met later count only where none was met before.
  void meet(const V& later) { limit = select(MaskOf<V>(limit < V(0)), later, limit); }
  void fail(const MaskOf<V>& broken, double code) { meet(select(broken, V(code), V(-1))); }
};

/// One leg solved: place of its drive, not-a-number out of its reach; unit vector along it,
/// row of J.
template <class V>
struct Solved {
  V place;
  Vec<V> along, row;
  V cosine, sine;  ///< of the crank's angle
};

template <class V>
inline Solved<V> solve_guide(const LegData& leg, const Vec<V>& v, bool cones) {
  Solved<V> solved{};
  const V s = dot(v, leg.direction);
  const Vec<V> g = spread<V>(leg.direction);
  const Vec<V> p{v.x - s * g.x, v.y - s * g.y, v.z - s * g.z};
  const V left = V(leg.length * leg.length) - dot(p, p);
  // On the edge of its reach the root is zero, beyond it no number.
  const auto [root, one_by] = simd::root_of(left + V(simd::kSmall));
  const V rise = V(leg.side) * root, inverse = V(leg.side) * one_by;
  solved.place = s + rise;
  // u = (p - rise·g)/L, and u/(u·g) since p is normal to g.
  solved.row = {g.x - p.x * inverse, g.y - p.y * inverse, g.z - p.z * inverse};
  if (cones) {
    const V scale(1 / leg.length);
    solved.along = {(p.x - rise * g.x) * scale, (p.y - rise * g.y) * scale,
                    (p.z - rise * g.z) * scale};
  }
  return solved;
}

template <class V>
inline Solved<V> solve_strut(const LegData& leg, const Vec<V>& v) {
  Solved<V> solved{};
  const V square = dot(v, v);
  const V inverse = simd::root_of(square).inverse;
  solved.place = square * inverse - V(leg.length);
  solved.along = solved.row = scaled(v, inverse);
  return solved;
}

/// |v - radius (cos θ outward + sin θ onward)| = L is A cos θ + B sin θ = C.
template <class V>
inline Solved<V> solve_crank(const LegData& leg, const Vec<V>& v) {
  Solved<V> solved{};
  const V a = dot(v, leg.outward), b = dot(v, leg.onward);
  const V c =
      (dot(v, v) + V(leg.radius * leg.radius - leg.length * leg.length)) * V(0.5 / leg.radius);
  const V square = a * a + b * b, left = square - c * c;
  const V s = V(leg.side) * sqrt(max(V(0), left)), inverse = V(1) / (square + V(kTiny));
  solved.cosine = (a * c - b * s) * inverse;
  solved.sine = (b * c + a * s) * inverse;
  solved.place = select(MaskOf<V>(left >= V(0)), atan2(solved.sine, solved.cosine),
                        V(std::numeric_limits<double>::quiet_NaN()));
  const Vec<V> u = spread<V>(leg.outward), w = spread<V>(leg.onward);
  const V rc = V(leg.radius) * solved.cosine, rs = V(leg.radius) * solved.sine;
  const V scale(1 / leg.length);
  solved.along = {(v.x - rc * u.x - rs * w.x) * scale, (v.y - rc * u.y - rs * w.y) * scale,
                  (v.z - rc * u.z - rs * w.z) * scale};
  const Vec<V> speed{rc * w.x - rs * u.x, rc * w.y - rs * u.y, rc * w.z - rs * u.z};
  solved.row = scaled(solved.along, V(1) / dot(solved.along, speed));
  return solved;
}

template <class V>
inline Vec<V> cone_axis(const LegData& leg, const ConeData& cone, const Solved<V>& solved,
                        const Rotation<V>& rotation, bool turning) {
  const Vec<V> axis = spread<V>(cone.axis);
  if (cone.on == ConeData::On::platform && turning) return rotation(cone.axis);
  if (cone.on != ConeData::On::crank) return axis;
  const Vec<V> u = spread<V>(leg.outward), w = spread<V>(leg.onward);
  const Vec<V> e = cross(u, w);
  const V a = dot(axis, u), b = dot(axis, w), c = dot(axis, e);
  const V au = a * solved.cosine - b * solved.sine, bw = a * solved.sine + b * solved.cosine;
  return scaled(u, au) + scaled(w, bw) + scaled(e, c);
}

template <class V, bool kTurning, class Legs>
[[gnu::always_inline]] inline void solve_leg(const KernelModel& model, const LegData& leg, int d,
                                             Pack<V, Legs>& pack) {
  const Vec<V> arm = kTurning ? pack.rotation(leg.arm) : spread<V>(leg.arm);
  Vec<V> v = pack.t + spread<V>(leg.shift);
  if (kTurning) v = v + arm;
  const bool cones = leg.first_cone < leg.last_cone;
  const Solved<V> solved = Legs::kind(leg) == LegKind::guide_rod ? solve_guide<V>(leg, v, cones)
                           : Legs::kind(leg) == LegKind::strut   ? solve_strut<V>(leg, v)
                                                                 : solve_crank<V>(leg, v);
  // What comes first is asked last, and has the last word.
  V limit(-1);
  for (int c = leg.last_cone; c-- > leg.first_cone;) {
    const ConeData& cone = model.cones[c];
    const Vec<V> axis = cone_axis<V>(leg, cone, solved, pack.rotation, kTurning);
    limit = select(MaskOf<V>(dot(solved.along, axis) < V(cone.cosine)), V(cone.limit), limit);
  }
  if (Legs::primary(leg)) {
    limit = select(MaskOf<V>(solved.place > V(leg.max)), V(leg.max_limit), limit);
    limit = select(MaskOf<V>(solved.place < V(leg.min)), V(leg.min_limit), limit);
    limit = select(MaskOf<V>(solved.place == solved.place), limit, V(leg.reach));
    pack.place[d] = solved.place;
    V(&row)[6] = pack.rows[d];
    row[0] = solved.row.x, row[1] = solved.row.y, row[2] = solved.row.z;
    if (Legs::moments(model)) {
      const Vec<V> moment = scaled(cross(arm, solved.row), V(model.scale));
      row[3] = moment.x, row[4] = moment.y, row[5] = moment.z;
    }
    pack.arms[d] = arm;
  } else {
    const auto agrees = MaskOf<V>(abs(solved.place - pack.place[d]) <= V(leg.tolerance));
    limit = select(agrees, limit, V(leg.reach));
  }
  pack.meet(limit);
}

template <class V, bool kTurning, class Legs>
inline void check_plane(const KernelModel& model, const PlaneData& plane, Pack<V, Legs>& pack) {
  V height = dot(pack.t, plane.normal);
  for_drives<Legs>(model, [&](int d) {
    if (plane.slope != 0 && plane.drive == d) height = height + V(plane.slope) * pack.place[d];
  });
  V most = height;
  if (kTurning)
    for (int i = plane.first_arm; i < plane.last_arm; ++i) {
      const V here = height + dot(pack.rotation(&model.arms[3 * i]), plane.normal);
      most = i == plane.first_arm ? here : max(most, here);
    }
  pack.fail(MaskOf<V>(most > V(plane.offset)), plane.limit);
}

/// Coordinates that a pure machine cannot command, and what is no number.
template <class V, bool kTurning, class Legs>
inline void check_motion(const KernelModel& model, Pack<V, Legs>& pack) {
  constexpr double kSlack = 1e-9;
  V sum = pack.t.x + pack.t.y + pack.t.z;
  if (kTurning) {
    const auto& r = pack.rotation.row;
    sum = sum + (r[0].x + r[1].y + r[2].z + r[2].x);
  }
  // Not-a-number and infinity less themselves are not zero.
  pack.fail(MaskOf<V>(!(sum - sum == V(0))), model.not_finite);
  const V* stray[3]{&pack.t.x, &pack.t.y, &pack.t.z};
  for (int k = 0; k < 3; ++k)
    if (!model.free[k]) pack.fail(MaskOf<V>(abs(*stray[k]) > V(kSlack)), model.motion);
  if (kTurning) {
    const auto& r = pack.rotation.row;
    const V sines[3]{r[2].y, V(0) - r[2].x, r[1].x};
    const V cosines[3]{r[2].z, V(1), r[0].x};
    for (int k = 0; k < 3; ++k)
      if (!model.free[3 + k])
        pack.fail(MaskOf<V>(!(abs(sines[k]) <= V(kSlack) * cosines[k])), model.motion);
  }
}

/// Places, limits and rows of J for one pack.
template <class V, bool kTurning, class Legs>
inline void solve(const KernelModel& model, const KernelInput& in, int i, Pack<V, Legs>& pack) {
  pack.t = {Lanes<V>::load(in.x + i), Lanes<V>::load(in.y + i), Lanes<V>::load(in.z + i)};
  pack.limit = V(-1);
  if (kTurning)
    pack.rotation = in.quaternion[0] ? rotation_of<V>(Lanes<V>::load(in.quaternion[0] + i),
                                                      Lanes<V>::load(in.quaternion[1] + i),
                                                      Lanes<V>::load(in.quaternion[2] + i),
                                                      Lanes<V>::load(in.quaternion[3] + i))
                                     : rotation_of<V>(in.angle, i);
  check_motion<V, kTurning>(model, pack);
  if constexpr (Legs::kAlike)
    for_drives<Legs>(model, [&](int d) { solve_leg<V, kTurning>(model, model.legs[d], d, pack); });
  else
    for (const LegData& leg : model.legs) solve_leg<V, kTurning>(model, leg, leg.drive, pack);
  for (const PlaneData& plane : model.planes) check_plane<V, kTurning>(model, plane, pack);
}

}  // namespace polyglide::batch::detail
