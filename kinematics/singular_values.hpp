#pragma once

#include "kinematics/simd.hpp"

/// Extreme singular values of small Jacobians, one per lane of V. The fast way takes
/// the extreme eigenvalues of JᵀJ; lanes in which that loses digits (eigenvalues that
/// nearly coincide, κ above 300) are `doubtful` and are to be done again by
/// one_sided_jacobi(), which keeps them all. Needs no memory but the stack.
namespace polyglide::simd {

/// Least and greatest eigenvalue of JᵀJ = squares of the extreme singular values of J.
template <class V>
struct Extremes {
  V least, greatest;
  MaskOf<V> doubtful;
};

/// cos(2/3 · arccos w) on 0 <= w <= 1: analytic there, so a polynomial of degree 17 in
/// 2w - 1 gives it to 2e-16 (Chebyshev interpolation in 50 digits).
template <class V>
inline V cosine_of_two_thirds(const V& w) {
  constexpr double even[]{
      0.7660444431189779,      -0.015509188436466538,   -0.00050412469165532861,
      -2.8919930996008654e-05, -2.0358969691361489e-06, -1.5946448920768576e-07,
      -1.3482454942697049e-08, -1.0522633347918922e-09, -1.6368329253261365e-10};
  constexpr double odd[]{0.24740906632285342,    0.0024663528150652356,  0.00011642545332376988,
                         7.5410755286393022e-06, 5.6416444921452828e-07, 4.5826101529351644e-08,
                         3.9822740378228916e-09, 3.0922539839713988e-10, 5.1178745156550326e-11};
  const V u = w + w - V(1), square = u * u;
  V p(even[8]), q(odd[8]);
#pragma GCC unroll 8
  for (int k = 7; k >= 0; --k) {
    p = p * square + V(even[k]);
    q = q * square + V(odd[k]);
  }
  return p + u * q;
}

// Least over greatest eigenvalue below which JᵀJ is too rough.
constexpr double kIllConditioned = 1e-5;

/// Eigenvalues of a symmetric 3×3 matrix whose determinant is known: the greatest is
/// q + 2p cos(θ/3), r = cos θ (Smith 1961); with w = cos(θ/2) this is f(w). The other two
/// follow from trace and determinant.
template <class V>
[[gnu::always_inline]] inline Extremes<V> extremes3(const V (&g)[3][3], const V& determinant) {
  const V sum3 = g[0][0] + g[1][1] + g[2][2], q = sum3 * V(1.0 / 3);
  const V a = g[0][0] - q, b = g[1][1] - q, c = g[2][2] - q;
  const V xy = g[0][1], xz = g[0][2], yz = g[1][2];
  const V p2 = (a * a + b * b + c * c) * V(1.0 / 6) + (xy * xy + xz * xz + yz * yz) * V(1.0 / 3);
  const auto [p, inverse] = root_of(p2 + V(kSmall));
  const V deviator = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
  const V r = max(V(-1), min(V(1), V(0.5) * deviator * inverse * inverse * inverse));
  const V w = sqrt(V(0.5) + V(0.5) * r);
  const V greatest = q + V(2) * p * cosine_of_two_thirds(w);
  const V sum = sum3 - greatest, product = determinant / (greatest + V(kTiny));
  const V under = max(V(0), sum * sum - V(4) * product);
  const V least = V(2) * product / (sum + sqrt(under) + V(kTiny));
  // Two eigenvalues that meet: the roots of w and `under` lose half the digits.
  return {least, greatest,
          MaskOf<V>((w < V(1e-3)) | (under < V(1e-6) * sum * sum) |
                    !(least >= V(kIllConditioned) * greatest))};
}

/// The same for 2×2, without cancellation.
template <class V>
inline Extremes<V> extremes2(const V (&g)[2][2], const V& determinant) {
  const V half = V(0.5) * (g[0][0] - g[1][1]);
  const V greatest = V(0.5) * (g[0][0] + g[1][1]) + sqrt(half * half + g[0][1] * g[0][1]);
  const V least = determinant / (greatest + V(kTiny));
  return {least, greatest, MaskOf<V>(!(least >= V(kIllConditioned) * greatest))};
}

/// Householder reduction of a symmetric matrix to tridiagonal form: its diagonal, and
/// the squares of the entries beside it.
template <class V, int N>
inline void tridiagonal(V (&g)[N][N], V (&diagonal)[N], V (&square)[N - 1]) {
#pragma GCC unroll 8
  for (int k = 0; k < N - 2; ++k) {
    V rest(0);
#pragma GCC unroll 8
    for (int i = k + 2; i < N; ++i) rest = rest + g[i][k] * g[i][k];
    const V head = g[k + 1][k], norm2 = rest + head * head;
    const V root = sqrt(norm2), length = select(head > V(0), V(0) - root, root);
    square[k] = norm2;
    // v = (head - length, rest…), β = 2/vᵀv; nothing to reflect where the rest is zero.
    const V scale = norm2 - length * head;
    const V beta = select(rest > V(1e-32) * norm2, V(1) / (scale + V(kTiny)), V(0));
    V v[N], p[N];
    v[k + 1] = head - length;
#pragma GCC unroll 8
    for (int i = k + 2; i < N; ++i) v[i] = g[i][k];
    V along(0);
#pragma GCC unroll 8
    for (int i = k + 1; i < N; ++i) {
      V sum(0);
#pragma GCC unroll 8
      for (int j = k + 1; j < N; ++j) sum = sum + (j < i ? g[i][j] : g[j][i]) * v[j];
      p[i] = beta * sum;
      along = along + p[i] * v[i];
    }
    const V shift = V(0.5) * beta * along;
#pragma GCC unroll 8
    for (int i = k + 1; i < N; ++i) p[i] = p[i] - shift * v[i];
#pragma GCC unroll 8
    for (int i = k + 1; i < N; ++i)
#pragma GCC unroll 8
      for (int j = k + 1; j <= i; ++j) g[i][j] = g[i][j] - v[i] * p[j] - p[i] * v[j];
  }
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) diagonal[i] = g[i][i];
  square[N - 2] = g[N - 1][N - 2] * g[N - 1][N - 2];
}

