#include "kinematics/singular_values.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

/// Least and greatest singular value the plain way.
std::pair<double, double> by_svd(const Eigen::MatrixXd& j) {
  const Eigen::VectorXd s = Eigen::JacobiSVD<Eigen::MatrixXd>(j).singularValues();
  return {s[s.size() - 1], s[0]};
}

template <int N>
simd::Extremes<double> from_gram(const Eigen::MatrixXd& j) {
  double gram[N][N];
  const Eigen::MatrixXd product = j.transpose() * j;
  for (int r = 0; r < N; ++r)
    for (int c = 0; c < N; ++c) gram[r][c] = product(r, c);
  const double det = j.determinant();
  if constexpr (N == 2) return simd::extremes2<double>(gram, det * det);
  if constexpr (N == 3) return simd::extremes3<double>(gram, det * det);
  if constexpr (N > 3) return simd::extremes<double, N>(gram);
}

template <int N>
simd::Extremes<double> by_rotations(const Eigen::MatrixXd& j) {
  double columns[N][N];
  for (int r = 0; r < N; ++r)
    for (int c = 0; c < N; ++c) columns[c][r] = j(r, c);
  const auto found = simd::one_sided_jacobi<double, N, N>(columns, N, N);
  return {found.least, found.greatest, false};
}

Eigen::MatrixXd turned(const Eigen::VectorXd& singular, Uniform& random) {
  const Eigen::Index n = singular.size();
  Eigen::MatrixXd a(n, n), b(n, n);
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c) a(r, c) = random(), b(r, c) = random();
  const Eigen::MatrixXd q = a.householderQr().householderQ();
  const Eigen::MatrixXd p = b.householderQr().householderQ();
  return q * singular.asDiagonal() * p;
}

/// The kernel's answer: the fast one, or the careful one where that is doubtful.
template <int N>
simd::Extremes<double> answer(const Eigen::MatrixXd& j) {
  const auto fast = from_gram<N>(j);
  return fast.doubtful ? by_rotations<N>(j) : fast;
}

template <int N>
void compare_random(double decades) {
  Uniform random;
  int doubtful = 0;
  for (int i = 0; i < 1000; ++i) {
    Eigen::MatrixXd j(N, N);
    for (int k = 0; k < N; ++k) {
      for (int r = 0; r < N; ++r) j(r, k) = random();
      j.col(k) *= std::pow(10, decades * random());
    }
    const auto [least, greatest] = by_svd(j);
    const auto found = answer<N>(j);
    doubtful += from_gram<N>(j).doubtful;
    EXPECT_NEAR(std::sqrt(found.greatest) / greatest, 1, 1e-12) << N;
    // JᵀJ keeps 1e-16 κ² of the least square; beyond κ = 300 rotations take over.
    const double kappa = greatest / least;
    EXPECT_NEAR(std::sqrt(found.least) / least, 1, 1e-12 + 1e-14 * std::min(kappa * kappa, 1e5))
        << N;
  }
  if (decades == 0) {
    EXPECT_LT(doubtful, 60) << N;
  }
}

TEST(SingularValues, AgreeWithTheDecompositionOfRandomMatrices) {
  for (double decades : {0.0, 1.5}) {
    compare_random<2>(decades);
    compare_random<3>(decades);
    compare_random<4>(decades);
    compare_random<5>(decades);
    compare_random<6>(decades);
  }
}

template <int N>
void compare_repeated() {
  Uniform random;
  for (double share : {0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3})
    for (int equal = 2; equal <= N; ++equal)
      for (bool low : {true, false}) {
        Eigen::VectorXd values(N);
        for (int k = 0; k < N; ++k) values[k] = 1 + 0.7 * k;
        for (int k = 0; k < equal; ++k)
          values[low ? k : N - 1 - k] = (low ? 1 : 1 + 0.7 * (N - 1)) * (1 + share * k);
        const Eigen::MatrixXd j = turned(values, random);
        const auto found = answer<N>(j);
        EXPECT_NEAR(std::sqrt(found.least), values.minCoeff(), 1e-11) << N << ' ' << equal;
        EXPECT_NEAR(std::sqrt(found.greatest), values.maxCoeff(), 1e-11) << N << ' ' << equal;
      }
}

