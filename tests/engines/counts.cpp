#include "engines/counts.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <ostream>
#include <tuple>

#include "kinematics/manifold.hpp"
#include "kinematics/rank.hpp"

namespace polyglide::engines {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A rule of its own: singular values below 1e-7 are zero. Ours looks for the largest gap.
constexpr double kZero = 1e-7;

Eigen::MatrixXd kernel(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return Eigen::MatrixXd::Identity(matrix.cols(), matrix.cols());
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeFullV);
  const auto& values = svd.singularValues();
  const auto rank = (values.array() > kZero * std::max(values[0], 1e-300)).count();
  return svd.matrixV().rightCols(matrix.cols() - rank);
}

/// Number of independent platform velocities among the motions that are free.
int platform_freedom(const Eigen::MatrixXd& platform, const Eigen::MatrixXd& free) {
  if (free.size() == 0) return 0;
  const Eigen::MatrixXd velocities = platform * free;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(velocities);
  return static_cast<int>((svd.singularValues().array() > kZero * platform.norm()).count());
}

}  // namespace

bool operator==(const Counts& a, const Counts& b) {
  return std::tie(a.mobility, a.held_mobility, a.platform, a.held_platform) ==
         std::tie(b.mobility, b.held_mobility, b.platform, b.held_platform);
}

std::ostream& operator<<(std::ostream& out, const Counts& c) {
  return out << "mobility " << c.mobility << ", drives held " << c.held_mobility << "; platform "
             << c.platform << ", drives held " << c.held_platform;
}

Counts counts_of(const ConstraintSystem& system, double size) {
  const auto map = [&](const std::vector<double>& values, int rows) {
    return Eigen::MatrixXd(Eigen::Map<const Matrix>(values.data(), rows, system.columns));
  };
  Eigen::MatrixXd jacobian = map(system.jacobian, system.rows);
  Eigen::MatrixXd platform = map(system.platform, 6);
  Counts counts;
  for (int r = 0; r < system.rows; ++r)
    if (system.row_is_length[r]) jacobian.row(r) /= size;
  platform.bottomRows(3) /= size;
  for (int c = 0; c < system.columns; ++c) {
    if (!system.column_is_length[c]) continue;
    jacobian.col(c) *= size;
    platform.col(c) *= size;
  }
  for (std::size_t r = 0; r < system.residual.size(); ++r)
    counts.residual =
        std::max(counts.residual,
                 std::abs(system.residual[r]) /
                     (r < system.row_is_length.size() && system.row_is_length[r] ? size : 1));
  const Eigen::MatrixXd free = kernel(jacobian);
  counts.mobility = static_cast<int>(free.cols());
  counts.platform = platform_freedom(platform, free);
  std::vector<int> passive;
  for (int c = 0; c < system.columns; ++c)
    if (!system.column_is_driven[c]) passive.push_back(c);
  const Eigen::MatrixXd held = kernel(jacobian(Eigen::all, passive));
  counts.held_mobility = static_cast<int>(held.cols());
  counts.held_platform = platform_freedom(platform(Eigen::all, passive), held);
  return counts;
}

MobilityReport report_of(const Model& model) {
  MobilityOptions options;
  options.evidence = false;
  return analyse_mobility(model, options);
}

Counts counts_of(const Model& model) {
  const MobilityReport report = report_of(model);
  const Eigen::MatrixXd held =
      columns(closure_jacobian(model, home(model)), passive_freedoms(model));
  Counts counts;
  counts.mobility = report.home;
  counts.held_mobility = static_cast<int>(kernel_of(held).basis.cols());
  counts.platform = report.platform_home_dof;
  counts.held_platform = report.home_locked_platform;
  return counts;
}

}  // namespace polyglide::engines