/// Laguerre's iteration for one extreme root of det(T - xI), from outside, where it
/// converges monotonically and cubically to a simple root. A lane that is done is frozen,
/// so that no lane depends on its neighbours.
template <class V, int N>
struct Laguerre {
  V x, before, first = V(0), second = V(0);  ///< root, last step, derivatives there
  MaskOf<V> done;

  explicit Laguerre(const V& start) : x(start), before(0), done(V(0) > V(1)) {}

  void step(const V (&diagonal)[N], const V (&square)[N - 1]) {
    V p0(1), p = diagonal[0] - x, d0(0), d(-1), s0(0), s(0);
#pragma GCC unroll 8
    for (int k = 1; k < N; ++k) {
      const V a = diagonal[k] - x, b = square[k - 1];
      const V p1 = a * p - b * p0, d1 = a * d - p - b * d0, s1 = a * s - (d + d) - b * s0;
      p0 = p, d0 = d, s0 = s;
      p = p1, d = d1, s = s1;
    }
    const V under = max(V(0), V((N - 1.0) * (N - 1)) * d * d - V(N * (N - 1.0)) * p * s);
    const V root = sqrt(under), below = d + select(d < V(0), V(0) - root, root);
    const V move = V(double(N)) * p / (below + select(d < V(0), V(-kTiny), V(kTiny)));
    first = select(done, first, d);
    second = select(done, second, s);
    x = select(done, x, x - move);
    // Cubic convergence: the next step would be about move⁴/before³.
    const V size = abs(move), square_of_size = size * size;
    done = done | (square_of_size * square_of_size <= V(1e-16) * before * before * before);
    before = select(done, before, size);
  }

  /// The root may be multiple: digits are lost in the gaps to the others, of which
  /// p''/2p' is the sum of the inverses.
  MaskOf<V> doubtful() const { return !(abs(first + first) >= V(1e-4) * abs(second)); }
};

