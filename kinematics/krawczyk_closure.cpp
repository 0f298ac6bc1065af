#include "kinematics/interval_matrix.hpp"
#include "kinematics/krawczyk_root.hpp"
#include "kinematics/manifold.hpp"

// Loops of screws.
namespace polyglide {
namespace {

/// One factor of a loop: the exponential of a screw times a coordinate, or a fixed rotation about
/// a point.
struct Factor {
  int freedom = -1;
  bool translational = false;
  int sign = 1;
  IntervalVector w, v;
  double coordinate = 0;
  IntervalRotation rotation;  // fixed factor: rotation, with shift
  IntervalVector shift;
};

struct Place {
  IntervalRotation rotation = no_rotation();
  IntervalVector shift{Interval(0.0), Interval(0.0), Interval(0.0)};
};

Place operator*(const Place& a, const Place& b) {
  Place result{product(a.rotation, b.rotation), turned(a.rotation, b.shift)};
  for (int i = 0; i < 3; ++i) result.shift[i] += a.shift[i];
  return result;
}

Place place_of(const Factor& factor, const Interval& increment) {
  if (factor.freedom < 0) return {factor.rotation, factor.shift};
  Place place;
  const Interval q = static_cast<double>(factor.sign) * (factor.coordinate + increment);
  if (factor.translational) {
    for (int i = 0; i < 3; ++i) place.shift[i] = q * factor.v[i];
    return place;
  }
  place.rotation = rotation_about(factor.w, q);
  // A point of the axis, and the advance along it.
  const IntervalVector point = cross(factor.w, factor.v);
  const IntervalVector moved = turned(place.rotation, point);
  const Interval advance = q * dot(factor.w, factor.v);
  for (int i = 0; i < 3; ++i) place.shift[i] = point[i] - moved[i] + advance * factor.w[i];
  return place;
}

class Closure {
 public:
  Closure(const Model& model, const Posture& posture)
      : model_(model), columns_(static_cast<int>(model.freedoms.size())) {
    for (const auto& loop : model.loops) {
      loops_.emplace_back();
      for (const LoopStep& step : loop) add(step, posture);
    }
  }

  [[nodiscard]] int rows() const { return 6 * static_cast<int>(loops_.size()); }

  /// Per loop the vector of the rotation's skew part, zero with a rotation only for none or half a
  /// turn, and the shift/size. @param box increments per freedom, translations per size.
  [[nodiscard]] Enclosure enclose(const std::vector<Interval>& box) const {
    Enclosure result{std::vector<Interval>(rows(), Interval(0.0)),
                     IntervalMatrix(rows(), columns_)};
    for (std::size_t l = 0; l < loops_.size(); ++l) enclose_loop(static_cast<int>(l), box, result);
    return result;
  }

 private:
  void add(const LoopStep& step, const Posture& posture) {
    const Joint& joint = model_.mechanism.joints[step.joint];
    std::vector<Factor> factors;
    const int first = model_.first_freedom[step.joint];
    if (joint.type == JointType::spherical) {
      for (int i : {2, 1, 0}) {
        Factor factor;
        factor.freedom = first + i;
        factor.w = vector_of(Vector3::Unit(i));
        factor.v = cross(vector_of(joint.at), factor.w);
        factors.push_back(factor);
      }
      Factor fixed;
      fixed.rotation = rotation_of(posture.balls[step.joint]);
      const IntervalVector at = vector_of(joint.at);
      if (step.sign < 0) fixed.rotation = transposed(fixed.rotation);
      const IntervalVector moved = turned(fixed.rotation, at);
      for (int i = 0; i < 3; ++i) fixed.shift[i] = at[i] - moved[i];
      factors.push_back(fixed);
    } else {
      for (int i = 0; i < freedoms(joint.type); ++i) {
        const Freedom& freedom = model_.freedoms[first + i];
        Factor factor;
        factor.freedom = first + i;
        factor.translational = freedom.translational;
        factor.coordinate = posture.q[first + i];
        // Whole turns change nothing, unless the joint is a screw.
        if (!factor.translational && joint.type != JointType::helical)
          factor.coordinate = std::remainder(factor.coordinate, 2 * M_PI);
        factor.w = unit_axis(freedom.screw.head<3>());
        factor.v = vector_of(freedom.screw.tail<3>());
        factors.push_back(factor);
      }
    }
    if (step.sign < 0) {
      std::reverse(factors.begin(), factors.end());
      for (Factor& factor : factors) factor.sign = -1;
    }
    loops_.back().insert(loops_.back().end(), factors.begin(), factors.end());
  }

