#pragma once

#include "kinematics/batch_kernels.hpp"
#include "kinematics/singular_values.hpp"

/// The batch evaluator's inner part: plain numbers in, plain numbers out, one kernel
/// written once for a number or a register of numbers V. Only batch_kernel_*.cpp
/// instantiate it, each for one instruction set; batch_dispatch.cpp chooses.
namespace polyglide::batch {
namespace detail {

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

/// A pack of poses on its way through the kernel.
template <class V>
struct Pack {
  Vec<V> t;
  Rotation<V> rotation;  ///< only when turning
  V limit;
  V place[kMostDrives];
  V rows[kMostDrives][6];  ///< force, moment/characteristic length
  Vec<V> arms[kMostDrives];
};

template <class V>
inline void fail(V& limit, const MaskOf<V>& broken, int code) {
  limit = select(MaskOf<V>(broken & (limit < V(0))), V(double(code)), limit);
}

/// One leg solved: place of its drive, unit vector along it, row of J.
template <class V>
struct Solved {
  V place;
  Vec<V> along, row;
  MaskOf<V> out_of_reach;
  V cosine, sine;  ///< of the crank's angle
};

template <class V>
inline Solved<V> solve_guide(const LegData& leg, const Vec<V>& v, bool cones) {
  Solved<V> solved{};
  const V s = dot(v, leg.direction);
  const Vec<V> g = spread<V>(leg.direction);
  const Vec<V> p{v.x - s * g.x, v.y - s * g.y, v.z - s * g.z};
  const V left = V(leg.length * leg.length) - dot(p, p);
  const V rise = V(leg.side) * sqrt(max(V(0), left));
  solved.out_of_reach = !(left >= V(0));
  solved.place = s + rise;
  // u = (p - rise·g)/L, and u/(u·g) since p is normal to g.
  const V inverse = V(1) / rise;
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
  const V distance = sqrt(dot(v, v));
  solved.out_of_reach = !(distance > V(0));
  solved.place = distance - V(leg.length);
  solved.along = solved.row = scaled(v, V(1) / (distance + V(kTiny)));
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
  solved.out_of_reach = !(left >= V(0));
  const V s = V(leg.side) * sqrt(max(V(0), left)), inverse = V(1) / (square + V(kTiny));
  solved.cosine = (a * c - b * s) * inverse;
  solved.sine = (b * c + a * s) * inverse;
  solved.place = atan2(solved.sine, solved.cosine);
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
inline Vec<V> cone_axis(const KernelModel&, const LegData& leg, const ConeData& cone,
                        const Solved<V>& solved, const Pack<V>& pack, bool turning) {
  const Vec<V> axis = spread<V>(cone.axis);
  if (cone.on == ConeData::On::platform && turning) return pack.rotation(cone.axis);
  if (cone.on != ConeData::On::crank) return axis;
  const Vec<V> u = spread<V>(leg.outward), w = spread<V>(leg.onward);
  const Vec<V> e = cross(u, w);
  const V a = dot(axis, u), b = dot(axis, w), c = dot(axis, e);
  const V au = a * solved.cosine - b * solved.sine, bw = a * solved.sine + b * solved.cosine;
  return scaled(u, au) + scaled(w, bw) + scaled(e, c);
}

template <class V, bool kTurning>
inline void solve_leg(const KernelModel& model, const LegData& leg, Pack<V>& pack) {
  Vec<V> arm = kTurning ? pack.rotation(leg.arm) : spread<V>(leg.arm);
  Vec<V> v = pack.t + spread<V>(leg.shift);
  if (kTurning) v = v + arm;
  const bool cones = leg.first_cone < leg.last_cone;
  const Solved<V> solved = leg.kind == LegKind::guide_rod ? solve_guide<V>(leg, v, cones)
                           : leg.kind == LegKind::strut   ? solve_strut<V>(leg, v)
                                                          : solve_crank<V>(leg, v);
  fail(pack.limit, solved.out_of_reach, leg.reach);
  const int d = leg.drive;
  if (leg.primary) {
    fail(pack.limit, MaskOf<V>(solved.place < V(leg.min)), leg.min_limit);
    fail(pack.limit, MaskOf<V>(solved.place > V(leg.max)), leg.max_limit);
    pack.place[d] = solved.place;
    V(&row)[6] = pack.rows[d];
    row[0] = solved.row.x, row[1] = solved.row.y, row[2] = solved.row.z;
    if (model.moments) {
      const Vec<V> moment = scaled(cross(arm, solved.row), V(model.scale));
      row[3] = moment.x, row[4] = moment.y, row[5] = moment.z;
    }
    pack.arms[d] = arm;
  } else {
    fail(pack.limit, MaskOf<V>(!(abs(solved.place - pack.place[d]) <= V(leg.tolerance))),
         leg.reach);
  }
  for (int c = leg.first_cone; c < leg.last_cone; ++c) {
    const ConeData& cone = model.cones[c];
    const Vec<V> axis = cone_axis<V>(model, leg, cone, solved, pack, kTurning);
    fail(pack.limit, MaskOf<V>(dot(solved.along, axis) < V(cone.cosine)), cone.limit);
  }
}

template <class V>
inline void check_plane(const KernelModel& model, const PlaneData& plane, Pack<V>& pack) {
  V height = dot(pack.t, plane.normal);
  if (plane.slope != 0) height = height + V(plane.slope) * pack.place[plane.drive];
  V most = height;
  for (int i = plane.first_arm; i < plane.last_arm; ++i) {
    const V here = height + dot(pack.rotation(&model.arms[3 * i]), plane.normal);
    most = i == plane.first_arm ? here : max(most, here);
  }
  fail(pack.limit, MaskOf<V>(most > V(plane.offset)), plane.limit);
}

/// Coordinates that a pure machine cannot command, and what is no number.
template <class V, bool kTurning>
inline void check_motion(const KernelModel& model, Pack<V>& pack) {
  constexpr double kSlack = 1e-9;
  V sum = pack.t.x + pack.t.y + pack.t.z;
  if (kTurning) {
    const auto& r = pack.rotation.row;
    sum = sum + (r[0].x + r[1].y + r[2].z + r[2].x);
  }
  // Not-a-number and infinity less themselves are not zero.
  fail(pack.limit, MaskOf<V>(!(sum - sum == V(0))), model.not_finite);
  const V* stray[3]{&pack.t.x, &pack.t.y, &pack.t.z};
  for (int k = 0; k < 3; ++k)
    if (!model.free[k]) fail(pack.limit, MaskOf<V>(abs(*stray[k]) > V(kSlack)), model.motion);
  if (kTurning) {
    const auto& r = pack.rotation.row;
    const V sines[3]{r[2].y, V(0) - r[2].x, r[1].x};
    const V cosines[3]{r[2].z, V(1), r[0].x};
    for (int k = 0; k < 3; ++k)
      if (!model.free[3 + k])
        fail(pack.limit, MaskOf<V>(!(abs(sines[k]) <= V(kSlack) * cosines[k])), model.motion);
  }
}

/// Places, limits and rows of J for one pack.
template <class V, bool kTurning>
inline void solve(const KernelModel& model, const KernelInput& in, int i, Pack<V>& pack) {
  pack.t = {Lanes<V>::load(in.x + i), Lanes<V>::load(in.y + i), Lanes<V>::load(in.z + i)};
  pack.limit = V(-1);
  if (kTurning)
    pack.rotation = in.quaternion[0] ? rotation_of<V>(Lanes<V>::load(in.quaternion[0] + i),
                                                      Lanes<V>::load(in.quaternion[1] + i),
                                                      Lanes<V>::load(in.quaternion[2] + i),
                                                      Lanes<V>::load(in.quaternion[3] + i))
                                     : rotation_of<V>(in.angle, i);
  check_motion<V, kTurning>(model, pack);
  for (const LegData& leg : model.legs) solve_leg<V, kTurning>(model, leg, pack);
  for (const PlaneData& plane : model.planes) check_plane<V>(model, plane, pack);
}

/// Entry of J: drive d, column k.
template <class V, int N>
inline const V& entry(const KernelModel& model, const Pack<V>& pack, int d, int k) {
  return pack.rows[d][N == 6 ? k : model.axes[k]];
}

template <class V, int N>
inline void make_gram(const KernelModel& model, const Pack<V>& pack, V (&gram)[N][N]) {
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k)
#pragma GCC unroll 8
    for (int l = 0; l < N; ++l) gram[k][l] = V(0);
  for (int d = 0; d < model.drives; ++d)
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k)
#pragma GCC unroll 8
      for (int l = 0; l <= k; ++l)
        gram[k][l] = gram[k][l] + entry<V, N>(model, pack, d, k) * entry<V, N>(model, pack, d, l);
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k)
#pragma GCC unroll 8
    for (int l = k + 1; l < N; ++l) gram[k][l] = gram[l][k];
}

