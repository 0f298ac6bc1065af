#include "kinematics/interval_matrix.hpp"

namespace polyglide {
namespace {

/// sqrt(‖A‖₁ ‖A‖∞) of the matrix of largest absolute values.
double norm_of_magnitudes(const IntervalMatrix& a) {
  Interval by_rows(0.0), by_cols(0.0);
  for (int r = 0; r < a.rows(); ++r) {
    Interval sum(0.0);
    for (int c = 0; c < a.cols(); ++c) sum += magnitude(a(r, c));
    by_rows = std::max(by_rows.upper(), sum.upper());
  }
  for (int c = 0; c < a.cols(); ++c) {
    Interval sum(0.0);
    for (int r = 0; r < a.rows(); ++r) sum += magnitude(a(r, c));
    by_cols = std::max(by_cols.upper(), sum.upper());
  }
  return root(by_rows * by_cols).upper();
}

/// Upper bound of ‖QᵀQ - I‖₂ for a matrix whose columns should be orthonormal.
double orthogonality_defect(const Eigen::MatrixXd& q) {
  const int n = static_cast<int>(q.cols());
  IntervalMatrix defect(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      Interval sum(i == j ? -1.0 : 0.0);
      for (Eigen::Index k = 0; k < q.rows(); ++k) sum += Interval(q(k, i)) * q(k, j);
      defect(i, j) = sum;
    }
  return norm_of_magnitudes(defect);
}

}  // namespace

IntervalMatrix exactly(const Eigen::MatrixXd& a) {
  IntervalMatrix result(static_cast<int>(a.rows()), static_cast<int>(a.cols()));
  for (int i = 0; i < result.rows(); ++i)
    for (int j = 0; j < result.cols(); ++j) result(i, j) = a(i, j);
  return result;
}

IntervalMatrix product(const Eigen::MatrixXd& a, const IntervalMatrix& b) {
  IntervalMatrix result(static_cast<int>(a.rows()), b.cols());
  for (int i = 0; i < result.rows(); ++i)
    for (int j = 0; j < result.cols(); ++j)
      for (int k = 0; k < b.rows(); ++k) result(i, j) += a(i, k) * b(k, j);
  return result;
}

IntervalMatrix product(const IntervalMatrix& a, const Eigen::MatrixXd& b) {
  IntervalMatrix result(a.rows(), static_cast<int>(b.cols()));
  for (int i = 0; i < result.rows(); ++i)
    for (int j = 0; j < result.cols(); ++j)
      for (int k = 0; k < a.cols(); ++k) result(i, j) += a(i, k) * b(k, j);
  return result;
}

Eigen::MatrixXd middle(const IntervalMatrix& a) {
  Eigen::MatrixXd result(a.rows(), a.cols());
  for (int i = 0; i < a.rows(); ++i)
    for (int j = 0; j < a.cols(); ++j) result(i, j) = middle(a(i, j));
  return result;
}

double norm_bound(const IntervalMatrix& a) { return norm_of_magnitudes(a); }

SingularValues singular_value_bounds(const IntervalMatrix& a) {
  const Eigen::MatrixXd centre = middle(a);
  if (!centre.allFinite()) return {0, std::numeric_limits<double>::infinity()};
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(centre, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::MatrixXd u = svd.matrixU(), v = svd.matrixV();
  IntervalMatrix rest = product(Eigen::MatrixXd(u.transpose()), product(a, v));
  double least = std::numeric_limits<double>::infinity(), greatest = 0;
  for (int i = 0; i < a.cols(); ++i) {
    const double value = middle(rest(i, i));
    least = std::min(least, std::abs(value));
    greatest = std::max(greatest, std::abs(value));
    rest(i, i) -= value;
  }
  const double off = norm_of_magnitudes(rest);
  // σ(A) = σ(U⁻ᵀ M V⁻¹): between σ(M)/(‖U‖‖V‖) and σ(M) ‖U⁻¹‖‖V⁻¹‖.
  const Interval du(orthogonality_defect(u)), dv(orthogonality_defect(v));
  if (!(du.upper() < 0.5 && dv.upper() < 0.5)) return {0, std::numeric_limits<double>::infinity()};
  const Interval stretch = root((1.0 + du) * (1.0 + dv)), shrink = root((1.0 - du) * (1.0 - dv));
  return {std::max(0.0, ((Interval(least) - off) / stretch).lower()),
          ((Interval(greatest) + off) / shrink).upper()};
}

int determinant_sign(const IntervalMatrix& a) {
  const int n = a.rows();
  const Eigen::MatrixXd centre = middle(a);
  if (!centre.allFinite()) return 0;
  // A = C⁻¹ (C A): C A is regular and its determinant positive when ‖C A - I‖ < 1 (no matrix on the
  // way from I to it is singular); the sign of det C comes from its elimination, done in intervals.
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(centre);
  if (!lu.isInvertible()) return 0;
  const Eigen::MatrixXd inverse = lu.inverse();
  if (!inverse.allFinite()) return 0;
  IntervalMatrix defect = product(inverse, a);
  for (int i = 0; i < n; ++i) defect(i, i) -= 1.0;
  if (!(norm_of_magnitudes(defect) < 1)) return 0;

  std::vector<std::vector<Interval>> rows(n, std::vector<Interval>(n));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) rows[i][j] = inverse(i, j);
  int sign = 1;
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (mignitude(rows[i][k]) > mignitude(rows[pivot][k])) pivot = i;
    if (!(mignitude(rows[pivot][k]) > 0)) return 0;
    if (pivot != k) {
      std::swap(rows[pivot], rows[k]);
      sign = -sign;
    }
    if (rows[k][k].upper() < 0) sign = -sign;
    for (int i = k + 1; i < n; ++i) {
      const Interval factor = rows[i][k] / rows[k][k];
      for (int j = k; j < n; ++j) rows[i][j] -= factor * rows[k][j];
    }
  }
  return sign;
}

}  // namespace polyglide
