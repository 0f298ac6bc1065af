#pragma once

#include "kinematics/batch_kernel_legs.hpp"
#include "kinematics/singular_values.hpp"

/// Indices of the Jacobians of a pack of poses.
namespace polyglide::batch::detail {

/// Entry of J: drive d, column k.
template <int N, class V, class Legs>
inline const V& entry(const KernelModel& model, const Pack<V, Legs>& pack, int d, int k) {
  return pack.rows[d][Legs::kAlike || N == 6 ? k : model.axes[k]];
}

template <class V, int N, class Legs>
inline void make_gram(const KernelModel& model, const Pack<V, Legs>& pack, V (&gram)[N][N]) {
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k)
#pragma GCC unroll 8
    for (int l = 0; l < N; ++l) gram[k][l] = V(0);
  for_drives<Legs>(model, [&](int d) {
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k)
#pragma GCC unroll 8
      for (int l = 0; l <= k; ++l)
        gram[k][l] = gram[k][l] + entry<N>(model, pack, d, k) * entry<N>(model, pack, d, l);
  });
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

template <class V, int N, class Legs>
inline V determinant_of_rows(const KernelModel& model, const Pack<V, Legs>& pack) {
  V square[N][N];
#pragma GCC unroll 8
  for (int d = 0; d < N; ++d)
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) square[d][k] = entry<N>(model, pack, d, k);
  return determinant_of<V, N>(square);
}

/// The squares of the singular values without loss of digits, for the lanes that need it.
template <class V, int N, class Legs>
inline simd::Spectrum<V> careful_spectrum(const KernelModel& model, const Pack<V, Legs>& pack) {
  // Written out, so that the pack itself need not lie in memory.
  V columns[6][Legs::kMost];
  for_drives<Legs>(model, [&](int d) {
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) columns[k][d] = entry<N>(model, pack, d, k);
  });
  return simd::one_sided_jacobi<V, Legs::kMost, 6>(columns, Legs::drives(model), N);
}

template <class V, int N, class Legs>
inline simd::Extremes<V> extremes_of(const KernelModel& model, const Pack<V, Legs>& pack,
                                     const MaskOf<V>& good, const V& det, V (&gram)[N][N]) {
  const bool square = Legs::drives(model) == N;
  simd::Extremes<V> found{V(0), V(0), V(0) > V(1)};
  if constexpr (N == 1) found = {gram[0][0], gram[0][0], V(0) > V(1)};
  if constexpr (N == 2)
    found = simd::extremes2<V>(gram, square ? det * det : determinant_of<V, N>(gram));
  if constexpr (N == 3)
    found = simd::extremes3<V>(gram, square ? det * det : determinant_of<V, N>(gram));
  if constexpr (N > 3) found = simd::extremes<V, N>(gram);
  found.doubtful = MaskOf<V>(found.doubtful & good);
  if (any(found.doubtful)) [[unlikely]] {
    const simd::Spectrum<V> careful = careful_spectrum<V, N>(model, pack);
    found.least = select(found.doubtful, careful.least, found.least);
    found.greatest = select(found.doubtful, careful.greatest, found.greatest);
  }
  return found;
}

/// 1/κ_F from the factors of JᵀJ, and with care where they have lost digits.
template <class V, int N, class Legs>
inline V frobenius_of(const KernelModel& model, const Pack<V, Legs>& pack, const MaskOf<V>& good,
                      const V (&gram)[N][N]) {
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
  const auto doubtful = MaskOf<V>(good & !MaskOf<V>(definite & (inverse >= V(1e-3))));
  if (!any(doubtful)) [[likely]]
    return inverse;
  const simd::Spectrum<V> careful = careful_spectrum<V, N>(model, pack);
  return select(doubtful, V(double(N)) / sqrt(careful.sum * careful.sum_of_inverses), inverse);
}

/// Least of cos μ over legs: at the drive, 1/(|force| lever), and at the platform,
/// 1/(|force| |velocity of the joint when only this drive moves|).
template <class V, int N, class Legs>
[[gnu::noinline]] V transmission_of(const KernelModel& model, const Pack<V, Legs>& pack) {
  const bool square = Legs::drives(model) == N;
  V rows[N][N], inverse[N][N];
  if (square) {
    for (int d = 0; d < N; ++d)
      for (int k = 0; k < N; ++k) rows[d][k] = entry<N>(model, pack, d, k);
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
      if (Legs::moments(model)) {
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
template <class V, int N, class Legs>
[[gnu::always_inline]] inline void conclude(const KernelModel& model, const Pack<V, Legs>& pack,
                                            const KernelOutput& out, int i) {
  const auto good = MaskOf<V>(pack.limit < V(0));
  const auto put = [&](double* column, const V& value) {
    // Not-a-number gives way to zero.
    if (column) Lanes<V>::store(column + i, select(good, max(value, V(0)), V(0)));
  };
  const bool square = Legs::drives(model) == N, enough = Legs::drives(model) >= N;
  const bool singular = out.condition || out.smallest || out.softest || out.stiffest;
  V det(0);
  if (square && (out.orientation || (singular && N <= 3)))
    det = determinant_of_rows<V, N>(model, pack);
  if (out.orientation) Lanes<V>::store_signs(out.orientation + i, select(good, det, V(0)));
  // Fewer drives than columns leave the platform a motion: the least singular value is 0.
  const V least_factor(enough ? 1 : 0);
  if (out.transmission) {
    const Pack<V, Legs> kept = pack;
    put(out.transmission, least_factor * transmission_of<V, N>(model, kept));
  }
  if (!singular && !out.frobenius) return;

  V gram[N][N];
  make_gram<V, N>(model, pack, gram);
  if (out.frobenius) put(out.frobenius, least_factor * frobenius_of<V, N>(model, pack, good, gram));
  if (!singular) return;
  simd::Extremes<V> found = extremes_of<V, N>(model, pack, good, det, gram);
  found.least = found.least * least_factor;
  if (out.condition)
    put(out.condition, min(V(1), sqrt(max(V(0), found.least) / (found.greatest + V(kTiny)))));
  if (out.smallest) put(out.smallest, sqrt(max(V(0), found.least)));
  put(out.softest, found.least);
  put(out.stiffest, found.greatest);
}

template <class V, int N, class Legs>
inline void store_columns(const KernelModel& model, const Pack<V, Legs>& pack,
                          const KernelOutput& out, int i) {
  if (out.drives)
    for_drives<Legs>(
        model, [&](int d) { Lanes<V>::store(out.drives + d * out.stride + i, pack.place[d]); });
  if (out.jacobian)
    for_drives<Legs>(model, [&](int d) {
#pragma GCC unroll 8
      for (int k = 0; k < N; ++k)
        Lanes<V>::store(out.jacobian + (d * N + k) * out.stride + i, entry<N>(model, pack, d, k));
    });
}

}  // namespace polyglide::batch::detail