template <class V, int N>
inline V determinant_of(const V (&m)[N][N]) {
  if constexpr (N == 1) return m[0][0];
  if constexpr (N == 2) return m[0][0] * m[1][1] - m[0][1] * m[1][0];
  if constexpr (N == 3)
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  if constexpr (N > 3) {
    V copy[N][N];
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i)
#pragma GCC unroll 8
      for (int j = 0; j < N; ++j) copy[i][j] = m[i][j];
    return simd::determinant<V, N>(copy);
  }
}

template <class V, int N>
inline V determinant_of_rows(const KernelModel& model, const Pack<V>& pack) {
  V square[N][N];
#pragma GCC unroll 8
  for (int d = 0; d < N; ++d)
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) square[d][k] = entry<V, N>(model, pack, d, k);
  return determinant_of<V, N>(square);
}

/// The squares of the singular values without loss of digits, for the lanes that need it.
template <class V>
[[gnu::noinline]] simd::Spectrum<V> careful_spectrum(const KernelModel& model,
                                                     const Pack<V>& pack) {
  V columns[6][kMostDrives];
  for (int k = 0; k < model.columns; ++k)
    for (int d = 0; d < model.drives; ++d) columns[k][d] = pack.rows[d][model.axes[k]];
  return simd::one_sided_jacobi<V, kMostDrives, 6>(columns, model.drives, model.columns);
}

