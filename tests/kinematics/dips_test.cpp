#include "kinematics/dips.hpp"

#include <gtest/gtest.h>

#include "kinematics/singularity.hpp"
#include "kinematics/singularity_map.hpp"
#include "kinematics/touched_curves.hpp"
#include "kinematics/workspace.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

TEST(Dips, AreWhereBothFallsMeetAtZero) {
  const auto at = [](const auto& f, double zero, double steps = 1) {
    return is_dip(f(-1 - zero), f(-zero), f(steps - zero), f(steps + 1 - zero), steps);
  };
  const auto vee = [](double x) { return std::abs(x); };
  const auto bent = [](double x) { return std::abs(x) / (1 + 0.03 * x * x); };
  const auto valley = [](double x) { return std::hypot(x, 2); };
  const auto slope = [](double x) { return 10 + x; };
  const auto parabola = [](double x) { return x * x; };
  for (double zero : {0.01, 0.3, 0.5, 0.99}) {
    EXPECT_TRUE(at(vee, zero)) << zero;
    EXPECT_TRUE(at(bent, zero)) << zero;
    EXPECT_TRUE(at(parabola, zero)) << zero;
    EXPECT_FALSE(at(valley, zero)) << zero;
    EXPECT_FALSE(at(slope, zero)) << zero;
  }
  EXPECT_TRUE(at(vee, 1, 2));  // a node on it
  EXPECT_FALSE(at(vee, 2.7));
}

TEST(Dips, BottomsAreFoundTogether) {
  const std::vector<double> places{0.1, 0.37, 0.999};
  const auto found = bottoms(3, [&](const std::vector<double>& ways) {
    std::vector<double> heights;
    for (std::size_t i = 0; i < ways.size(); ++i)
      heights.push_back(std::abs(ways[i] - places[i / 2]) + (i / 2 == 1 ? 0.25 : 0));
    return heights;
  });
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i].at, places[i], 1e-12);
  EXPECT_LT(found[0].height, 1e-12);
  EXPECT_NEAR(found[1].height, 0.25, 1e-12);
  EXPECT_TRUE(bottoms(0, [](const std::vector<double>&) { return std::vector<double>{}; }).empty());
}

// 1/κ of a disc of nodes, zero on the line y = 7.4 + 0.3 x, or on one through nodes.
TEST(TouchedCurves, FollowAnyStraightLine) {
  constexpr int kWidth = 30, kHeight = 26;
  for (const auto& [rise, at] : {std::pair{0.3, 7.4}, {-0.7, 20.1}, {0.0, 9.0}, {0.5, 4.0}}) {
    const auto height = [&](double x, double y) { return std::abs(y - at - rise * x); };
    std::vector<double> heights;
    for (int j = 0; j < kHeight; ++j)
      for (int i = 0; i < kWidth; ++i)
        heights.push_back(std::hypot(i - 14, j - 12) < 11.3 ? height(i, j) : std::nan(""));
    const std::vector<signed char> signs(heights.size(), 1);
    const auto ask = [&](const std::vector<std::array<double, 2>>& nodes) {
      std::vector<double> result;
      for (const auto& [x, y] : nodes) result.push_back(height(x, y));
      return result;
    };
    const auto found = touched_curves(heights, signs, kWidth, ask);
    std::size_t points = 0;
    for (const Contour& contour : found) {
      points += contour.points.size();
      for (const auto& [x, y] : contour.points) EXPECT_LT(height(x, y), 1e-9) << rise;
    }
    EXPECT_GT(points, 12u) << rise;
    std::vector<signed char> changing;
    for (int j = 0; j < kHeight; ++j)
      for (int i = 0; i < kWidth; ++i) changing.push_back(j - at - rise * i > 0 ? 1 : -1);
    // det J changes its sign: no touch
    EXPECT_TRUE(touched_curves(heights, changing, kWidth, ask).empty()) << rise;
  }
}

// Four rods on guides 400 mm above home: where all of them lie flat, the platform can rise and tilt
// with the drives held. det J is zero there to the second degree and keeps its sign.
constexpr double kFlat = 0.4;

TEST(SingularWall, EndsTheWorkspaceWhereAllRodsLieFlat) {
  const Machine machine = catalog_machine("table1-1");
  const Workspace dut = compute_workspace(machine);
  EXPECT_NEAR(dut.upper.z(), kFlat, 5e-6);
  EXPECT_TRUE(dut.limits_hit.contains("singularity"));
  EXPECT_EQ(dut.method, "quadrature");
  EXPECT_GT(dut.reach, 1.5 * dut.volume);  // what rods and strokes allow goes on beyond
  EXPECT_TRUE(dut.certified);
  EXPECT_LE(dut.volume_lower, dut.volume);
  EXPECT_GE(dut.volume_upper, dut.volume);
  EXPECT_LT(dut.volume_upper - dut.volume_lower, 0.03 * dut.volume);
  EXPECT_LE(dut.inscribed_box.center.z() + dut.inscribed_box.size.z() / 2, kFlat + 1e-9);
}

TEST(SingularWall, IsMetOnAWayAndDrawnInAMap) {
  const Machine machine = catalog_machine("table1-1");
  const auto at = [](double z) {
    Pose pose;
    pose.position = Vector3(0.02, 0.03, z);
    return pose;
  };
  // On a sample, between samples, in the last piece, in the first.
  for (const auto& [from, to] :
       {std::pair{0.38, 0.42}, {0.38, 0.45}, {0.38, 0.4001}, {0.3999, 0.45}}) {
    const PathSingularities way = singularities_on_path(machine, at(from), at(to));
    EXPECT_TRUE(way.reached);
    ASSERT_EQ(way.crossings.size(), 1u);
    EXPECT_NEAR(way.crossings[0].pose.position.z(), kFlat, 1e-6);
    EXPECT_TRUE(way.crossings[0].singularity.direct);
    EXPECT_EQ(way.smallest_margin, 0);
  }
  SingularityMapOptions options;
  options.axes = {0, 2};
  const SingularityMap map = singularity_map(machine, options);
  const auto flat = [](const SingularCurve& curve) {
    return std::ranges::all_of(curve.points,
                               [](const auto& point) { return std::abs(point[1] - kFlat) < 1e-6; });
  };
  EXPECT_EQ(std::ranges::count_if(map.curves, flat), 1);
}

TEST(SingularWall, IsNoneWhereTheSignChanges) {
  const Machine machine = catalog_machine("linear-delta");
  const Evaluator evaluator(machine);
  Probe probe(evaluator, Eigen::Quaterniond::Identity());
  EXPECT_FALSE(explore(probe, 20000).empty);
  EXPECT_FALSE(probe.wall());
}

}  // namespace
}  // namespace polyglide
