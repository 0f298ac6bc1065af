#include "kinematics/pieces.hpp"

#include <gtest/gtest.h>

namespace polyglide {
namespace {

struct Height {
  std::vector<int> pattern;
  std::vector<double> numbers;
};

/// Integral of a function of one number over [-2, 2] from marks 0.25 apart, and its leaves.
template <typename Function>
Pieces<Height, Function> integrated(const Function& function, double tolerance) {
  Pieces<Height, Function> pieces(function, 4, tolerance);
  std::vector<typename Pieces<Height, Function>::Mark> marks;
  for (int i = -8; i <= 8; ++i) marks.push_back({i / 4.0, function(i / 4.0, {}, {})});
  pieces.run(marks);
  pieces.finish();
  return pieces;
}

template <typename P>
double integral(const P& pieces) {
  double value = 0;
  for (const auto& leaf : pieces.leaves) value += sum_of(leaf.integrals);
  return value;
}

TEST(Pieces, HalfADiscWhoseEdgesAreSquareRoots) {
  const double r = 1.2345;
  const auto disc = [r](double x, const Height&, const Height&) -> Height {
    return std::abs(x) < r ? Height{{1}, {std::sqrt(r * r - x * x)}} : Height{};
  };
  for (const double tolerance : {1e-4, 1e-7, 1e-10}) {
    const auto dut = integrated(disc, tolerance);
    EXPECT_NEAR(integral(dut), M_PI * r * r / 2, tolerance);
    EXPECT_LT(dut.error, 2 * tolerance);
  }
}

TEST(Pieces, AKinkIsFoundByItsPattern) {
  const auto roof = [](double x, const Height&, const Height&) -> Height {
    return {{x < 0.1234 ? 1 : 2}, {2 - std::abs(x - 0.1234)}};
  };
  const double left = 2.1234, right = 2 - 0.1234;
  EXPECT_NEAR(integral(integrated(roof, 1e-10)), 8 - (left * left + right * right) / 2, 1e-10);
}

TEST(Pieces, NothingIsNothing) {
  const auto empty = [](double, const Height&, const Height&) -> Height { return {}; };
  const auto dut = integrated(empty, 1e-9);
  EXPECT_EQ(integral(dut), 0);
  EXPECT_EQ(dut.error, 0);
}

}  // namespace
}  // namespace polyglide