template <class V, int N>
inline simd::Extremes<V> extremes_of(const KernelModel& model, const Pack<V>& pack, const V& det,
                                     V (&gram)[N][N]) {
  const bool square = model.drives == N;
  simd::Extremes<V> found{V(0), V(0), V(0) > V(1)};
  if constexpr (N == 1) found = {gram[0][0], gram[0][0], V(0) > V(1)};
  if constexpr (N == 2)
    found = simd::extremes2<V>(gram, square ? det * det : determinant_of<V, N>(gram));
  if constexpr (N == 3)
    found = simd::extremes3<V>(gram, square ? det * det : determinant_of<V, N>(gram));
  if constexpr (N > 3) found = simd::extremes<V, N>(gram);
  found.doubtful = MaskOf<V>(found.doubtful & (pack.limit < V(0)));
  if (any(found.doubtful)) {
    const simd::Spectrum<V> careful = careful_spectrum<V>(model, pack);
    found.least = select(found.doubtful, careful.least, found.least);
    found.greatest = select(found.doubtful, careful.greatest, found.greatest);
  }
  return found;
}

/// 1/κ_F from the factors of JᵀJ, and with care where they have lost digits.
template <class V, int N>
inline V frobenius_of(const KernelModel& model, const Pack<V>& pack, const V (&gram)[N][N]) {
  V factors[N][N];
  V trace(0);
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k) {
    trace = trace + gram[k][k];
#pragma GCC unroll 8
    for (int l = 0; l <= k; ++l) factors[k][l] = gram[k][l];
  }
  const auto definite = simd::factorise<V, N>(factors);
  const V inverse = V(double(N)) / sqrt(trace * simd::trace_of_inverse<V, N>(factors));
  const auto doubtful =
      MaskOf<V>((pack.limit < V(0)) & !MaskOf<V>(definite & (inverse >= V(1e-3))));
  if (!any(doubtful)) return inverse;
  const simd::Spectrum<V> careful = careful_spectrum<V>(model, pack);
  return select(doubtful, V(double(N)) / sqrt(careful.sum * careful.sum_of_inverses), inverse);
}

