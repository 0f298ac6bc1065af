#include "kinematics/interval_matrix.hpp"
#include "kinematics/krawczyk_root.hpp"

namespace polyglide {

ModeCertificate prove_root(int n,
                           const std::function<Enclosure(const std::vector<Interval>&)>& enclose) {
  constexpr double kLargest = 1e-2;
  std::vector<Interval> box(n, Interval(0.0));
  const Enclosure centre = enclose(box);
  const Eigen::MatrixXd middles = middle(centre.jacobian);
  if (!middles.allFinite()) return {};
  const Eigen::MatrixXd inverse = middles.partialPivLu().inverse();
  if (!inverse.allFinite()) return {};
  std::vector<Interval> newton(n, Interval(0.0));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) newton[i] -= inverse(i, j) * centre.values[j];
  double half = 1e-14;
  for (const Interval& step : newton) half = std::max(half, 2 * magnitude(step));
  for (; half < kLargest; half *= 8) {
    for (Interval& side : box) side = Interval(-half, half);
    IntervalMatrix rest = product(inverse, enclose(box).jacobian);
    bool inside = true;
    for (int i = 0; i < n && inside; ++i) {
      rest(i, i) -= 1.0;
      Interval mapped = newton[i];
      for (int j = 0; j < n; ++j) mapped -= rest(i, j) * box[j];
      inside = mapped.lower() > -half && mapped.upper() < half;
    }
    if (inside) return {true, half};
  }
  return {};
}

std::optional<std::vector<int>> independent_columns(const Eigen::MatrixXd& matrix) {
  constexpr double kZero = 1e-10, kDoubt = 1e-7;  // of the greatest pivot
  std::vector<int> columns;
  if (matrix.size() == 0) return columns;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
  for (Eigen::Index i = 0; i < qr.matrixR().diagonal().size(); ++i) {
    const double pivot = std::abs(qr.matrixR()(i, i)) / qr.maxPivot();
    if (!(pivot > kZero)) break;
    if (pivot < kDoubt) return std::nullopt;
    columns.push_back(qr.colsPermutation().indices()[i]);
  }
  return columns;
}

IntervalVector unit_axis(const Vector3& axis) {
  IntervalVector result = vector_of(axis);
  if (axis.cwiseAbs().sum() == 1 && axis.cwiseAbs().maxCoeff() == 1) return result;
  for (int i = 0; i < 3; ++i)
    if (axis[i] != 0) result[i] = outward(axis[i], axis[i], 2);
  return result;
}

}  // namespace polyglide
