#include <numeric>

#include "kinematics/interval_matrix.hpp"
#include "kinematics/manifold.hpp"
#include "kinematics/screw_chain.hpp"

// Loops of screws.
namespace polyglide {
namespace {

class Closure {
 public:
  Closure(const Model& model, const Posture& posture)
      : size_(model.size), columns_(model.freedoms.size()) {
    std::iota(columns_.begin(), columns_.end(), 0);
    for (const auto& loop : model.loops)
      loops_.push_back({chain_of(model, loop, posture), {}, model.centre});
  }

  /// Six rows per loop, as enclose_loop(). @param box increments per freedom, translations per
  /// size.
  [[nodiscard]] Enclosure enclose(const std::vector<Interval>& box) const {
    const int rows = 6 * static_cast<int>(loops_.size());
    Enclosure result{std::vector<Interval>(rows, Interval(0.0)),
                     IntervalMatrix(rows, static_cast<int>(columns_.size()))};
    for (std::size_t l = 0; l < loops_.size(); ++l)
      enclose_loop(loops_[l], box, size_, columns_, 6 * static_cast<int>(l), result);
    return result;
  }

 private:
  double size_;
  std::vector<int> columns_;
  std::vector<ScrewLoop> loops_;
};

bool is_zero(const Interval& x) { return x.lower() == 0 && x.upper() == 0; }

/// Rows that are not identically zero on the box.
std::vector<int> live_rows(const Enclosure& on_box) {
  std::vector<int> rows;
  for (int row = 0; row < on_box.jacobian.rows(); ++row) {
    bool zero = is_zero(on_box.values[row]);
    for (int c = 0; zero && c < on_box.jacobian.cols(); ++c)
      zero = is_zero(on_box.jacobian(row, c));
    if (!zero) rows.push_back(row);
  }
  return rows;
}

/// Rows and columns of a largest regular part, empty when the rank is in doubt.
struct Independent {
  std::vector<int> rows, columns;
};

Independent independent_part(const Eigen::MatrixXd& jacobian) {
  const auto rows = independent_columns(jacobian.transpose());
  if (!rows) return {};
  const auto columns = independent_columns(jacobian(*rows, Eigen::all));
  if (!columns || columns->size() != rows->size()) return {};
  return {*rows, *columns};
}

std::vector<int> picked(const std::vector<int>& from, const std::vector<int>& which) {
  std::vector<int> result;
  for (int i : which) result.push_back(from[i]);
  return result;
}

/// Does what the drives leave free move the platform? @param rank of the Jacobian.
bool platform_is_held(const Model& model, const Posture& posture, const Eigen::MatrixXd& jacobian,
                      const std::vector<int>& passive, int rank) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeFullV);
  const Eigen::MatrixXd kernel = svd.matrixV().rightCols(jacobian.cols() - rank);
  const Eigen::MatrixXd platform = columns(
      body_jacobian(model, posture, model.mechanism.platform) * freedom_scale(model).asDiagonal(),
      passive);
  return (platform * kernel).cwiseAbs().maxCoeff() < 1e-6 * (1 + model.size) * kernel.norm();
}

}  // namespace

ModeCertificate certify_closure(const Model& model, const Posture& posture) {
  const std::vector<int> passive = passive_freedoms(model);
  if (model.loops.empty() || passive.empty()) return {};
  const UpwardRounding rounding;
  const Closure closure(model, posture);
  constexpr double kNear = 1e-3;  // no box to be tried is larger in its effect than this
  std::vector<Interval> wide(model.freedoms.size(), Interval(0.0));
  for (int f : passive) wide[f] = Interval(-kNear, kNear);
  const std::vector<int> live = live_rows(closure.enclose(wide));
  if (live.empty()) return {};

  const Eigen::MatrixXd all =
      middle(closure.enclose(std::vector<Interval>(model.freedoms.size(), Interval(0.0))).jacobian);
  const Eigen::MatrixXd jacobian = all(live, passive);
  const Independent chosen = independent_part(jacobian);
  const int n = static_cast<int>(chosen.rows.size());
  if (n == 0) return {};
  if (n < static_cast<int>(passive.size()) &&
      !platform_is_held(model, posture, jacobian, passive, n))
    return {};
  const std::vector<int> rows = picked(live, chosen.rows);
  const std::vector<int> unknown = picked(passive, chosen.columns);

  const auto on_box = [&](const std::vector<Interval>& box) {
    std::vector<Interval> increments(model.freedoms.size(), Interval(0.0));
    for (int i = 0; i < n; ++i) increments[unknown[i]] = box[i];
    return closure.enclose(increments);
  };
  ModeCertificate certificate = prove_root(n, [&](const std::vector<Interval>& box) {
    const Enclosure whole = on_box(box);
    Enclosure result{std::vector<Interval>(n), IntervalMatrix(n, n)};
    for (int i = 0; i < n; ++i) {
      result.values[i] = whole.values[rows[i]];
      for (int j = 0; j < n; ++j) result.jacobian(i, j) = whole.jacobian(rows[i], unknown[j]);
    }
    return result;
  });
  // The rows that vanish were looked at within kNear only.
  if (!certificate.proved || !(certificate.radius < kNear)) return {};
  if (n == static_cast<int>(live.size())) return certificate;
  const double radius = certificate.radius;
  const Enclosure rest = on_box(std::vector<Interval>(n, Interval(-radius, radius)));
  constexpr double kFits = 1e-9;
  const bool fits = std::all_of(live.begin(), live.end(),
                                [&](int row) { return magnitude(rest.values[row]) < kFits; });
  certificate.redundant = static_cast<int>(live.size()) - n;
  return fits ? certificate : ModeCertificate{};
}

}  // namespace polyglide
