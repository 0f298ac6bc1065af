#include "kinematics/second_order.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "kinematics/manifold.hpp"
#include "kinematics/rank.hpp"

namespace polyglide {
namespace {

constexpr int kStarts = 24;  // two branches are told with one in ten thousand missed
constexpr int kIterations = 30;
/// At a double zero, met to 1e-8 at best, forms keep slopes up to a few 1e-6 where they have none.
/// The search for common zeros does not see them, the closed form would.
constexpr RankScale kSoft{2e-5, 1e-2};
constexpr double kSatisfied = 1e-8;  // of a form whose coefficients are about 1
constexpr double kStuck = 1e-14;     // a step: where slopes vanish without a zero
constexpr double kPolished = 1e-12;  // double zeros are then met to a millionth
constexpr double kDamping = 1e-12;

/// Lie bracket of two twists [w; v].
Screw bracket(const Screw& a, const Screw& b) {
  Screw result;
  const Vector3 wa = a.head<3>(), wb = b.head<3>();
  result.head<3>() = wa.cross(wb);
  result.tail<3>() = wa.cross(Vector3(b.tail<3>())) + Vector3(a.tail<3>()).cross(wb);
  return result;
}

/// Σ_{i<j} [S_i, S_j] q̇_i q̇_j of every loop, stacked.
Eigen::VectorXd bracket_sums(const Model& model, const Eigen::MatrixXd& scaled,
                             const Eigen::VectorXd& rates) {
  Eigen::VectorXd sums(6 * static_cast<Eigen::Index>(model.loops.size()));
  Eigen::Index row = 0;
  for (const auto& loop : model.loops) {
    Screw passed = Screw::Zero(), sum = Screw::Zero();
    for (const auto [joint, sign] : loop) {
      const int first = model.first_freedom[joint];
      const int count = freedoms(model.mechanism.joints[joint].type);
      for (int i = 0; i < count; ++i) {
        const int f = sign > 0 ? first + i : first + count - 1 - i;
        const Screw step = sign * rates[f] * scaled.col(f);
        sum += bracket(passed, step);
        passed += step;
      }
    }
    sums.segment<6>(row) = sum;
    row += 6;
  }
  return sums;
}

/// The quadratic forms as symmetric matrices over the kernel's coordinates, made independent.
std::vector<Eigen::MatrixXd> quadratic_forms(const Model& model, const Posture& posture,
                                             const Eigen::MatrixXd& kernel,
                                             const std::vector<int>& active) {
  const Eigen::MatrixXd scaled = scaled_screws(model, freedom_screws(model, posture));
  const Eigen::MatrixXd jacobian = columns(closure_jacobian(model, posture), active);
  const Eigen::MatrixXd unresisted = screened_kernel(jacobian.transpose()).basis;
  const Eigen::Index k = kernel.cols(), pairs = k * (k + 1) / 2;
  Eigen::MatrixXd squares(unresisted.cols(), k), forms(unresisted.cols(), pairs);
  for (Eigen::Index p = 0; p < k; ++p)
    squares.col(p) = unresisted.transpose() * bracket_sums(model, scaled, kernel.col(p));
  for (Eigen::Index p = 0, pair = 0; p < k; ++p)
    for (Eigen::Index q = p; q < k; ++q, ++pair) {
      if (p == q) {
        forms.col(pair) = squares.col(p);
        continue;
      }
      const Eigen::VectorXd both =
          unresisted.transpose() * bracket_sums(model, scaled, kernel.col(p) + kernel.col(q));
      forms.col(pair) = (both - squares.col(p) - squares.col(q)) / 2;
    }
  if (forms.size() == 0) return {};
  const Svd svd = svd_of(forms);
  const int rank = decide_rank(svd.values, 1).rank;
  std::vector<Eigen::MatrixXd> matrices;
  for (int i = 0; i < rank; ++i) {
    Eigen::MatrixXd matrix(k, k);
    for (Eigen::Index p = 0, pair = 0; p < k; ++p)
      for (Eigen::Index q = p; q < k; ++q, ++pair) matrix(p, q) = matrix(q, p) = svd.v(pair, i);
    matrices.push_back(std::move(matrix));
  }
  return matrices;
}

/// A common zero of the forms on the unit sphere near `start`; false when none is reached. Steps go
/// along the sphere: free steps would shrink towards the zero vector, which solves everything.
bool solve(const std::vector<Eigen::MatrixXd>& forms, Eigen::VectorXd& start) {
  const auto m = static_cast<Eigen::Index>(forms.size());
  Eigen::VectorXd values(m);
  Eigen::MatrixXd slopes(m, start.size());
  double worst = 0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    start.normalize();
    for (Eigen::Index i = 0; i < m; ++i) {
      slopes.row(i) = 2 * (forms[i] * start).transpose();
      values[i] = slopes.row(i).dot(start) / 2;
    }
    worst = values.cwiseAbs().maxCoeff();
    if (worst < kPolished) break;
    slopes -= (slopes * start) * start.transpose();
    Eigen::MatrixXd gram = slopes * slopes.transpose();
    gram.diagonal().array() += kDamping;
    const Eigen::VectorXd step = slopes.transpose() * gram.llt().solve(values);
    if (step.squaredNorm() < kStuck * kStuck) break;
    start -= step;
  }
  start.normalize();
  return worst < kSatisfied;
}

/// Projector on the directions in which all forms stay zero to first order.
Eigen::MatrixXd tangent_projector(const std::vector<Eigen::MatrixXd>& forms,
                                  const Eigen::VectorXd& at) {
  Eigen::MatrixXd slopes(forms.size(), at.size());
  for (std::size_t i = 0; i < forms.size(); ++i)
    slopes.row(static_cast<Eigen::Index>(i)) = (forms[i] * at).transpose();
  const Eigen::MatrixXd basis = screened_kernel(slopes, 1).basis;
  return basis * basis.transpose();
}

/// A solution and the directions in which it continues.
struct Solution {
  Eigen::VectorXd at;
  Eigen::MatrixXd tangent;  ///< projector
};

/// A component of solutions, known by members of it.
struct Component {
  std::vector<Solution> members;
  bool linear = false;  ///< the whole tangent space of a member consists of solutions
};

/// Members of every component.
using Zeros = std::vector<std::vector<Eigen::VectorXd>>;

/// Whether all forms vanish on the space a projector projects to: P A P = 0.
bool vanish_on(const std::vector<Eigen::MatrixXd>& forms, const Eigen::MatrixXd& projector) {
  return std::ranges::all_of(forms, [&](const Eigen::MatrixXd& form) {
    return (projector * form * projector).cwiseAbs().maxCoeff() < 1e-4;
  });
}

/// Whether the straight way between two solutions, pulled onto the solutions at so many places,
/// stays among them while the tangent space turns gently.
bool leads(const std::vector<Eigen::MatrixXd>& forms, const Solution& from,
           const Eigen::VectorXd& to, int steps) {
  constexpr double kTurn = 0.3;  // of a projector between neighbours, Frobenius norm
  Eigen::MatrixXd before = from.tangent;
  for (int i = 1; i <= steps; ++i) {
    const double part = static_cast<double>(i) / steps;
    Eigen::VectorXd at = (1 - part) * from.at + part * to;
    if (!solve(forms, at)) return false;
    const Eigen::MatrixXd here = tangent_projector(forms, at);
    if ((here - before).norm() >= kTurn) return false;
    before = here;
  }
  return true;
}

/// Whether a solution belongs to a component, as far as a way from its nearest member shows. In a
/// linear one it lies in the tangent space of any member, and on it all forms stay zero.
bool belongs(const std::vector<Eigen::MatrixXd>& forms, const Component& component,
             const Eigen::VectorXd& to) {
  constexpr double kInside = 1e-4;
  constexpr double kStride = 0.2;  // of the unit sphere's radius
  const Solution& first = component.members.front();
  if ((to - first.tangent * to).norm() < kInside) return true;
  if (component.linear) return false;
  const auto nearness = [&](const Solution& member) { return std::abs(member.at.dot(to)); };
  const Solution& nearest = *std::ranges::max_element(component.members, {}, nearness);
  const Eigen::VectorXd target = nearest.at.dot(to) < 0 ? Eigen::VectorXd(-to) : to;
  const int steps = static_cast<int>(std::ceil((target - nearest.at).norm() / kStride));
  return leads(forms, nearest, target, steps) || leads(forms, nearest, target, 4 * steps);
}

/// Components of the common zeros of forms in `size` coordinates, found from random starts.
Zeros common_zeros(const std::vector<Eigen::MatrixXd>& forms, int size, std::mt19937_64& random) {
  Zeros zeros;
  std::vector<Component> known;
  for (int i = 0; i < kStarts && size > 0; ++i) {
    Eigen::VectorXd zero = random_direction(random, size);
    if (!solve(forms, zero)) continue;
    std::size_t place = 0;
    while (place < known.size() && !belongs(forms, known[place], zero)) ++place;
    Eigen::MatrixXd tangent = tangent_projector(forms, zero);
    if (place == known.size()) {
      known.push_back({{}, vanish_on(forms, tangent)});
      zeros.emplace_back();
    }
    known[place].members.push_back({zero, std::move(tangent)});
    zeros[place].push_back(std::move(zero));
  }
  return zeros;
}

/// How many members of a component known in closed form are drawn: as many as anybody tries, and
/// enough to span it.
Eigen::Index members_for(Eigen::Index dimension) { return std::max<Eigen::Index>(8, dimension); }

/// The same in closed form for one form that feels every coordinate. With the eigenvalues' scale
/// taken out it is |y₊|² = |y₋|²: nothing where one part is missing, two planes where both have
/// one coordinate, else one cone (both its halves, as directions count without sign).
Zeros zeros_of(const Eigen::MatrixXd& form, std::mt19937_64& random) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(form);  // values ascending
  const Eigen::VectorXd stretch = eigen.eigenvalues().cwiseAbs().cwiseSqrt().cwiseInverse();
  const Eigen::Index size = form.rows(), negative = (eigen.eigenvalues().array() < 0).count();
  if (negative == 0 || negative == size) return {};
  const auto zero = [&](Eigen::VectorXd below, Eigen::VectorXd above) -> Eigen::VectorXd {
    Eigen::VectorXd both(size);
    both << below.normalized(), above.normalized();
    return (eigen.eigenvectors() * stretch.cwiseProduct(both)).normalized();
  };
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  if (size == 2) return {{zero(one, one)}, {zero(one, -one)}};
  Zeros zeros(1);
  for (Eigen::Index i = 0; i < members_for(size); ++i)
    zeros[0].push_back(
        zero(random_direction(random, negative), random_direction(random, size - negative)));
  return zeros;
}

}  // namespace

