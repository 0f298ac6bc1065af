#include "kinematics/parametric_root.hpp"

#include "kinematics/interval_matrix.hpp"

namespace polyglide {
namespace {

std::vector<Interval> points(const std::vector<double>& values) {
  return std::vector<Interval>(values.begin(), values.end());
}

IntervalMatrix columns_of(const IntervalMatrix& a, int first, int count) {
  IntervalMatrix result(a.rows(), count);
  for (int i = 0; i < a.rows(); ++i)
    for (int j = 0; j < count; ++j) result(i, j) = a(i, first + j);
  return result;
}

/// About the inverse, in the mean of squares where there are more rows; nullopt where the rank is
/// in doubt.
std::optional<Eigen::MatrixXd> inverse_of(const Eigen::MatrixXd& a) {
  constexpr double kSingular = 1e-9;
  if (!a.allFinite() || a.rows() < a.cols()) return std::nullopt;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
  const Eigen::Index n = a.cols();
  if (!(std::abs(qr.matrixR()(n - 1, n - 1)) > kSingular * qr.maxPivot())) return std::nullopt;
  return qr.solve(Eigen::MatrixXd::Identity(a.rows(), a.rows()));
}

std::vector<Interval> times(const Eigen::MatrixXd& a, const std::vector<Interval>& b) {
  std::vector<Interval> result(a.rows(), Interval(0.0));
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < a.cols(); ++j) result[i] += a(i, j) * b[j];
  return result;
}

double largest(const std::vector<Interval>& a) {
  double result = 0;
  for (const Interval& each : a) result = std::max(result, magnitude(each));
  return result;
}

/// Half sides r with start + |rest| r < r; nullopt where the iteration runs away.
std::optional<std::vector<double>> shrunk(const IntervalMatrix& rest,
                                          const std::vector<double>& start, double most) {
  constexpr int kRounds = 30;
  constexpr double kRoom = 1.02, kLeast = 1e-13;
  std::vector<double> half = start;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> image;
    bool fits = true;
    for (int i = 0; i < rest.rows(); ++i) {
      Interval sum(start[i]);
      for (int j = 0; j < rest.cols(); ++j) sum += Interval(magnitude(rest(i, j))) * half[j];
      image.push_back(sum.upper());
      fits = fits && image[i] < half[i];
      if (!(image[i] < most)) return std::nullopt;
    }
    if (fits) return half;
    for (std::size_t i = 0; i < half.size(); ++i) half[i] = kRoom * image[i] + kLeast;
  }
  return std::nullopt;
}

/// What Krawczyk's operator is made of: I - Y F_u, and -Y F_x.
struct Parts {
  IntervalMatrix rest, pull;

  Parts(const Eigen::MatrixXd& inverse, const IntervalMatrix& jacobian)
      : rest(static_cast<int>(inverse.rows()), static_cast<int>(inverse.rows())),
        pull(rest.rows(), jacobian.cols() - rest.rows()) {
    const IntervalMatrix all = product(inverse, jacobian);
    for (int i = 0; i < n(); ++i) {
      for (int j = 0; j < n(); ++j) rest(i, j) = (i == j ? 1.0 : 0.0) - all(i, j);
      for (int j = 0; j < pull.cols(); ++j) pull(i, j) = -all(i, n() + j);
    }
  }

  [[nodiscard]] int n() const { return rest.rows(); }

  /// start + rest · (±half); with the half widths it is to fit into.
  [[nodiscard]] std::vector<Interval> mapped(std::vector<Interval> start,
                                             const std::vector<double>& half) const {
    for (int i = 0; i < n(); ++i)
      for (int j = 0; j < n(); ++j) start[i] += rest(i, j) * Interval(-half[j], half[j]);
    return start;
  }

  /// u' = rest · u' + pull.
  [[nodiscard]] std::optional<IntervalMatrix> rates() const {
    IntervalMatrix result(n(), pull.cols());
    for (int k = 0; k < pull.cols(); ++k) {
      std::vector<double> start;
      for (int i = 0; i < n(); ++i) start.push_back(magnitude(pull(i, k)));
      const auto half = shrunk(rest, start, std::numeric_limits<double>::infinity());
      if (!half) return std::nullopt;
      for (int i = 0; i < n(); ++i) result(i, k) = Interval(-(*half)[i], (*half)[i]);
      constexpr int kRounds = 3;
      for (int round = 0; round < kRounds; ++round)
        for (int i = 0; i < n(); ++i) {
          Interval value = pull(i, k);
          for (int j = 0; j < n(); ++j) value += rest(i, j) * result(j, k);
          result(i, k) = common(result(i, k), value);
        }
    }
    return result;
  }
};

bool fits(const std::vector<Interval>& image, const std::vector<double>& half) {
  for (std::size_t i = 0; i < image.size(); ++i)
    if (!(image[i].lower() > -half[i] && image[i].upper() < half[i])) return false;
  return true;
}

std::vector<Interval> about(const std::vector<double>& centre, const std::vector<Interval>& ways) {
  std::vector<Interval> result;
  for (std::size_t i = 0; i < centre.size(); ++i) result.push_back(centre[i] + ways[i]);
  return result;
}

std::vector<Interval> to_both_sides(const std::vector<double>& half) {
  std::vector<Interval> result;
  for (double each : half) result.emplace_back(-each, each);
  return result;
}