/// Extreme eigenvalues of a positive semidefinite N×N matrix, lower triangle; destroys it.
template <class V, int N>
inline Extremes<V> extremes(V (&g)[N][N]) {
  V trace(0);
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) trace = trace + g[i][i];
  const V scale = V(1) / (trace + V(kTiny));
  V diagonal[N], square[N - 1];
  tridiagonal<V, N>(g, diagonal, square);
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) diagonal[i] = diagonal[i] * scale;
#pragma GCC unroll 8
  for (int i = 0; i + 1 < N; ++i) square[i] = square[i] * (scale * scale);
  // The greatest is at most the trace, 1 here, and at most Frobenius' norm.
  V norm2(0);
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) norm2 = norm2 + diagonal[i] * diagonal[i];
#pragma GCC unroll 8
  for (int i = 0; i + 1 < N; ++i) norm2 = norm2 + V(2) * square[i];
  // Where all nearly coincide, steps from outside land among them.
  const auto alike = norm2 < V(1.0 / N + 1e-6);
  Laguerre<V, N> low(V(0)), high(sqrt(norm2));
  constexpr int kSteps = 10;
  for (int k = 0; k < kSteps && any(!(low.done & high.done)); ++k) {
    low.step(diagonal, square);
    high.step(diagonal, square);
  }
  return {low.x * trace, high.x * trace,
          MaskOf<V>(alike | low.doubtful() | high.doubtful() | !(low.done & high.done) |
                    !(low.x >= V(kIllConditioned) * high.x))};
}

/// Squares of all singular values, in short.
template <class V>
struct Spectrum {
  V least, greatest, sum, sum_of_inverses;
};

/// Squares of the singular values of a matrix by one-sided Jacobi rotations of its
/// columns (Hestenes 1958), eight sweeps: to rounding, whatever coincides. Runs in
/// `columns`[column][row], which it destroys.
template <class V, int kRows, int kColumns>
[[gnu::noinline]] Spectrum<V> one_sided_jacobi(V (&c)[kColumns][kRows], int rows, int columns) {
  constexpr int kSweeps = 8;
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int p = 0; p + 1 < columns; ++p)
      for (int q = p + 1; q < columns; ++q) {
        V alpha(0), beta(0), gamma(0);
        for (int i = 0; i < rows; ++i) {
          alpha = alpha + c[p][i] * c[p][i];
          beta = beta + c[q][i] * c[q][i];
          gamma = gamma + c[p][i] * c[q][i];
        }
        const V half = V(0.5) * (beta - alpha);
        const V root = sqrt(half * half + gamma * gamma) + V(kTiny);
        const V t = gamma / (half + select(half < V(0), V(0) - root, root));
        const V cosine = V(1) / sqrt(V(1) + t * t), sine = t * cosine;
        for (int i = 0; i < rows; ++i) {
          const V first = c[p][i], second = c[q][i];
          c[p][i] = cosine * first - sine * second;
          c[q][i] = sine * first + cosine * second;
        }
      }
  Spectrum<V> found{V(0), V(0), V(0), V(0)};
  for (int p = 0; p < columns; ++p) {
    V norm2(0);
    for (int i = 0; i < rows; ++i) norm2 = norm2 + c[p][i] * c[p][i];
    found.least = p == 0 ? norm2 : min(found.least, norm2);
    found.greatest = p == 0 ? norm2 : max(found.greatest, norm2);
    found.sum = found.sum + norm2;
    found.sum_of_inverses = found.sum_of_inverses + V(1) / (norm2 + V(kTiny));
  }
  return found;
}

/// Symmetric positive definite G = L D Lᵀ, lower triangle of `g`, in place: L below
/// the diagonal, 1/D on it. False lanes: a pivot was not positive.
template <class V, int N>
inline MaskOf<V> factorise(V (&g)[N][N]) {
  MaskOf<V> definite = V(0) < V(1);
#pragma GCC unroll 8
  for (int j = 0; j < N; ++j) {
    V scaled[N];
    V pivot = g[j][j];
#pragma GCC unroll 8
    for (int k = 0; k < j; ++k) {
      // Row j holds L·D so far: divide by the pivot only once.
      scaled[k] = g[j][k] * g[k][k];
      pivot = pivot - g[j][k] * scaled[k];
    }
    definite = definite & (pivot > V(0));
    const V inverse = V(1) / (pivot + V(kTiny));
#pragma GCC unroll 8
    for (int i = j + 1; i < N; ++i) {
      V sum = g[i][j];
#pragma GCC unroll 8
      for (int k = 0; k < j; ++k) sum = sum - g[i][k] * scaled[k];
      g[i][j] = sum;
    }
#pragma GCC unroll 8
    for (int k = 0; k < j; ++k) g[j][k] = scaled[k];
    g[j][j] = inverse;
  }
  return definite;
}