/// Least of cos μ over legs: at the drive, 1/(|force| lever), and at the platform,
/// 1/(|force| |velocity of the joint when only this drive moves|).
template <class V, int N>
[[gnu::noinline]] V transmission_of(const KernelModel& model, const Pack<V>& pack) {
  const bool square = model.drives == N;
  V rows[N][N], inverse[N][N];
  if (square) {
    for (int d = 0; d < N; ++d)
      for (int k = 0; k < N; ++k) rows[d][k] = entry<V, N>(model, pack, d, k);
    simd::invert<V, N>(rows, inverse);
  }
  V least(1), sum(0);
  for (int d = 0; d < model.drives; ++d) {
    const V* row = pack.rows[d];
    const V force2 = row[0] * row[0] + row[1] * row[1] + row[2] * row[2];
    V most(model.lever[d] * model.lever[d]);
    if (square) {
      V twist[6]{V(0), V(0), V(0), V(0), V(0), V(0)};
      for (int k = 0; k < N; ++k) twist[model.axes[k]] = inverse[k][d];
      Vec<V> velocity{twist[0], twist[1], twist[2]};
      if (model.moments) {
        const Vec<V> spin = scaled(Vec<V>{twist[3], twist[4], twist[5]}, V(model.scale));
        velocity = velocity + cross(spin, pack.arms[d]);
      }
      const V speed2 = dot(velocity, velocity);
      most = select(MaskOf<V>(most > speed2), most, speed2);
    }
    const V share = V(1) / (force2 * most);
    least = min(least, share);
    sum = sum + share;
  }
  // A singular J, whose inverse is not finite, transmits nothing.
  least = select(MaskOf<V>(sum - sum == V(0)), least, V(0));
  return sqrt(least);
}

/// Indices of one pack; zero in lanes that met a limit.
template <class V, int N>
[[gnu::noinline]] void conclude(const KernelModel& model, const Pack<V>& pack,
                                const KernelOutput& out, int i) {
  const auto good = pack.limit < V(0);
  const auto put = [&](double* column, const V& value) {
    if (column) Lanes<V>::store(column + i, select(MaskOf<V>(good & (value > V(0))), value, V(0)));
  };
  const bool square = model.drives == N, enough = model.drives >= N;
  const bool singular = out.condition || out.smallest || out.softest || out.stiffest;
  V det(0);
  if (square && (out.orientation || (singular && N <= 3)))
    det = determinant_of_rows<V, N>(model, pack);
  if (out.orientation) Lanes<V>::store(out.orientation + i, select(good, det, V(0)));
  // Fewer drives than columns leave the platform a motion: the least singular value is 0.
  const V least_factor(enough ? 1 : 0);
  if (out.transmission) put(out.transmission, least_factor * transmission_of<V, N>(model, pack));
  if (!singular && !out.frobenius) return;

  V gram[N][N];
  make_gram<V, N>(model, pack, gram);
  if (out.frobenius) put(out.frobenius, least_factor * frobenius_of<V, N>(model, pack, gram));
  if (!singular) return;
  simd::Extremes<V> found = extremes_of<V, N>(model, pack, det, gram);
  found.least = found.least * least_factor;
  if (out.condition)
    put(out.condition, min(V(1), sqrt(max(V(0), found.least) / (found.greatest + V(kTiny)))));
  if (out.smallest) put(out.smallest, sqrt(max(V(0), found.least)));
  put(out.softest, found.least);
  put(out.stiffest, found.greatest);
}

template <class V>
inline void store_columns(const KernelModel& model, const Pack<V>& pack, const KernelOutput& out,
                          int i) {
  if (out.drives)
    for (int d = 0; d < model.drives; ++d)
      Lanes<V>::store(out.drives + d * out.stride + i, pack.place[d]);
  if (out.jacobian)
    for (int d = 0; d < model.drives; ++d)
      for (int k = 0; k < model.columns; ++k)
        Lanes<V>::store(out.jacobian + (d * model.columns + k) * out.stride + i,
                        pack.rows[d][model.axes[k]]);
}