Eigen::VectorXd random_direction(std::mt19937_64& random, Eigen::Index size) {
  Eigen::VectorXd direction(size);
  for (double& value : direction) value = 2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1;
  return direction;
}

SecondOrder second_order(const Model& model, const Posture& posture, const Eigen::MatrixXd& kernel,
                         const std::vector<int>& active, std::mt19937_64& random) {
  SecondOrder result;
  const Eigen::Index freedoms = kernel.cols();
  if (freedoms == 0) return result;
  const auto forms = quadratic_forms(model, posture, kernel, active);
  result.obstructions = static_cast<int>(forms.size());
  // Freedoms that no form feels are free to add to any solution, and solve everything by
  // themselves: the zeros are looked for among the others.
  Eigen::MatrixXd all(freedoms * static_cast<Eigen::Index>(forms.size()), freedoms);
  for (std::size_t i = 0; i < forms.size(); ++i)
    all.middleRows(freedoms * static_cast<Eigen::Index>(i), freedoms) = forms[i];
  const Svd svd = svd_of(all);
  const int felt = decide_rank(svd.values, 1, forms.size() == 1 ? kSoft : RankScale{}).rank;
  const Eigen::MatrixXd bound = svd.v.leftCols(felt), loose = svd.v.rightCols(freedoms - felt);
  std::vector<Eigen::MatrixXd> reduced;
  for (const Eigen::MatrixXd& form : forms) reduced.push_back(bound.transpose() * form * bound);

  const auto zeros =
      reduced.size() == 1 ? zeros_of(reduced[0], random) : common_zeros(reduced, felt, random);
  for (const auto& component : zeros) {
    auto& members = result.components.emplace_back();
    const Eigen::Index enough = loose.cols() > 0 ? members_for(freedoms) : 1;
    for (std::size_t i = 0; i < std::max<std::size_t>(component.size(), enough); ++i)
      members.push_back(
          (bound * component[i % component.size()] + loose * random_direction(random, loose.cols()))
              .normalized());
  }
  if (!zeros.empty() || loose.cols() == 0) return result;
  result.components.emplace_back();
  for (Eigen::Index i = 0; i < members_for(freedoms); ++i)
    result.components[0].push_back((loose * random_direction(random, loose.cols())).normalized());
  return result;
}

}  // namespace polyglide
