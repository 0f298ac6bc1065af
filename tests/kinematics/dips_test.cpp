#include "kinematics/dips.hpp"

#include <gtest/gtest.h>

#include "kinematics/singularity.hpp"
#include "kinematics/singularity_map.hpp"
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
  for (double zero : {0.01, 0.3, 0.5, 0.99}) {
    EXPECT_TRUE(at(vee, zero)) << zero;
    EXPECT_TRUE(at(bent, zero)) << zero;
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

TEST(Dips, PartAGridIntoClasses) {
  constexpr int kWidth = 7;
  std::vector<double> heights;
  std::vector<signed char> signs;
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < kWidth; ++i) {
      heights.push_back(std::abs(i - 2.4));
      signs.push_back(1);
    }
  const auto dips = dips_of(heights, signs, kWidth);
  EXPECT_EQ(dips.size(), 5u);
  const auto classes = classes_apart(heights, kWidth, dips);
  for (std::size_t n = 0; n < classes.size(); ++n) EXPECT_EQ(classes[n], n % kWidth < 3 ? 1 : 0);
  for (std::size_t n = 0; n < signs.size(); ++n) signs[n] = n % kWidth < 3 ? 1 : -1;
  EXPECT_TRUE(dips_of(heights, signs, kWidth).empty());  // det J changes its sign: no touch
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
  for (const double end : {0.42, 0.45}) {
    const PathSingularities way = singularities_on_path(machine, at(0.38), at(end));
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