template <class V, int N, bool kTurning>
void run(const KernelModel& model, const KernelInput& in, const KernelOutput& out, int count) {
  Pack<V> pack;
  for (int i = 0; i < count; i += Lanes<V>::count) {
    solve<V, kTurning>(model, in, i, pack);
    Lanes<V>::store(out.limit + i, pack.limit);
    store_columns<V>(model, pack, out, i);
    conclude<V, N>(model, pack, out, i);
  }
}

template <class V, int N>
void run(const KernelModel& model, const KernelInput& in, const KernelOutput& out, int count) {
  if (in.turning())
    run<V, N, true>(model, in, out, count);
  else
    run<V, N, false>(model, in, out, count);
}

/// The legs that give the drives, with the drives put in: the platform joint of leg d is
/// to be where |t + shift + R·arm| = target.
template <class V>
struct Targets {
  const LegData* legs[kMostDrives];
  Vec<V> shift[kMostDrives];
  V square[kMostDrives];  ///< target²
};

template <class V>
inline Targets<V> targets_of(const KernelModel& model, const ForwardColumns& io, int i) {
  Targets<V> targets;
  for (const LegData& leg : model.legs) {
    if (!leg.primary) continue;
    const int d = leg.drive;
    const V q = Lanes<V>::load(io.drives + d * io.stride + i);
    V length(leg.length);
    Vec<V> shift = spread<V>(leg.shift);
    if (leg.kind == LegKind::strut) {
      length = length + q;
    } else if (leg.kind == LegKind::guide_rod) {
      shift = shift + scaled(spread<V>(leg.direction), V(0) - q);
    } else {
      V sine, cosine;
      simd::sincos(q, sine, cosine);
      shift = shift + scaled(spread<V>(leg.outward), V(-leg.radius) * cosine) +
              scaled(spread<V>(leg.onward), V(-leg.radius) * sine);
    }
    targets.legs[d] = &leg;
    targets.shift[d] = shift;
    targets.square[d] = length * length;
  }
  return targets;
}

template <class V>
struct Guess {
  Vec<V> t;
  V w, x, y, z;  ///< quaternion
};

/// Rows of ½∂|v|² and errors ½(|v|² - target²); returns the greatest, relative to target².
template <class V, int N>
inline V leg_errors(const KernelModel& model, const Targets<V>& targets, const Guess<V>& guess,
                    V (&rows)[kMostDrives][6], V (&errors)[kMostDrives]) {
  const Rotation<V> rotation = rotation_of<V>(guess.w, guess.x, guess.y, guess.z);
  V worst(0), sum(0);
  for (int d = 0; d < model.drives; ++d) {
    const Vec<V> arm = rotation(targets.legs[d]->arm);
    const Vec<V> v = guess.t + targets.shift[d] + arm;
    errors[d] = V(0.5) * (dot(v, v) - targets.square[d]);
    rows[d][0] = v.x, rows[d][1] = v.y, rows[d][2] = v.z;
    if (model.moments) {
      const Vec<V> moment = scaled(cross(arm, v), V(model.scale));
      rows[d][3] = moment.x, rows[d][4] = moment.y, rows[d][5] = moment.z;
    }
    const V error = abs(errors[d]) / (targets.square[d] + V(kTiny));
    worst = max(worst, error);
    sum = sum + error;
  }
  // Not-a-number must win.
  worst = select(MaskOf<V>(sum - sum == V(0)), worst, sum);
  return worst;
}

