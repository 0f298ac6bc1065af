#pragma once

#include <Eigen/Dense>
#include <cmath>

namespace polyglide {

/// JᵀJ of a Jacobian with three columns, summed row by row.
struct Gram3 {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  void add(double x, double y, double z) {
    xx += x * x;
    xy += x * y;
    xz += x * z;
    yy += y * y;
    yz += y * z;
    zz += z * z;
  }
};

/// 1/κ = smallest over largest singular value of J, from JᵀJ in closed form; 0
/// when singular or not finite. Error about 1e-8 (JᵀJ squares κ). Branch-free.
///
/// The largest eigenvalue is q + 2p cos(θ/3) with r = cos θ. Its arc cosine is
/// avoided: with w = cos(θ/2) and k = cos(θ/6), 4k³ - 3k = w is well conditioned on
/// [0, 1] and Newton finds k in three steps; cos(θ/3) = 2k² - 1. The other two
/// follow from the trace and the determinant.
[[nodiscard]] inline double inverse_condition(const Gram3& g) {
  const double q = (g.xx + g.yy + g.zz) / 3;
  const double a = g.xx - q, b = g.yy - q, c = g.zz - q;
  const double off = g.xy * g.xy + g.xz * g.xz + g.yz * g.yz;
  const double p = std::sqrt((a * a + b * b + c * c + 2 * off) / 6);
  const double deviator = a * (b * c - g.yz * g.yz) - g.xy * (g.xy * c - g.yz * g.xz) +
                          g.xz * (g.xy * g.yz - b * g.xz);
  const double det = g.xx * (g.yy * g.zz - g.yz * g.yz) - g.xy * (g.xy * g.zz - g.yz * g.xz) +
                     g.xz * (g.xy * g.yz - g.yy * g.xz);
  const double cube = 2 * p * p * p;
  double r = cube > 0 ? deviator / cube : 0;
  r = r > 1 ? 1 : r < -1 ? -1 : r;
  const double w = std::sqrt((1 + r) / 2);
  double k = 0.8660254037844386 + 0.1339745962155614 * w;
  for (int i = 0; i < 3; ++i) k -= ((4 * k * k - 3) * k - w) / (12 * k * k - 3);
  const double largest = q + 2 * p * (2 * k * k - 1);
  const double sum = 3 * q - largest, product = det > 0 ? det / largest : 0;
  const double under = sum * sum - 4 * product;
  const double middle = (sum + std::sqrt(under > 0 ? under : 0)) / 2;
  const double square = product / (middle * largest);
  return square > 0 && square < 2 ? std::sqrt(square < 1 ? square : 1) : 0;
}

/// The same for n columns, from JᵀJ by an eigenvalue solver.
template <int N>
[[nodiscard]] double inverse_condition(const Eigen::Matrix<double, N, N>& gram) {
  if (!gram.allFinite()) return 0;
  if constexpr (N == 1) return gram(0, 0) > 0 ? 1 : 0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver(gram, Eigen::EigenvaluesOnly);
  const double smallest = solver.eigenvalues()[0], largest = solver.eigenvalues()[N - 1];
  return smallest > 0 && largest > 0 ? std::sqrt(smallest / largest) : 0;
}

}  // namespace polyglide
