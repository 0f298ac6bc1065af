#pragma once

#include <cmath>

#if defined(__x86_64__)
#include <xsimd/xsimd.hpp>
#endif

/// One set of words for a plain number and for a register of them, so that a kernel is
/// written once. A V is `double` or `xsimd::batch<double, architecture>`; every
/// architecture makes types, and so symbols, of its own. The words for a batch are those
/// of xsimd, found by the type of their arguments.
namespace polyglide::simd {

template <class V>
struct Lanes {
  static constexpr int count = V::size;
  static V load(const double* from) { return V::load_unaligned(from); }
  static void store(double* to, const V& value) { value.store_unaligned(to); }
};

template <>
struct Lanes<double> {
  static constexpr int count = 1;
  static double load(const double* from) { return *from; }
  static void store(double* to, double value) { *to = value; }
};

inline double sqrt(double value) { return std::sqrt(value); }
inline double abs(double value) { return std::fabs(value); }
inline double nearbyint(double value) { return std::nearbyint(value); }
inline double atan2(double y, double x) { return std::atan2(y, x); }
inline double min(double a, double b) { return b < a ? b : a; }
inline double max(double a, double b) { return a < b ? b : a; }
inline double select(bool chosen, double a, double b) { return chosen ? a : b; }
inline bool any(bool mask) { return mask; }

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
