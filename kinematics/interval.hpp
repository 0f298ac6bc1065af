#pragma once

#include <algorithm>
#include <array>
#include <boost/numeric/interval.hpp>
#include <cmath>
#include <limits>
#include <vector>

// Only sources compiled with -frounding-math may do interval arithmetic: else the compiler folds
// constants in the wrong direction, and bounds are bounds no longer.
#if defined(__GNUC__) && !defined(__clang__) && !defined(__ROUNDING_MATH__)
#error "interval.hpp needs -frounding-math: add the source to POLYGLIDE_INTERVAL_SOURCES"
#endif
#ifdef __FAST_MATH__
#error "interval.hpp does not work with -ffast-math"
#endif

namespace polyglide {

/// A closed interval of reals; every operation encloses the exact results. Boost's default rounding
/// policy, which is the one that is right; `unprotected` only leaves out setting the rounding
/// direction at every operation. So: valid only while an UpwardRounding lives in this thread.
/// Bounds are decided by lower() and upper(); what is not a number decides nothing.
using Interval = boost::numeric::interval_lib::unprotect<boost::numeric::interval<double>>::type;

/// Rounds upward in this thread as long as it lives, then as before.
class UpwardRounding {
 public:
  UpwardRounding() = default;
  UpwardRounding(const UpwardRounding&) = delete;
  UpwardRounding& operator=(const UpwardRounding&) = delete;

 private:
  boost::numeric::interval<double>::traits_type::rounding rounding_;
};

/// Some number inside: near the middle, whatever the rounding.
[[nodiscard]] inline double middle(const Interval& x) {
  return std::clamp(x.lower() / 2 + x.upper() / 2, x.lower(), x.upper());
}

/// Largest absolute value.
[[nodiscard]] inline double magnitude(const Interval& x) {
  return std::max(std::abs(x.lower()), std::abs(x.upper()));
}

/// Smallest absolute value.
[[nodiscard]] inline double mignitude(const Interval& x) {
  if (x.lower() > 0) return x.lower();
  return x.upper() < 0 ? -x.upper() : 0;
}

/// Upper bound of how far any number inside is from middle(x).
[[nodiscard]] inline double radius(const Interval& x) { return magnitude(x - middle(x)); }

/// `x` moved outward by `steps` neighbouring numbers at both ends.
[[nodiscard]] inline Interval outward(double lower, double upper, int steps) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (int i = 0; i < steps; ++i) {
    lower = std::nextafter(lower, -kInfinity);
    upper = std::nextafter(upper, kInfinity);
  }
  return {lower, upper};
}

/// Square root of the part that is not negative. One step outward covers every
/// rounding direction, because the root is correctly rounded.
[[nodiscard]] inline Interval root(const Interval& x) {
  const Interval enclosed =
      outward(std::sqrt(std::max(0.0, x.lower())), std::sqrt(std::max(0.0, x.upper())), 1);
  return {std::max(0.0, enclosed.lower()), enclosed.upper()};
}

/// Cosine of angles in [-6, 6] rad; beyond them [-1, 1]. The library's cosine is off by less than
/// the four steps allowed here.
[[nodiscard]] inline Interval cosine(const Interval& x) {
  constexpr double kPi = 3.141592653589793;  // just below pi
  if (!(x.lower() >= -6 && x.upper() <= 6)) return {-1, 1};
  const double a = std::cos(x.lower()), b = std::cos(x.upper());
  const Interval ends = outward(std::min(a, b), std::max(a, b), 4);
  double lower = std::max(-1.0, ends.lower()), upper = std::min(1.0, ends.upper());
  if (x.lower() <= 0 && x.upper() >= 0) upper = 1;
  constexpr double kAbove = 3.1415926535897936;
  for (int way : {-1, 1}) {
    const double near = way > 0 ? kPi : -kAbove, far = way > 0 ? kAbove : -kPi;
    if (x.lower() <= far && x.upper() >= near) lower = -1;
  }
  return {lower, upper};
}

/// Sine of angles in [-4, 4] rad; beyond them [-1, 1].
[[nodiscard]] inline Interval sine(const Interval& x) {
  // Half pi lies between its two neighbouring numbers; cosine takes what is left.
  return cosine(x - Interval(1.5707963267948966, 1.5707963267948968));
}

/// Angle of the vectors (x, y), in [-π, π]; all of it where they may have none, or cross the half
/// turn. The library's arctangent is off by less than the four steps allowed here.
[[nodiscard]] inline Interval angle_of(const Interval& x, const Interval& y) {
  constexpr double kAbove = 3.1415926535897936;  // just above pi
  if (!(x.lower() > 0 || y.lower() > 0 || y.upper() < 0)) return {-kAbove, kAbove};
  const std::array<double, 4> corners{
      std::atan2(y.lower(), x.lower()), std::atan2(y.lower(), x.upper()),
      std::atan2(y.upper(), x.lower()), std::atan2(y.upper(), x.upper())};
  const auto [least, most] = std::minmax_element(corners.begin(), corners.end());
  return outward(*least, *most, 4);
}

/// The common part; `a` where rounding left none.
[[nodiscard]] inline Interval common(const Interval& a, const Interval& b) {
  const double lower = std::max(a.lower(), b.lower()), upper = std::min(a.upper(), b.upper());
  return lower <= upper ? Interval(lower, upper) : a;
}

using IntervalVector = std::array<Interval, 3>;

template <typename A, typename B>
[[nodiscard]] Interval dot(const A& a, const B& b) {
  return Interval(a[0]) * b[0] + Interval(a[1]) * b[1] + Interval(a[2]) * b[2];
}

template <typename A, typename B>
[[nodiscard]] IntervalVector cross(const A& a, const B& b) {
  return {Interval(a[1]) * b[2] - Interval(a[2]) * b[1],
          Interval(a[2]) * b[0] - Interval(a[0]) * b[2],
          Interval(a[0]) * b[1] - Interval(a[1]) * b[0]};
}

[[nodiscard]] inline IntervalVector difference(const IntervalVector& a, const IntervalVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

[[nodiscard]] inline IntervalVector scaled(const IntervalVector& a, const Interval& factor) {
  return {a[0] * factor, a[1] * factor, a[2] * factor};
}

/// |a|²; tighter than dot(a, a), which forgets that both factors are the same.
[[nodiscard]] inline Interval squared_norm(const IntervalVector& a) {
  return square(a[0]) + square(a[1]) + square(a[2]);
}

/// Dense matrix of intervals, row by row.
class IntervalMatrix {
 public:
  IntervalMatrix(int rows, int cols)
      : rows_(rows), cols_(cols), entries_(static_cast<std::size_t>(rows) * cols, Interval(0.0)) {}
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int cols() const { return cols_; }
  Interval& operator()(int row, int col) { return entries_[at(row, col)]; }
  const Interval& operator()(int row, int col) const { return entries_[at(row, col)]; }

 private:
  [[nodiscard]] std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(row) * cols_ + col;
  }
  int rows_, cols_;
  std::vector<Interval> entries_;
};

}  // namespace polyglide
