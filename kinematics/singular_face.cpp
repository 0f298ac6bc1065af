#include "kinematics/singular_face.hpp"

namespace polyglide {
namespace {

using Column = std::vector<Interval>;

/// A z = b for every nearly diagonal A; by rows scaled with the diagonal, then Jacobi's
/// iteration from what the norm of the rest allows. nullopt where the diagonal does not dominate.
template <typename Entry>
std::optional<Column> solve_dominated(int n, const Entry& a, const Column& b) {
  Interval most(0.0), beside(0.0);
  std::vector<double> diagonal(n);
  for (int i = 0; i < n; ++i) {
    diagonal[i] = middle(a(i, i));
    if (diagonal[i] == 0) return std::nullopt;
    Interval sum(0.0);
    for (int j = 0; j < n; ++j)
      sum += magnitude((j == i ? a(i, j) - diagonal[i] : a(i, j)) / diagonal[i]);
    beside = std::max(beside.upper(), sum.upper());
    most = std::max(most.upper(), magnitude(b[i] / diagonal[i]));
  }
  if (!(beside.upper() < 1)) return std::nullopt;
  const double bound = (most / (1.0 - beside)).upper();
  Column z(n, Interval(-bound, bound));
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round)
    for (int i = 0; i < n; ++i) {
      Interval rest = b[i];
      for (int j = 0; j < n; ++j) rest -= (j == i ? a(i, j) - diagonal[i] : a(i, j)) * z[j];
      z[i] = common(z[i], rest / diagonal[i]);
    }
  return z;
}

/// What elimination of all but the last row and column leaves, s = left·A·right with last
/// entries 1, whose rate of change is left·(rate of A)·right; and the sign of det A / s.
struct LastPivot {
  Column left, right;
  Interval value;
  int sign = 1;
};

std::optional<LastPivot> last_pivot(const IntervalMatrix& a) {
  const int n = a.rows() - 1;
  Column column, row;
  for (int i = 0; i < n; ++i) {
    column.push_back(-a(i, n));
    row.push_back(-a(n, i));
  }
  const auto right = solve_dominated(
      n, [&](int i, int j) { return a(i, j); }, column);
  const auto left = solve_dominated(
      n, [&](int i, int j) { return a(j, i); }, row);
  if (!right || !left) return std::nullopt;
  LastPivot pivot{*left, *right, a(n, n), 1};
  for (int i = 0; i < n; ++i) {
    pivot.value += a(n, i) * (*right)[i];
    if (middle(a(i, i)) < 0) pivot.sign = -pivot.sign;
  }
  pivot.left.emplace_back(1.0);
  pivot.right.emplace_back(1.0);
  return pivot;
}

bool all_finite(const IntervalMatrix& a) {
  for (int i = 0; i < a.rows(); ++i)
    for (int j = 0; j < a.cols(); ++j)
      if (!(magnitude(a(i, j)) < std::numeric_limits<double>::infinity())) return false;
  return true;
}

}  // namespace

std::optional<PlaneBound> singular_face(const BoxLimits& limits, const PoseBox& box,
                                        const Cuboid& cuboid, int side) {
  const std::optional<BoxLimits::MovingRows> whole = limits.moving_rows(box);
  if (!whole || !std::ranges::all_of(whole->rates, all_finite)) return std::nullopt;
  const IntervalMatrix at = limits.rod_rows(middle_of(box), nullptr);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(middle(at),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::MatrixXd u = svd.matrixU().transpose(), v = svd.matrixV();
  const auto pivot = last_pivot(product(u, product(whole->rows, v)));
  const auto in_middle = last_pivot(product(u, product(at, v)));
  const int turned = determinant_sign(exactly(u)) * determinant_sign(exactly(v));
  if (!pivot || !in_middle || turned == 0 || pivot->sign != in_middle->sign) return std::nullopt;
  const double sign = -side * turned * pivot->sign;
  PlaneBound face{sign * in_middle->value, {}};
  for (int k = 0; k < 3; ++k) {
    const IntervalMatrix rate = product(u, product(whole->rates[k], v));
    Interval slope(0.0);
    for (int i = 0; i < rate.rows(); ++i)
      for (int j = 0; j < rate.cols(); ++j) slope += pivot->left[i] * rate(i, j) * pivot->right[j];
    slope = sign * slope;
    face.slope[k] = middle(slope);
    face.at += Interval(-1, 1) * (Interval(radius(slope)) * cuboid.half[k]);
  }
  // What is at most zero is then below it.
  face.at += Interval(0.0, std::numeric_limits<double>::denorm_min());
  return face;
}

}  // namespace polyglide