/// Solves G x = b in place with the factors.
template <class V, int N>
inline void solve_factorised(const V (&g)[N][N], V (&b)[N]) {
#pragma GCC unroll 8
  for (int i = 1; i < N; ++i)
#pragma GCC unroll 8
    for (int k = 0; k < i; ++k) b[i] = b[i] - g[i][k] * b[k];
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) b[i] = b[i] * g[i][i];
#pragma GCC unroll 8
  for (int i = N - 2; i >= 0; --i)
#pragma GCC unroll 8
    for (int k = i + 1; k < N; ++k) b[i] = b[i] - g[k][i] * b[k];
}

/// Trace of G⁻¹ from the factors: Σ (L⁻¹)ᵢⱼ²/dᵢ.
template <class V, int N>
inline V trace_of_inverse(const V (&g)[N][N]) {
  V trace(0);
#pragma GCC unroll 8
  for (int j = 0; j < N; ++j) {
    V column[N];
    column[j] = V(1);
    trace = trace + g[j][j];
#pragma GCC unroll 8
    for (int i = j + 1; i < N; ++i) {
      V sum = V(0) - g[i][j];
#pragma GCC unroll 8
      for (int k = j + 1; k < i; ++k) sum = sum - g[i][k] * column[k];
      column[i] = sum;
      trace = trace + sum * sum * g[i][i];
    }
  }
  return trace;
}

/// Determinant by elimination with row exchanges; destroys the matrix. Its sign is right
/// unless the matrix is singular to rounding.
template <class V, int N>
inline V determinant(V (&m)[N][N]) {
  V result(1);
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k) {
#pragma GCC unroll 8
    for (int i = k + 1; i < N; ++i) {
      const auto larger = abs(m[i][k]) > abs(m[k][k]);
#pragma GCC unroll 8
      for (int j = k; j < N; ++j) {
        const V up = m[i][j], down = m[k][j];
        m[k][j] = select(larger, up, down);
        m[i][j] = select(larger, V(0) - down, up);
      }
    }
    result = result * m[k][k];
    const V inverse = V(1) / (m[k][k] + select(m[k][k] == V(0), V(kTiny), V(0)));
#pragma GCC unroll 8
    for (int i = k + 1; i < N; ++i) {
      const V factor = m[i][k] * inverse;
#pragma GCC unroll 8
      for (int j = k + 1; j < N; ++j) m[i][j] = m[i][j] - factor * m[k][j];
    }
  }
  return result;
}

/// Inverse by Gauss and Jordan's elimination with row exchanges; destroys the matrix. Not
/// finite where the matrix is singular.
template <class V, int N>
inline void invert(V (&m)[N][N], V (&inverse)[N][N]) {
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i)
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) inverse[i][j] = V(i == j ? 1 : 0);
  for (int k = 0; k < N; ++k) {
    for (int i = k + 1; i < N; ++i) {
      const auto larger = abs(m[i][k]) > abs(m[k][k]);
#pragma GCC unroll 8
      for (int j = 0; j < N; ++j) {
        const V a = m[i][j], b = m[k][j], c = inverse[i][j], d = inverse[k][j];
        m[k][j] = select(larger, a, b), m[i][j] = select(larger, b, a);
        inverse[k][j] = select(larger, c, d), inverse[i][j] = select(larger, d, c);
      }
    }
    const V factor = V(1) / m[k][k];
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) {
      m[k][j] = m[k][j] * factor;
      inverse[k][j] = inverse[k][j] * factor;
    }
    for (int i = 0; i < N; ++i) {
      if (i == k) continue;
      const V part = m[i][k];
#pragma GCC unroll 8
      for (int j = 0; j < N; ++j) {
        m[i][j] = m[i][j] - part * m[k][j];
        inverse[i][j] = inverse[i][j] - part * inverse[k][j];
      }
    }
  }
}

}  // namespace polyglide::simd
