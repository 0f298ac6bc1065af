#pragma once

#include <cmath>
#include <type_traits>

#if defined(__x86_64__)
#include <xsimd/xsimd.hpp>
#endif

/// One set of words for a plain number and for a register of them, so that a kernel is
/// written once. A V is `double` or `xsimd::batch<double, architecture>`; every
/// architecture makes types, and so symbols, of its own. The words for a batch are those
/// of xsimd, found by the type of their arguments.
namespace polyglide::simd {

template <class V>
struct Lanes;

template <>
struct Lanes<double> {
  static constexpr int count = 1;
  static double load(const double* from) { return *from; }
  static void store(double* to, double value) { *to = value; }
  static void store_whole(int* to, double value) { *to = static_cast<int>(value); }
  static void store_signs(signed char* to, double value) {
    *to = static_cast<signed char>((value > 0) - (value < 0));
  }
};

template <class V>
struct Lanes {
  static constexpr int count = V::size;
  static V load(const double* from) { return V::load_unaligned(from); }
  static void store(double* to, const V& value) { value.store_unaligned(to); }
  /// Whole numbers, and signs as -1, 0, 1.
  static void store_whole(int* to, const V& value) {
    alignas(64) double values[count];
    value.store_aligned(values);
    for (int i = 0; i < count; ++i) to[i] = static_cast<int>(values[i]);
  }
  static void store_signs(signed char* to, const V& value) {
    alignas(64) double values[count];
    value.store_aligned(values);
    // Not by Lanes<double>, whose symbols other instruction sets share.
    for (int i = 0; i < count; ++i)
      to[i] = static_cast<signed char>((values[i] > 0) - (values[i] < 0));
  }
};

inline double sqrt(double value) { return std::sqrt(value); }
inline double abs(double value) { return std::fabs(value); }
inline double nearbyint(double value) { return std::nearbyint(value); }
inline double atan2(double y, double x) { return std::atan2(y, x); }
// As the registers': b when one is not a number.
inline double min(double a, double b) { return a < b ? a : b; }
inline double max(double a, double b) { return a > b ? a : b; }
inline double select(bool chosen, double a, double b) { return chosen ? a : b; }
inline bool any(bool mask) { return mask; }

/// Two registers side by side as one: while one waits for its last result, the other computes.
template <class V>
struct Twice {
  V a, b;
  Twice() = default;
  explicit Twice(double value) : a(value), b(value) {}
  Twice(const V& first, const V& second) : a(first), b(second) {}
};

template <class Mask>
struct TwiceMask {
  Mask a, b;
};

template <class V>
struct Lanes<Twice<V>> {
  static constexpr int half = Lanes<V>::count, count = 2 * half;
  static Twice<V> load(const double* from) {
    return {Lanes<V>::load(from), Lanes<V>::load(from + half)};
  }
  static void store(double* to, const Twice<V>& value) {
    Lanes<V>::store(to, value.a);
    Lanes<V>::store(to + half, value.b);
  }
  static void store_whole(int* to, const Twice<V>& value) {
    Lanes<V>::store_whole(to, value.a);
    Lanes<V>::store_whole(to + half, value.b);
  }
  static void store_signs(signed char* to, const Twice<V>& value) {
    Lanes<V>::store_signs(to, value.a);
    Lanes<V>::store_signs(to + half, value.b);
  }
};

template <class V>
inline Twice<V> operator+(const Twice<V>& x, const Twice<V>& y) {
  return {x.a + y.a, x.b + y.b};
}
template <class V>
inline Twice<V> operator-(const Twice<V>& x, const Twice<V>& y) {
  return {x.a - y.a, x.b - y.b};
}
template <class V>
inline Twice<V> operator*(const Twice<V>& x, const Twice<V>& y) {
  return {x.a * y.a, x.b * y.b};
}
template <class V>
inline Twice<V> operator/(const Twice<V>& x, const Twice<V>& y) {
  return {x.a / y.a, x.b / y.b};
}
template <class V>
inline auto operator<(const Twice<V>& x, const Twice<V>& y) {
  return TwiceMask{x.a < y.a, x.b < y.b};
}
template <class V>
inline auto operator>(const Twice<V>& x, const Twice<V>& y) {
  return TwiceMask{x.a > y.a, x.b > y.b};
}
template <class V>
inline auto operator<=(const Twice<V>& x, const Twice<V>& y) {
  return TwiceMask{x.a <= y.a, x.b <= y.b};
}
template <class V>
inline auto operator>=(const Twice<V>& x, const Twice<V>& y) {
  return TwiceMask{x.a >= y.a, x.b >= y.b};
}
template <class V>
inline auto operator==(const Twice<V>& x, const Twice<V>& y) {
  return TwiceMask{x.a == y.a, x.b == y.b};
}
template <class M>
inline TwiceMask<M> operator&(const TwiceMask<M>& x, const TwiceMask<M>& y) {
  return {M(x.a & y.a), M(x.b & y.b)};
}
template <class M>
inline TwiceMask<M> operator|(const TwiceMask<M>& x, const TwiceMask<M>& y) {
  return {M(x.a | y.a), M(x.b | y.b)};
}
template <class M>
inline TwiceMask<M> operator!(const TwiceMask<M>& x) {
  return {M(!x.a), M(!x.b)};
}
template <class M>
inline bool any(const TwiceMask<M>& x) {
  return any(M(x.a | x.b));
}
template <class M, class V>
inline Twice<V> select(const TwiceMask<M>& chosen, const Twice<V>& x, const Twice<V>& y) {
  return {select(chosen.a, x.a, y.a), select(chosen.b, x.b, y.b)};
}
template <class V>
inline Twice<V> sqrt(const Twice<V>& x) {
  return {sqrt(x.a), sqrt(x.b)};
}
template <class V>
inline Twice<V> abs(const Twice<V>& x) {
  return {abs(x.a), abs(x.b)};
}
template <class V>
inline Twice<V> nearbyint(const Twice<V>& x) {
  return {nearbyint(x.a), nearbyint(x.b)};
}
template <class V>
inline Twice<V> atan2(const Twice<V>& y, const Twice<V>& x) {
  return {atan2(y.a, x.a), atan2(y.b, x.b)};
}
template <class V>
inline Twice<V> min(const Twice<V>& x, const Twice<V>& y) {
  return {min(x.a, y.a), min(x.b, y.b)};
}
template <class V>
inline Twice<V> max(const Twice<V>& x, const Twice<V>& y) {
  return {max(x.a, y.a), max(x.b, y.b)};
}

/// What small kernels compute with: two registers where the processor has enough of them.
template <class V>
using WideOf = std::conditional_t<(Lanes<V>::count > 2), Twice<V>, V>;

template <class V>
using MaskOf = decltype(V(0) < V(0));

constexpr double kTiny = 1e-300;   // keeps 0/0 out of code without branches
constexpr double kSmall = 1e-180;  // whose inverse root can still be cubed

/// √x and 1/√x together, 1e-190 < x < 1e300. AVX-512 starts from its table of 14 bits and doubles
/// them twice (Goldschmidt), which leaves the slow unit for roots free; error below 4e-16.
template <class V>
struct Root {
  V root, inverse;
};
template <class V>
inline Root<V> root_of(const V& x) {
  const V root = sqrt(x);
  return {root, V(1) / root};
}
#if defined(__AVX512F__)
inline Root<xsimd::batch<double, xsimd::avx512dq>> root_of(
    const xsimd::batch<double, xsimd::avx512dq>& x) {
  using V = xsimd::batch<double, xsimd::avx512dq>;
  const V start = _mm512_rsqrt14_pd(x);
  V root = x * start, half = V(0.5) * start;
  for (int k = 0; k < 2; ++k) {
    const V error = V(0.5) - root * half;
    root = root + root * error;
    half = half + half * error;
  }
  return {root, half + half};
}
#endif
template <class V>
inline Root<Twice<V>> root_of(const Twice<V>& x) {
  const Root<V> a = root_of(x.a), b = root_of(x.b);
  return {{a.root, b.root}, {a.inverse, b.inverse}};
}

/// Sine and cosine: the angle less the nearest quarter turns, then Taylor's series up to
/// π/4. Absolute error below 3e-16 for |angle| < 1e5 rad.
template <class V>
inline void sincos(const V& angle, V& sine, V& cosine) {
  constexpr double kHigh = 1.5707963267341256, kMiddle = 6.0771005063039e-11,
                   kLow = 2.0222662487959506e-21;  // π/2, its first two parts 33 bits long
  const V turns = nearbyint(angle * V(0.6366197723675814));
  const V x = ((angle - turns * V(kHigh)) - turns * V(kMiddle)) - turns * V(kLow);
  const V y = x * x;
  V s(-1.0 / 1307674368000), c(1.0 / 20922789888000);
  for (double factor :
       {1.0 / 6227020800, -1.0 / 39916800, 1.0 / 362880, -1.0 / 5040, 1.0 / 120, -1.0 / 6})
    s = s * y + V(factor);
  for (double factor : {-1.0 / 87178291200, 1.0 / 479001600, -1.0 / 3628800, 1.0 / 40320,
                        -1.0 / 720, 1.0 / 24, -1.0 / 2})
    c = c * y + V(factor);
  s = x + x * y * s;
  c = V(1) + y * c;
  // Quarter turns modulo four, as -2 … 2.
  const V quarter = turns - V(4) * nearbyint(turns * V(0.25));
  const auto odd = abs(quarter) == V(1);
  const V first = select(odd, c, s), second = select(odd, s, c);
  const auto low = quarter<V(-0.5), far = abs(quarter)> V(1.5);
  // quarter 0: (s, c), 1: (c, -s), ±2: (-s, -c), -1: (-c, s).
  sine = select(far, V(0) - first, select(low, V(0) - first, first));
  cosine = select(far, V(0) - second, select(quarter > V(0.5), V(0) - second, second));
}

}  // namespace polyglide::simd