/// One step of Newton's method on the normal equations, zero in lanes that are done.
template <class V, int N>
inline void newton_step(const KernelModel& model, const V (&rows)[kMostDrives][6],
                        const V (&errors)[kMostDrives], const MaskOf<V>& done, Guess<V>& guess) {
  V gram[N][N], right[N];
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k) {
    right[k] = V(0);
#pragma GCC unroll 8
    for (int l = 0; l <= k; ++l) gram[k][l] = V(0);
  }
  for (int d = 0; d < model.drives; ++d) {
    V row[N];
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) row[k] = rows[d][N == 6 ? k : model.axes[k]];
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) {
      right[k] = right[k] + row[k] * errors[d];
#pragma GCC unroll 8
      for (int l = 0; l <= k; ++l) gram[k][l] = gram[k][l] + row[k] * row[l];
    }
  }
  simd::factorise<V, N>(gram);
  simd::solve_factorised<V, N>(gram, right);
  V step[6]{V(0), V(0), V(0), V(0), V(0), V(0)};
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k)
    step[N == 6 ? k : model.axes[k]] = select(done, V(0), V(0) - right[k]);
  guess.t = guess.t + Vec<V>{step[0], step[1], step[2]};
  if (!model.moments) return;
  // The quaternion of a small turn is (1, half of it) as near as Newton's method needs.
  const V half(0.5 * model.scale);
  const V a = half * step[3], b = half * step[4], c = half * step[5];
  const V w = guess.w - a * guess.x - b * guess.y - c * guess.z;
  const V x = guess.x + a * guess.w + b * guess.z - c * guess.y;
  const V y = guess.y + b * guess.w + c * guess.x - a * guess.z;
  const V z = guess.z + c * guess.w + a * guess.y - b * guess.x;
  const V scale = V(1) / sqrt(w * w + x * x + y * y + z * z);
  guess.w = w * scale, guess.x = x * scale, guess.y = y * scale, guess.z = z * scale;
}

template <class V, int N>
void run_forward(const KernelModel& model, const ForwardColumns& io, int count) {
  constexpr int kSteps = 15;
  constexpr double kAccurate = 1e-14;
  V rows[kMostDrives][6], errors[kMostDrives];
  for (int i = 0; i < count; i += Lanes<V>::count) {
    const Targets<V> targets = targets_of<V>(model, io, i);
    const auto load = [i](const double* column) { return Lanes<V>::load(column + i); };
    Guess<V> guess{{load(io.x), load(io.y), load(io.z)},
                   load(io.quaternion[0]),
                   load(io.quaternion[1]),
                   load(io.quaternion[2]),
                   load(io.quaternion[3])};
    V worst = leg_errors<V, N>(model, targets, guess, rows, errors);
    for (int step = 0; step < kSteps; ++step) {
      const auto done = MaskOf<V>(!(worst > V(kAccurate)));
      if (!any(!done)) break;
      newton_step<V, N>(model, rows, errors, done, guess);
      worst = leg_errors<V, N>(model, targets, guess, rows, errors);
    }
    Lanes<V>::store(io.x + i, guess.t.x);
    Lanes<V>::store(io.y + i, guess.t.y);
    Lanes<V>::store(io.z + i, guess.t.z);
    const V* parts[4]{&guess.w, &guess.x, &guess.y, &guess.z};
    for (int k = 0; k < 4; ++k) Lanes<V>::store(io.quaternion[k] + i, *parts[k]);
    Lanes<V>::store(io.residual + i, worst);
  }
}

}  // namespace detail

/// Drives to poses by Newton's method from the poses given; the residual is the greatest
/// error of a leg's squared length, relative.
template <class V>
void forward(const KernelModel& model, const ForwardColumns& io, int count) {
  switch (model.columns) {
    case 1:
      return detail::run_forward<V, 1>(model, io, count);
    case 2:
      return detail::run_forward<V, 2>(model, io, count);
    case 3:
      return detail::run_forward<V, 3>(model, io, count);
    case 4:
      return detail::run_forward<V, 4>(model, io, count);
    case 5:
      return detail::run_forward<V, 5>(model, io, count);
    default:
      return detail::run_forward<V, 6>(model, io, count);
  }
}

/// Poses to limits, places and indices.
template <class V>
void evaluate(const KernelModel& model, const KernelInput& in, const KernelOutput& out, int count) {
  switch (model.columns) {
    case 1:
      return detail::run<V, 1>(model, in, out, count);
    case 2:
      return detail::run<V, 2>(model, in, out, count);
    case 3:
      return detail::run<V, 3>(model, in, out, count);
    case 4:
      return detail::run<V, 4>(model, in, out, count);
    case 5:
      return detail::run<V, 5>(model, in, out, count);
    default:
      return detail::run<V, 6>(model, in, out, count);
  }
}

}  // namespace polyglide::batch
