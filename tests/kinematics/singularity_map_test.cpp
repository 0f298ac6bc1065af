#include "kinematics/singularity_map.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "kinematics/contours.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;
using std::numbers::pi;

/// Contours of a predicate on a grid of side × side nodes.
template <typename Inside>
std::vector<Contour> contours_of(int side, const Inside& inside) {
  std::vector<signed char> classes;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) classes.push_back(inside(i, j));
  return contours(classes, side, [&](std::vector<CrossedEdge>& edges) {
    for (CrossedEdge& edge : edges)
      for (int round = 0; round < 40; ++round) {
        const std::array<double, 2> middle{(edge.one[0] + edge.other[0]) / 2,
                                           (edge.one[1] + edge.other[1]) / 2};
        (inside(middle[0], middle[1]) ? edge.one : edge.other) = middle;
      }
  });
}

TEST(Contours, OfADiscAreOneCircle) {
  const auto dut =
      contours_of(30, [](double x, double y) { return std::hypot(x - 14.3, y - 15.1) < 9.7; });
  ASSERT_EQ(dut.size(), 1u);
  EXPECT_TRUE(dut[0].closed);
  for (const auto& [x, y] : dut[0].points) EXPECT_NEAR(std::hypot(x - 14.3, y - 15.1), 9.7, 1e-9);
}

TEST(Contours, OfAHalfPlaneAreOneOpenLineAndOfNothingNone) {
  const auto dut = contours_of(10, [](double x, double y) { return x + 0.3 * y < 4.4; });
  ASSERT_EQ(dut.size(), 1u);
  EXPECT_FALSE(dut[0].closed);
  EXPECT_EQ(dut[0].points.front()[1] + dut[0].points.back()[1], 9);
  EXPECT_TRUE(contours_of(10, [](double, double) { return true; }).empty());
}

TEST(Contours, KeepCornersThatTouchDiagonallyApart) {
  const auto dut = contours({0, 0, 0, 0,  //
                             0, 1, 0, 0,  //
                             0, 0, 1, 0,  //
                             0, 0, 0, 0},
                            4, [](std::vector<CrossedEdge>&) {});
  EXPECT_EQ(dut.size(), 2u);
  EXPECT_TRUE(contours({0, 1, 2, 0}, 2, [](std::vector<CrossedEdge>&) {}).empty());
}

// The Orthoglide: s_i = sqrt(L² − x_j² − x_k²), J_ii = 1, J_ij = −x_j / s_i.
double orthoglide_determinant(double rod, const Vector3& p) {
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != j) jacobian(i, j) = -p[j] / std::sqrt(rod * rod - p.squaredNorm() + p[i] * p[i]);
  return jacobian.determinant();
}

TEST(SingularityMap, OfTheOrthoglideFollowsTheZerosOfItsDeterminant) {
  const Machine machine = prepare(orthoglide(1), task_of({0, 1, 2}));
  SingularityMapOptions options;
  options.at[2] = 1 / std::sqrt(6.0);
  const SingularityMap dut = singularity_map(machine, options);
  EXPECT_TRUE(dut.square);
  int direct = 0, ends = 0;
  double nearest = 1;
  for (const SingularCurve& curve : dut.curves) {
    (curve.kind == "direct" ? direct : ends) += 1;
    if (curve.kind == "direct") {
      EXPECT_FALSE(curve.gained.empty());
      for (const auto& [x, y] : curve.points) {
        EXPECT_NEAR(orthoglide_determinant(1, {x, y, options.at[2]}), 0, 1e-7) << x << " " << y;
        nearest = std::min(nearest, std::hypot(x - options.at[2], y - options.at[2]));
      }
    } else {
      EXPECT_NE(curve.kind.find("inverse"), std::string::npos) << curve.kind;
    }
  }
  EXPECT_GE(direct, 1);
  EXPECT_GE(ends, 1);
  EXPECT_LT(nearest, std::hypot(dut.cell[0], dut.cell[1]));
}

// Fichter 1986: a symmetric hexapod turned by 90 degrees about its axis is singular at any height.
TEST(SingularityMap, OfASymmetricHexapodTurnedByARightAngleIsAStraightLine) {
  SingularityMapOptions options;
  options.axes = {5, 2};
  options.ignored = {"cone"};
  const SingularityMap dut = singularity_map(catalog_machine("hexapod-6ups"), options);
  int lines = 0;
  for (const SingularCurve& curve : dut.curves) {
    if (curve.kind != "direct") continue;
    ++lines;
    for (const auto& point : curve.points) EXPECT_NEAR(std::abs(point[0]), pi / 2, 1e-6);
  }
  EXPECT_GE(lines, 2);
}

TEST(SingularityMap, IsQuietWhereNothingIsSingularAndKeepsTheLimits) {
  const SingularityMap dut = singularity_map(catalog_machine("hexapod-6ups"), {});
  EXPECT_EQ(dut.singular_nodes, 0);
  EXPECT_EQ(dut.limit.size(), dut.u.size() * dut.v.size());
  EXPECT_GT(std::count(dut.limit.begin(), dut.limit.end(), -1), 1000);
  for (const SingularCurve& curve : dut.curves) EXPECT_NE(curve.kind, "direct");
}

TEST(SingularityMap, NamesItsSlice) {
  SingularityMap map;
  map.axes = {0, 1};
  EXPECT_EQ(slice_words(map), "XY through home");
  map.at << 0.3, 0.4, -0.02, 0, 0, M_PI / 6;  // x and y are all over the slice
  EXPECT_EQ(slice_words(map), "XY at Z -20 mm, C 30°");
}

TEST(SingularityMap, RefusesAxesThatAreNotCommanded) {
  const Machine machine = catalog_machine("delta-1");
  SingularityMapOptions options;
  options.axes = {0, 3};
  EXPECT_THROW(singularity_map(machine, options), std::invalid_argument);
  options.axes = {1, 1};
  EXPECT_THROW(singularity_map(machine, options), std::invalid_argument);
  options = {};
  options.at[2] = std::nan("");
  EXPECT_THROW(singularity_map(machine, options), std::invalid_argument);
}

}  // namespace
}  // namespace polyglide
