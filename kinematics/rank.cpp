#include "kinematics/rank.hpp"

#include <lapacke.h>

#include <Eigen/QR>
#include <algorithm>
#include <optional>
#include <stdexcept>

namespace polyglide {
namespace {

constexpr double kNeverDrop = 1e-4;  // whatever lies below it
constexpr double kLargestGap = 1e16;

}  // namespace

RankDecision decide_rank(const Eigen::VectorXd& s, double reference, const RankScale& scale) {
  RankDecision decision;
  const int count = static_cast<int>(s.size());
  const double top = std::max(count > 0 ? s[0] : 0, reference);
  decision.gap = kLargestGap;
  if (count == 0 || !(top > 0)) return decision;
  decision.largest = s[0];

  // kept(r) is the last value kept when the rank is r; rank 0 keeps the reference.
  const auto kept = [&](int r) { return r > 0 ? s[r - 1] / top : 1; };
  const auto dropped = [&](int r) { return r < count ? s[r] / top : 0; };
  double best = 0, best_raw = 0;
  for (int r = reference > 0 ? 0 : 1; r <= count; ++r) {
    if (dropped(r) > kNeverDrop) continue;
    const double ratio = std::min(kept(r), scale.real) / std::max(dropped(r), scale.noise);
    const double raw = kept(r) / std::max(dropped(r), scale.noise);
    if (ratio > best * (1 + 1e-9) || (ratio > best * (1 - 1e-9) && raw > best_raw)) {
      best = ratio;
      best_raw = raw;
      decision.rank = r;
    }
  }
  decision.noise = dropped(decision.rank);
  decision.smallest = kept(decision.rank) * top;
  // When nothing is dropped the doubt is how far the smallest is from rounding.
  decision.gap = kept(decision.rank) / std::max(dropped(decision.rank), 1 / kLargestGap);
  return decision;
}

namespace {

/// Values, and both sets of vectors when `u` and `vt` are given.
Eigen::VectorXd decompose(Eigen::MatrixXd matrix, Eigen::MatrixXd* u, Eigen::MatrixXd* vt) {
  const auto rows = static_cast<lapack_int>(matrix.rows()),
             cols = static_cast<lapack_int>(matrix.cols());
  Eigen::VectorXd values(std::min(rows, cols));
  const bool vectors = u != nullptr;
  if (vectors) {
    u->resize(rows, rows);
    vt->resize(cols, cols);
  }
  double unused = 0;
  const lapack_int failed = LAPACKE_dgesdd(
      LAPACK_COL_MAJOR, vectors ? 'A' : 'N', rows, cols, matrix.data(), rows, values.data(),
      vectors ? u->data() : &unused, rows, vectors ? vt->data() : &unused, cols);
  if (failed != 0)
    throw std::invalid_argument(failed < 0 ? "singular values: a matrix entry is not finite"
                                           : "singular values: no convergence");
  return values;
}

}  // namespace

Svd svd_of(const Eigen::MatrixXd& matrix) {
  Svd svd;
  if (matrix.size() == 0) {
    svd.u = Eigen::MatrixXd::Identity(matrix.rows(), matrix.rows());
    svd.v = Eigen::MatrixXd::Identity(matrix.cols(), matrix.cols());
    return svd;
  }
  Eigen::MatrixXd vt;
  svd.values = decompose(matrix, &svd.u, &vt);
  svd.v = vt.transpose();
  return svd;
}

Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return {};
  return decompose(matrix, nullptr, nullptr);
}

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& basis) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(basis).householderQ() *
         Eigen::MatrixXd::Identity(basis.rows(), basis.cols());
}

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right,
                              double weakest) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors;
  if (weakest > 0) factors.setThreshold(weakest);
  factors.compute(matrix);
  return factors.solve(right);
}

std::vector<int> independent_rows(const Eigen::MatrixXd& matrix, Eigen::Index count) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix.transpose());
  const auto& order = qr.colsPermutation().indices();
  std::vector<int> rows(order.begin(), order.begin() + count);
  std::ranges::sort(rows);
  return rows;
}

namespace {

constexpr double kSurelyReal = 1e-5, kSurelyNoise = 1e-10;  // of the largest pivot

/// Kernel from the pivoted QR decomposition of the transpose: the rows' span is Q's first columns.
/// nullopt where a pivot leaves doubt.
std::optional<Kernel> kernel_by_pivots(const Eigen::MatrixXd& matrix, double reference) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix.transpose());
  const Eigen::VectorXd pivots = qr.matrixQR().diagonal().cwiseAbs();
  const double top = std::max(pivots[0], reference);
  if (!(top > 0)) return std::nullopt;
  const bool sure = std::ranges::all_of(pivots, [top](double pivot) {
    return pivot > kSurelyReal * top || pivot < kSurelyNoise * top;
  });
  if (!sure) return std::nullopt;
  Kernel kernel{decide_rank(pivots, reference), 0, {}};
  kernel.pivot = kernel.decision.smallest;
  const Eigen::Index left = matrix.cols() - kernel.decision.rank;
  kernel.basis = Eigen::MatrixXd::Zero(matrix.cols(), left);
  kernel.basis.bottomRows(left).setIdentity();
  kernel.basis.applyOnTheLeft(qr.householderQ());
  return kernel;
}

Kernel kernel_of_nothing(Eigen::Index cols) {
  Kernel kernel;
  kernel.decision.gap = kLargestGap;
  kernel.basis = Eigen::MatrixXd::Identity(cols, cols);
  return kernel;
}

}  // namespace

Kernel kernel_of(const Eigen::MatrixXd& matrix, double reference) {
  if (matrix.size() == 0) return kernel_of_nothing(matrix.cols());
  const RankDecision decision = decide_rank(singular_values(matrix), reference);
  if (auto kernel = kernel_by_pivots(matrix, reference);
      kernel && kernel->decision.rank == decision.rank) {
    kernel->decision = decision;
    return *std::move(kernel);
  }
  return {decision, decision.smallest, svd_of(matrix).v.rightCols(matrix.cols() - decision.rank)};
}

Kernel screened_kernel(const Eigen::MatrixXd& matrix, double reference) {
  if (matrix.size() == 0) return kernel_of_nothing(matrix.cols());
  if (auto kernel = kernel_by_pivots(matrix, reference)) return *std::move(kernel);
  return kernel_of(matrix, reference);
}

RankDecision rank_of(const Eigen::MatrixXd& matrix, double reference) {
  if (matrix.size() == 0) return decide_rank(Eigen::VectorXd(), reference);
  return decide_rank(singular_values(matrix), reference);
}

}  // namespace polyglide