TEST(SingularValues, RepeatedAndNearlyRepeatedOnesKeepTheirDigits) {
  compare_repeated<2>();
  compare_repeated<3>();
  compare_repeated<4>();
  compare_repeated<5>();
  compare_repeated<6>();
}

template <int N>
void check_special() {
  using Matrix = Eigen::MatrixXd;
  for (const double scale : {1.0, 1e3, 1e-6}) {
    const Matrix identity = scale * Matrix::Identity(N, N);
    EXPECT_NEAR(std::sqrt(answer<N>(identity).least), scale, 1e-15 * scale) << N;
    EXPECT_NEAR(std::sqrt(answer<N>(identity).greatest), scale, 1e-15 * scale) << N;
  }
  Matrix flat = Matrix::Identity(N, N);
  flat(N - 1, N - 1) = 0;
  EXPECT_EQ(answer<N>(flat).least, 0) << N;
  EXPECT_NEAR(answer<N>(flat).greatest, 1, 1e-15) << N;
  const Matrix one = Matrix::Ones(N, N);
  EXPECT_NEAR(answer<N>(one).greatest, N * N, 1e-12) << N;
  EXPECT_NEAR(answer<N>(one).least, 0, 1e-28) << N;
  EXPECT_EQ(answer<N>(Matrix::Zero(N, N)).greatest, 0) << N;
}

TEST(SingularValues, MultiplesOfTheIdentityAndSingularMatricesAreRight) {
  check_special<2>();
  check_special<3>();
  check_special<4>();
  check_special<5>();
  check_special<6>();
}

TEST(SingularValues, RotationsKeepTheDigitsOfIllConditionedMatrices) {
  Uniform random;
  for (double least : {9e-4, 1e-6, 1e-9}) {
    Eigen::VectorXd values(6);
    values << 1, 2, 2, 3, 1, least;
    const Eigen::MatrixXd j = turned(values, random);
    EXPECT_NEAR(std::sqrt(answer<6>(j).least), least, 1e-14) << least;
  }
}

TEST(SingularValues, FactorsSolveAndInvert) {
  Uniform random;
  for (int i = 0; i < 100; ++i) {
    Eigen::MatrixXd a(5, 5);
    for (int r = 0; r < 5; ++r)
      for (int c = 0; c < 5; ++c) a(r, c) = random();
    const Eigen::MatrixXd g = a.transpose() * a + Eigen::MatrixXd::Identity(5, 5);
    double factors[5][5], x[5], m[5][5];
    for (int r = 0; r < 5; ++r) {
      x[r] = r + 1;
      for (int c = 0; c < 5; ++c) factors[r][c] = g(r, c), m[r][c] = a(r, c);
    }
    EXPECT_TRUE((simd::factorise<double, 5>(factors)));
    simd::solve_factorised<double, 5>(factors, x);
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(5, 1, 5);
    EXPECT_LT((g * Eigen::Map<Eigen::VectorXd>(x, 5) - right).norm(), 1e-12);
    EXPECT_NEAR((simd::trace_of_inverse<double, 5>(factors)), g.inverse().trace(), 1e-12);
    EXPECT_NEAR((simd::determinant<double, 5>(m)), a.determinant(), 1e-13);
  }
  double indefinite[2][2] = {{1, 2}, {2, 1}};
  EXPECT_FALSE((simd::factorise<double, 2>(indefinite)));
}

TEST(Sincos, AgreesWithTheLibraryInEveryQuarter) {
  for (double angle = -20; angle < 20; angle += 0.0137) {
    double sine = 0, cosine = 0;
    simd::sincos(angle, sine, cosine);
    EXPECT_NEAR(sine, std::sin(angle), 3e-16) << angle;
    EXPECT_NEAR(cosine, std::cos(angle), 3e-16) << angle;
  }
  for (double angle : {1e4, -54321.0, 99999.0}) {
    double sine = 0, cosine = 0;
    simd::sincos(angle, sine, cosine);
    EXPECT_NEAR(sine, std::sin(angle), 1e-15) << angle;
    EXPECT_NEAR(cosine, std::cos(angle), 1e-15) << angle;
  }
}

}  // namespace
}  // namespace polyglide
