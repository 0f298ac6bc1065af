#include "kinematics/rank.hpp"

#include <algorithm>

namespace polyglide {
namespace {

constexpr double kNoise = 1e-12;     // below this part of the largest value: rounding
constexpr double kNeverDrop = 1e-4;  // above this part of the largest value: real
constexpr double kLargestGap = 1e16;

}  // namespace

RankDecision decide_rank(const Eigen::VectorXd& s) {
  RankDecision decision;
  const int count = static_cast<int>(s.size());
  decision.gap = kLargestGap;
  if (count == 0 || !(s[0] > 0)) return decision;
  decision.largest = s[0];

  double best = 0;
  for (int r = 1; r <= count; ++r) {
    const double next = r < count ? s[r] / s[0] : 0;
    if (next > kNeverDrop) continue;
    const double ratio = std::max(s[r - 1] / s[0], kNoise) / std::max(next, kNoise);
    if (ratio > best) {
      best = ratio;
      decision.rank = r;
    }
  }
  decision.smallest = s[decision.rank - 1];
  const double dropped = decision.rank < count ? s[decision.rank] : 0;
  decision.gap = std::min(kLargestGap, decision.smallest / std::max(dropped, 1e-300));
  // Nothing was dropped: the doubt is how far the smallest is from noise.
  if (decision.rank == count) decision.gap = kLargestGap * decision.smallest / s[0];
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

RankDecision rank_of(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return decide_rank(Eigen::VectorXd());
  return decide_rank(Eigen::JacobiSVD<Eigen::MatrixXd>(matrix).singularValues());
}

}  // namespace polyglide