/// The proof about what Newton's method found.
std::optional<PointRoot> prove(const ParametricEnclosure& equations,
                               const std::vector<double>& where, const std::vector<double>& found,
                               const Eigen::MatrixXd& inverse, std::vector<Interval> step) {
  constexpr double kWidest = 1e-7, kMet = 1e-9;
  const std::vector<Interval> left = step;
  for (Interval& each : step) each = -each;
  double half = std::max(1e-14, 2 * largest(step));
  for (; half < kWidest; half *= 8) {
    const std::vector<double> sides(found.size(), half);
    const Enclosure there = equations(about(found, to_both_sides(sides)), points(where));
    const Parts parts(inverse, there.jacobian);
    const std::vector<Interval> image = parts.mapped(step, sides);
    if (!fits(image, sides)) continue;
    if (!(largest(there.values) < kMet)) return std::nullopt;
    auto rates = parts.rates();
    if (!rates) return std::nullopt;
    return PointRoot{where, about(found, image), std::move(*rates), found, inverse, left};
  }
  return std::nullopt;
}

}  // namespace

std::optional<PointRoot> root_at(const ParametricEnclosure& equations,
                                 const std::vector<double>& where,
                                 const std::vector<double>& guess) {
  constexpr int kMost = 12;
  constexpr double kNear = 1e-10, kFar = 1.0;
  std::vector<double> at = guess;
  double before = kFar;
  for (int i = 0; i < kMost; ++i) {
    const Enclosure there = equations(points(at), points(where));
    const auto inverse =
        inverse_of(middle(columns_of(there.jacobian, 0, static_cast<int>(at.size()))));
    if (!inverse) return std::nullopt;
    const std::vector<Interval> step = times(*inverse, there.values);
    const double length = largest(step);
    if (length < kNear) return prove(equations, where, at, *inverse, step);
    // A step that is not shorter than the one before leads to some other root, if to any.
    if (!(length < before)) return std::nullopt;
    before = length;
    for (std::size_t k = 0; k < at.size(); ++k) at[k] -= middle(step[k]);
  }
  return std::nullopt;
}

namespace {

/// The most that a box of ways makes of rates: Σ |rate · way| per row.
std::vector<double> swings(const IntervalMatrix& rates, const std::vector<Interval>& ways) {
  std::vector<double> result;
  for (int i = 0; i < rates.rows(); ++i) {
    Interval sum(0.0);
    for (int k = 0; k < rates.cols(); ++k) sum += magnitude(rates(i, k) * ways[k]);
    result.push_back(sum.upper());
  }
  return result;
}

}  // namespace

std::optional<BoxRoot> roots_over(const ParametricEnclosure& equations,
                                  const std::vector<Interval>& box, const PointRoot& centre) {
  const auto& [where, root, middle_rates, found, inverse, step] = centre;
  const int n = static_cast<int>(found.size()), k = static_cast<int>(box.size());
  if (n == 0) return BoxRoot{{}, {}, IntervalMatrix(0, k)};
  std::vector<Interval> ways;
  for (int j = 0; j < k; ++j) ways.push_back(box[j] - where[j]);
  // u = û + S (x - x̂) + e: how far along, and how far beside.
  const Eigen::MatrixXd slope = middle(middle_rates);
  const IntervalMatrix along = exactly(slope);
  const std::vector<double> swing = swings(along, ways);
  const double widest = *std::ranges::max_element(swing);
  constexpr double kBeside = 0.25, kShare = 0.05, kRoom = 1.1, kLeast = 1e-12;
  std::vector<double> beside;
  for (double each : swing) beside.push_back(kBeside * each + kShare * widest + kLeast);
  constexpr int kTries = 4;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    std::vector<double> half = swing;
    for (int i = 0; i < n; ++i) half[i] = (Interval(swing[i]) + beside[i]).upper();
    const std::vector<Interval> alone = about(found, to_both_sides(half));
    const Parts parts(inverse, equations(alone, box).jacobian);
    IntervalMatrix bend = product(parts.rest, slope);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < k; ++j) bend(i, j) += parts.pull(i, j) - slope(i, j);
    std::vector<double> start = swings(bend, ways);
    for (int i = 0; i < n; ++i) start[i] = (Interval(start[i]) + magnitude(step[i])).upper();
    const auto least = shrunk(parts.rest, start, 4 * widest + kLeast);
    if (!least) return std::nullopt;
    bool fits = true;
    for (int i = 0; i < n; ++i) fits = fits && (*least)[i] <= beside[i];
    if (!fits) {
      for (int i = 0; i < n; ++i) beside[i] = std::max(beside[i], kRoom * (*least)[i]);
      continue;
    }
    auto rates = parts.rates();
    if (!rates) return std::nullopt;
    BoxRoot result{alone, moved({where, points(found), along, {}, {}, {}}, along, box),
                   std::move(*rates)};
    const std::vector<Interval> nearer = moved(centre, result.rates, box);
    for (int i = 0; i < n; ++i)
      result.roots[i] = common(result.roots[i] + Interval(-(*least)[i], (*least)[i]), nearer[i]);
    return result;
  }
  return std::nullopt;
}

bool within(const std::vector<Interval>& a, const std::vector<Interval>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(a[i].lower() >= b[i].lower() && a[i].upper() <= b[i].upper())) return false;
  return true;
}

std::vector<Interval> moved(const PointRoot& from, const IntervalMatrix& rates,
                            const std::vector<Interval>& to) {
  std::vector<Interval> result = from.root;
  for (std::size_t i = 0; i < result.size(); ++i)
    for (std::size_t k = 0; k < to.size(); ++k)
      result[i] += rates(static_cast<int>(i), static_cast<int>(k)) * (to[k] - from.where[k]);
  return result;
}

}  // namespace polyglide
