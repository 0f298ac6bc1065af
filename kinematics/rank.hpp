#pragma once

#include <Eigen/Core>
#include <vector>

namespace polyglide {

/// A = U diag(values) Vᵀ with all columns of U and V; values descending.
struct Svd {
  Eigen::MatrixXd u, v;
  Eigen::VectorXd values;
};

/// Singular value decomposition by LAPACK's dgesdd: on screw matrices as right as Jacobi's and
/// several times faster, while Eigen 3.4.0's BDCSVD is wrong on them. An empty matrix has
/// identities and no values. The one place where this is compiled.
/// @throws std::invalid_argument when an entry is not finite.
[[nodiscard]] Svd svd_of(const Eigen::MatrixXd& matrix);

/// Its values only.
[[nodiscard]] Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix);

/// Orthonormal basis of the columns' span, the columns being independent.
[[nodiscard]] Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& basis);

/// Indices of `count` rows that are independent, chosen by pivoting, ascending.
[[nodiscard]] std::vector<int> independent_rows(const Eigen::MatrixXd& matrix, Eigen::Index count);

/// A rank decided by the largest gap between neighbouring singular values.
struct RankDecision {
  int rank = 0;
  double gap = 0;       ///< smallest kept / largest dropped singular value, at most 1e16
  double smallest = 0;  ///< smallest kept singular value
  double largest = 0;   ///< largest singular value, 0 for an empty or zero matrix
  double noise = 0;     ///< largest dropped singular value, as part of the largest
};

/// Parts of the largest singular value between which a rank is decided. Nine-digit coordinates
/// leave values up to about 1e-8 where the exact machine has zeros; the smallest real ones met in
/// loop-closure Jacobians lie a few 1e-6 (axes 1° off).
struct RankScale {
  double noise = 1e-9;  ///< below it all is rounding
  double real = 1e-5;   ///< above it a value is not more real for being larger
};

/// Decides a rank from singular values in descending order.
///
/// Fixed thresholds fail at drawing precision; the ratio of neighbours does not. Ratios are
/// compared after values above `scale.real` of the largest have been taken as equally real and
/// values below `scale.noise` as equally noise, so that a small real value (5e-6) is not taken for
/// noise because it stands further below the others than above the noise of a nine-digit drawing. A
/// value above 1e-4 of the largest is never dropped. An empty or zero matrix has rank 0.
/// @param reference a value known to be real, in the same scale (0 = none): with
///        it everything can be dropped, so noise beside it has rank 0.
/// @param scale what counts as noise and as real in these values
[[nodiscard]] RankDecision decide_rank(const Eigen::VectorXd& singular_values, double reference = 0,
                                       const RankScale& scale = {});

/// Rank and kernel of a matrix.
struct Kernel {
  RankDecision decision;
  double pivot = 0;       ///< smallest kept pivot of the QR decomposition where that decided, else
                          ///< singular value: comparable between screened and confirmed kernels
  Eigen::MatrixXd basis;  ///< columns: orthonormal basis of the kernel, cols × (cols - rank)
};

/// Of the X that bring matrix·X nearest to `right`, column by column, the one of least norm.
/// @param weakest pivots below this part of the largest count as zero; 0: those of rounding only
[[nodiscard]] Eigen::MatrixXd least_squares(const Eigen::MatrixXd& matrix,
                                            const Eigen::MatrixXd& right, double weakest = 0);

/// Kernel, its rank decided by LAPACK's singular values. The basis comes from a pivoted QR
/// decomposition where that sees the same rank beyond doubt, else from the singular vectors.
/// A matrix without rows has the identity as kernel and the largest gap, 1e16.
/// @param reference as for decide_rank().
/// @throws std::invalid_argument when an entry is not finite.
/// Cost: about 25 µs for 18×20.
[[nodiscard]] Kernel kernel_of(const Eigen::MatrixXd& matrix, double reference = 0);

/// The same without singular values where the pivoted QR decomposition leaves no doubt (nothing
/// between 1e-10 and 1e-5 of the largest pivot): for postures on the way, which no verdict rests
/// on. `gap` and `smallest` are then those of the pivots.
/// Cost: about 8 µs for 18×20.
[[nodiscard]] Kernel screened_kernel(const Eigen::MatrixXd& matrix, double reference = 0);

/// Singular values only.
[[nodiscard]] RankDecision rank_of(const Eigen::MatrixXd& matrix, double reference = 0);

}  // namespace polyglide
