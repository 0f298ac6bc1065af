#pragma once

#include <cmath>

namespace polyglide {

/// 1/κ = smallest over largest singular value of J with three columns, from the
/// entries of JᵀJ in closed form; 0 when singular or not finite. Error about 1e-8
/// (JᵀJ squares κ). Branch-free, so that loops over it vectorise.
///
/// The largest eigenvalue is q + 2p cos(θ/3) with r = cos θ. Its arc cosine is
/// avoided: with w = cos(θ/2) and k = cos(θ/6), 4k³ - 3k = w is well conditioned on
/// [0, 1] and Newton finds k in three steps; cos(θ/3) = 2k² - 1. The other two
/// follow from the trace and the determinant.
[[nodiscard]] inline double inverse_condition(double xx, double xy, double xz, double yy, double yz,
                                              double zz) {
  constexpr double kTiny = 1e-300;
  const double q = (xx + yy + zz) / 3;
  const double a = xx - q, b = yy - q, c = zz - q;
  const double off = xy * xy + xz * xz + yz * yz;
  const double p = std::sqrt((a * a + b * b + c * c + 2 * off) / 6);
  const double deviator = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
  const double det = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  const double unbounded = deviator / (2 * p * p * p + kTiny);
  // Clamped to [-1, 1] without comparisons: the compiler would split the paths.
  const double r = (std::abs(unbounded + 1) - std::abs(unbounded - 1)) / 2;
  const double w = std::sqrt((1 + r) / 2);
  double k = 0.8660254037844386 + 0.1339745962155614 * w;
  k -= ((4 * k * k - 3) * k - w) / (12 * k * k - 3);
  k -= ((4 * k * k - 3) * k - w) / (12 * k * k - 3);
  k -= ((4 * k * k - 3) * k - w) / (12 * k * k - 3);
  const double largest = q + 2 * p * (2 * k * k - 1);
  const double sum = 3 * q - largest, product = (det > 0 ? det : 0) / (largest + kTiny);
  const double under = sum * sum - 4 * product;
  const double middle = (sum + std::sqrt(under > 0 ? under : 0)) / 2;
  const double square = product / (middle * largest + kTiny);
  // Not-a-number compares false and ends as 0.
  const double inverse = std::sqrt(square > 0 ? square : 0);
  return inverse < 1 ? inverse : 1;
}

}  // namespace polyglide
