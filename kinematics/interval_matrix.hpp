#pragma once

#include <Eigen/Dense>

#include "kinematics/interval.hpp"

namespace polyglide {

// All of them need UpwardRounding.

/// The numbers as intervals of no width.
[[nodiscard]] IntervalMatrix exactly(const Eigen::MatrixXd& a);

/// Product of a matrix of numbers, taken as exact, with one of intervals.
[[nodiscard]] IntervalMatrix product(const Eigen::MatrixXd& a, const IntervalMatrix& b);
[[nodiscard]] IntervalMatrix product(const IntervalMatrix& a, const Eigen::MatrixXd& b);

/// The matrix of middles.
[[nodiscard]] Eigen::MatrixXd middle(const IntervalMatrix& a);

/// Upper bound of the 2-norm of every matrix inside: sqrt(‖A‖₁ ‖A‖∞).
[[nodiscard]] double norm_bound(const IntervalMatrix& a);

/// Bounds of the least and the greatest singular value of every m×n matrix inside, m >= n. With
/// the singular vectors of the middle as U and V, Uᵀ A V is nearly diagonal; Weyl bounds what
/// is left, and the norms of U and V, which are orthogonal but for rounding, are bounded as well.
struct SingularValues {
  double least_lower = 0;  ///< > 0 proves full column rank of every matrix inside
  double greatest_upper = 0;
};
[[nodiscard]] SingularValues singular_value_bounds(const IntervalMatrix& a);

/// Sign of the determinant of every matrix inside; 0 = not decided. Square.
[[nodiscard]] int determinant_sign(const IntervalMatrix& a);

}  // namespace polyglide
