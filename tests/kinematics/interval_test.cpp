#include "kinematics/interval.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "kinematics/interval_matrix.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

// 113 bits hold the sum and the product of two doubles of like size exactly, and
// quotients and roots to far beyond a double's last place.
__extension__ using Quad = __float128;

/// Numbers of all sizes and signs, some with few bits, so that exact results occur.
class Numbers {
 public:
  double operator()() {
    const double mantissa = uniform_() * (++count_ % 3 == 0 ? 1.0 : 0x1p-20);
    const int exponent = static_cast<int>(20 * uniform_());
    const double value =
        std::ldexp(count_ % 5 == 0 ? std::round(16 * mantissa) : mantissa, exponent);
    return count_ % 97 == 0 ? 0 : value;
  }
  Interval interval() {
    const double a = (*this)(), b = (*this)();
    return count_ % 7 == 0 ? Interval(a) : Interval(std::min(a, b), std::max(a, b));
  }
  /// A number inside, often an end.
  double inside(const Interval& x) {
    const double way = uniform_();
    if (way < -0.5) return x.lower();
    if (way > 0.5) return x.upper();
    return std::clamp(x.lower() + (way + 0.5) * (x.upper() - x.lower()), x.lower(), x.upper());
  }

 private:
  fixtures::Uniform uniform_;
  std::uint64_t count_ = 0;
};

bool holds(const Interval& x, Quad value) { return x.lower() <= value && value <= x.upper(); }

constexpr int kCases = 200000;

TEST(IntervalArithmetic, EnclosesTheExactResult) {
  const UpwardRounding rounding;
  Numbers numbers;
  int wrong = 0;
  for (int i = 0; i < kCases; ++i) {
    const Interval x = numbers.interval(), y = numbers.interval();
    const double a = numbers.inside(x), b = numbers.inside(y);
    wrong += !holds(x + y, static_cast<Quad>(a) + b);
    wrong += !holds(x - y, static_cast<Quad>(a) - b);
    wrong += !holds(x * y, static_cast<Quad>(a) * b);
    wrong += !holds(square(x), static_cast<Quad>(a) * a);
    if (mignitude(y) > 0) wrong += !holds(x / y, static_cast<Quad>(a) / b);
    if (a >= 0) {
      const Interval r = root(x);
      wrong += !(static_cast<Quad>(r.lower()) * r.lower() <= a &&
                 static_cast<Quad>(r.upper()) * r.upper() >= a);
    }
    wrong += !(radius(x) >= std::abs(a - middle(x)) * (1 - 1e-15));
  }
  EXPECT_EQ(wrong, 0);
}

TEST(IntervalArithmetic, IsTight) {
  const UpwardRounding rounding;
  Numbers numbers;
  for (int i = 0; i < 1000; ++i) {
    const Interval x(numbers()), y(numbers());
    const Interval sum = x + y;
    EXPECT_LE(sum.upper() - sum.lower(), 1e-15 * magnitude(sum));
  }
  const Interval third = Interval(1.0) / 3.0;
  EXPECT_LT(third.lower(), third.upper());  // not a number of the machine
  const Interval sum = Interval(0.1) + 0.2;
  EXPECT_LT(sum.lower(), sum.upper());  // folded constants have no width
}

TEST(IntervalArithmetic, CosinesAndSinesAreEnclosed) {
  const UpwardRounding rounding;
  fixtures::Uniform uniform;
  for (int i = 0; i < kCases / 10; ++i) {
    const double a = 5 * uniform(), width = i % 3 == 0 ? 0 : 2 * std::abs(uniform());
    const Interval x(a, a + width);
    const double inside = std::min(x.upper(), a + width * (uniform() + 1) / 2);
    // The long functions are right to 64 bits.
    const long double c = std::cos(static_cast<long double>(inside));
    const long double s = std::sin(static_cast<long double>(inside));
    EXPECT_TRUE(holds(cosine(x), c)) << a << " " << width;
    EXPECT_TRUE(holds(sine(x), s)) << a << " " << width;
  }
  EXPECT_EQ(cosine(Interval(-0.1, 0.1)).upper(), 1);
  EXPECT_EQ(cosine(Interval(3.1, 3.2)).lower(), -1);
  EXPECT_EQ(cosine(Interval(-3.2, -3.1)).lower(), -1);
  EXPECT_EQ(cosine(Interval(0, 100)).lower(), -1);
  EXPECT_LT(radius(sine(Interval(0.5))), 1e-14);
}

TEST(IntervalArithmetic, RoundingIsAsBeforeAfterwards) {
  const double third = 1.0 / [] {
    volatile double three = 3;
    return double(three);
  }();
  {
    const UpwardRounding rounding;
    volatile double one = 1, three = 3;
    EXPECT_GT(one / three, third);
  }
  volatile double one = 1, three = 3;
  EXPECT_EQ(one / three, third);
}

IntervalMatrix around(const Eigen::MatrixXd& centre, double width) {
  IntervalMatrix matrix(static_cast<int>(centre.rows()), static_cast<int>(centre.cols()));
  for (int i = 0; i < matrix.rows(); ++i)
    for (int j = 0; j < matrix.cols(); ++j)
      matrix(i, j) = Interval(centre(i, j) - width, centre(i, j) + width);
  return matrix;
}

TEST(IntervalMatrices, SingularValuesOfEveryMatrixInsideAreBounded) {
  fixtures::Uniform uniform;
  for (int i = 0; i < 300; ++i) {
    const int n = 2 + i % 5, m = n + i % 2;
    const double width = std::pow(10, -1 - i % 12);
    const Eigen::MatrixXd centre = Eigen::MatrixXd::NullaryExpr(m, n, [&] { return uniform(); });
    const Eigen::MatrixXd other =
        centre + width * 0.999 * Eigen::MatrixXd::NullaryExpr(m, n, [&] { return uniform(); });
    const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(other).singularValues();
    const UpwardRounding rounding;
    const SingularValues bounds = singular_value_bounds(around(centre, width));
    EXPECT_LE(bounds.least_lower, values[n - 1] + 1e-14);
    EXPECT_GE(bounds.greatest_upper, values[0] - 1e-14);
    if (width < 1e-10) {
      EXPECT_NEAR(bounds.least_lower, values[n - 1], 1e-8);
      EXPECT_NEAR(bounds.greatest_upper, values[0], 1e-8);
    }
  }
}

TEST(IntervalMatrices, TheSignOfADeterminantIsProvedOrLeftOpen) {
  fixtures::Uniform uniform;
  int decided = 0;
  for (int i = 0; i < 300; ++i) {
    const int n = 1 + i % 6;
    const double width = std::pow(10, -1 - i % 12);
    const Eigen::MatrixXd centre = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return uniform(); });
    const Eigen::MatrixXd other =
        centre + width * 0.999 * Eigen::MatrixXd::NullaryExpr(n, n, [&] { return uniform(); });
    const double determinant = other.determinant();
    const UpwardRounding rounding;
    const int sign = determinant_sign(around(centre, width));
    if (sign != 0) {
      EXPECT_EQ(sign, determinant > 0 ? 1 : -1);
    }
    decided += sign != 0;
  }
  EXPECT_GT(decided, 150);
  const UpwardRounding rounding;
  Eigen::MatrixXd singular(2, 2);
  singular << 1, 2, 2, 4;
  EXPECT_EQ(determinant_sign(around(singular, 0)), 0);
  EXPECT_EQ(singular_value_bounds(around(singular, 1e-9)).least_lower, 0);
}

}  // namespace
}  // namespace polyglide