  static IntervalRotation transposed(const IntervalRotation& r) {
    IntervalRotation result;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) result[i][j] = r[j][i];
    return result;
  }

  void enclose_loop(int loop, const std::vector<Interval>& box, Enclosure& result) const {
    Place way;
    std::vector<std::pair<IntervalVector, IntervalVector>> screws;
    std::vector<int> freedom;
    for (const Factor& factor : loops_[loop]) {
      Interval increment(0.0);
      if (factor.freedom >= 0) {
        increment = box[factor.freedom];
        if (factor.translational) increment *= model_.size;
        // The screw where the factors before have carried it.
        IntervalVector w = turned(way.rotation, factor.w), v = turned(way.rotation, factor.v);
        if (factor.translational) w = {Interval(0.0), Interval(0.0), Interval(0.0)};
        const IntervalVector moment = cross(way.shift, w);
        for (int i = 0; i < 3; ++i) {
          v[i] = static_cast<double>(factor.sign) * (v[i] + moment[i]);
          w[i] *= static_cast<double>(factor.sign);
        }
        screws.emplace_back(w, v);
        freedom.push_back(factor.freedom);
      }
      way = way * place_of(factor, increment);
    }
    const IntervalRotation& r = way.rotation;
    const int row = 6 * loop;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      result.values[row + i] = (r[k][j] - r[j][k]) / 2.0;
      result.values[row + 3 + i] = way.shift[i] / model_.size;
    }
    for (std::size_t s = 0; s < screws.size(); ++s) {
      const auto& [w, v] = screws[s];
      const Interval scale(model_.freedoms[freedom[s]].translational ? model_.size : 1.0);
      // d(R) = ŵ R, d(shift) = w × shift + v.
      IntervalRotation rate;
      for (int c = 0; c < 3; ++c) {
        const IntervalVector column = cross(w, IntervalVector{r[0][c], r[1][c], r[2][c]});
        for (int i = 0; i < 3; ++i) rate[i][c] = column[i];
      }
      const IntervalVector turn = cross(w, way.shift);
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        result.jacobian(row + i, freedom[s]) += scale * (rate[k][j] - rate[j][k]) / 2.0;
        result.jacobian(row + 3 + i, freedom[s]) += scale * (turn[i] + v[i]) / model_.size;
      }
    }
  }

  const Model& model_;
  int columns_;
  std::vector<std::vector<Factor>> loops_;
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
  constexpr double kZero = 1e-10, kDoubt = 1e-7;  // of the greatest pivot
  const auto leading = [&](const Eigen::MatrixXd& matrix) -> std::optional<std::vector<int>> {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
    std::vector<int> columns;
    for (Eigen::Index i = 0; i < qr.matrixR().diagonal().size(); ++i) {
      const double pivot = std::abs(qr.matrixR()(i, i)) / qr.maxPivot();
      if (!(pivot > kZero)) break;
      if (pivot < kDoubt) return std::nullopt;
      columns.push_back(qr.colsPermutation().indices()[i]);
    }
    return columns;
  };
  Independent result;
  const auto rows = leading(jacobian.transpose());
  if (!rows) return result;
  const auto columns = leading(jacobian(*rows, Eigen::all));
  if (!columns || columns->size() != rows->size()) return result;
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
