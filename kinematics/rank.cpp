#include "kinematics/rank.hpp"

#include <algorithm>

namespace polyglide {
namespace {

constexpr double kNoise = 1e-12;     // below this part of the largest value: rounding
constexpr double kNeverDrop = 1e-4;  // above this part of the largest value: real
constexpr double kLargestGap = 1e16;

}  // namespace

RankDecision decide_rank(const Eigen::VectorXd& s, double reference) {
  RankDecision decision;
  const int count = static_cast<int>(s.size());
  const double top = std::max(count > 0 ? s[0] : 0, reference);
  decision.gap = kLargestGap;
  if (count == 0 || !(top > 0)) return decision;
  decision.largest = s[0];

  // kept(r) is the last value kept when the rank is r; rank 0 keeps the reference.
  const auto kept = [&](int r) { return r > 0 ? s[r - 1] / top : 1; };
  const auto dropped = [&](int r) { return r < count ? s[r] / top : 0; };
  double best = 0;
  for (int r = reference > 0 ? 0 : 1; r <= count; ++r) {
    if (dropped(r) > kNeverDrop) continue;
    const double ratio = std::max(kept(r), kNoise) / std::max(dropped(r), kNoise);
    if (ratio > best) {
      best = ratio;
      decision.rank = r;
    }
  }
  decision.smallest = kept(decision.rank) * top;
  // When nothing is dropped the doubt is how far the smallest is from rounding.
  decision.gap = kept(decision.rank) / std::max(dropped(decision.rank), 1 / kLargestGap);
  return decision;
}

Kernel kernel_of(const Eigen::MatrixXd& matrix) {
  Kernel kernel;
  if (matrix.rows() == 0 || matrix.cols() == 0) {
    kernel.decision.gap = kLargestGap;
    kernel.basis = Eigen::MatrixXd::Identity(matrix.cols(), matrix.cols());
    return kernel;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeFullV);
  kernel.decision = decide_rank(svd.singularValues());
  kernel.basis = svd.matrixV().rightCols(matrix.cols() - kernel.decision.rank);
  return kernel;
}

RankDecision rank_of(const Eigen::MatrixXd& matrix, double reference) {
  if (matrix.size() == 0) return decide_rank(Eigen::VectorXd(), reference);
  return decide_rank(Eigen::JacobiSVD<Eigen::MatrixXd>(matrix).singularValues(), reference);
}

}  // namespace polyglide
