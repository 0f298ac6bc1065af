#include "kinematics/exact_measure.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "kinematics/point_machine.hpp"
#include "kinematics/real_roots.hpp"
#include "kinematics/workspace.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

/// All places where the limits hold, in the part that holds home.
ExactMeasure reach_of(const Machine& machine, double tolerance) {
  const Evaluator evaluator(machine);
  const Probe probe(evaluator, Eigen::Quaterniond::Identity());
  const auto limits =
      LineLimits::make(machine, {}, Eigen::Quaterniond::Identity(), search_bounds(probe));
  if (!limits) return {};
  const Vector3 extent = limits->extent().upper - limits->extent().lower;
  const double box = extent.y() * extent.z() * (limits->dimensions() == 3 ? extent.x() : 1);
  ExactSearch search;
  search.tolerance = tolerance;
  return measure_exactly(*limits, Vector3::Zero(), limits->extent(), box / 10, search)
      .value_or(ExactMeasure{});
}

/// Struts from points to the tool, which only translates; they get as long as `longest`.
Machine tripod(const std::vector<Vector3>& feet, const Vector3& tool, double longest) {
  Mechanism mechanism = strutted({{feet[0], tool}, {feet[1], tool}, {feet[2], tool}});
  for (std::size_t i = 0; i < 3; ++i) {
    const double length = (tool - feet[i]).norm();
    mechanism.joints[3 * i + 1].range = {{-length, longest - length}};
  }
  mechanism.tool = tool;
  return prepare(mechanism, task_of({0, 1, 2}));
}

double value_of(const char* name) { return truth()[name]["value"].get<double>(); }

void expect_measured(const Machine& machine, double expected) {
  EXPECT_NEAR(reach_of(machine, 1e-6).value, expected, 1e-6 * expected);
  const ExactMeasure fine = reach_of(machine, 1e-9);
  EXPECT_NEAR(fine.value, expected, 1e-9 * expected);
  EXPECT_TRUE(fine.reached);
  EXPECT_LE(fine.error, 1e-9 * expected);
}

TEST(ExactMeasure, LinearDelta) {
  expect_measured(prepare(linear_delta(0.25, 1, 1.5, -0.4), task_of({0, 1, 2})),
                  value_of("linear_delta_vertical_e0.25_L1.0_H1.5"));
}

TEST(ExactMeasure, OrthoglideIsTheSolidOfThreeCylinders) {
  expect_measured(prepare(orthoglide(1), task_of({0, 1, 2})), value_of("orthoglide_reach_volume"));
}

TEST(ExactMeasure, ThreeUnitSpheres) {
  const double r = 1 / std::sqrt(3);
  std::vector<Vector3> feet;
  for (int i = 0; i < 3; ++i)
    feet.push_back(r * Vector3(std::cos(i * M_PI / 1.5), std::sin(i * M_PI / 1.5), 0));
  expect_measured(tripod(feet, Vector3(0, 0, 0.3), 1), value_of("three_unit_spheres_distance1"));
}

TEST(ExactMeasure, TwoSpheresThatAreLegsTwiceMakeALens) {
  const Vector3 a(0, 0, 0), b(1, 0, 0);
  expect_measured(tripod({a, b, b}, Vector3(0.5, 0.2, 0.3), 1), value_of("two_spheres_lens"));
}

TEST(ExactMeasure, AHexapodWhoseShellsCoincideSaysThatItIsSingular) {
  std::vector<std::pair<Vector3, Vector3>> limbs;
  for (int i = 0; i < 6; ++i) {
    const double angle = i * M_PI / 3 + (i % 2 == 0 ? 0.2 : -0.2);
    const Vector3 foot(std::cos(angle), std::sin(angle), 0);
    limbs.emplace_back(foot, foot + Vector3(0, 0, 1.25));
  }
  const Machine machine = prepare(strutted(limbs, {-0.25, 0.25}), task_of({0, 1, 2, 3, 4, 5}));
  const double expected = value_of("gough_congruent_const_orientation");
  const Workspace workspace = compute_workspace(machine);
  EXPECT_NEAR(workspace.volume, expected, 1e-6 * expected);
  EXPECT_EQ(workspace.method, "quadrature");
  EXPECT_TRUE(workspace.singular_throughout);
}

/// Cranks and rods of length 1, base joints 1 apart.
Machine five_bar() {
  Mechanism mechanism;
  mechanism.name = "five-bar";
  mechanism.bodies = {"base", "rod1", "rod2", "crank1", "crank2"};
  mechanism.platform = 1;
  const Vector3 elbow1(std::cos(2.0), std::sin(2.0), 0);
  const Vector3 elbow2(1 + std::cos(1.1), std::sin(1.1), 0);
  const Vector3 half = (elbow2 - elbow1) / 2;
  const Vector3 tool =
      elbow1 + half + std::sqrt(1 - half.squaredNorm()) * Vector3::UnitZ().cross(half).normalized();
  mechanism.tool = tool;
  mechanism.joints = {joint_of("a1", JointType::revolute, 0, 3, Vector3::Zero()),
                      joint_of("a2", JointType::revolute, 0, 4, Vector3::UnitX()),
                      joint_of("e1", JointType::revolute, 3, 1, elbow1),
                      joint_of("e2", JointType::revolute, 4, 2, elbow2),
                      joint_of("tool", JointType::revolute, 1, 2, tool)};
  mechanism.joints[0].driven = mechanism.joints[1].driven = {0};
  return prepare(mechanism);
}

TEST(ExactMeasure, AFiveBarReachesALens) {
  const auto point = point_machine(five_bar());
  ASSERT_TRUE(point);
  expect_measured(*point, value_of("five_bar_reach_area"));
  WorkspaceOptions options;
  options.ignored = {"singularity"};
  const double expected = value_of("five_bar_reach_area");
  EXPECT_NEAR(compute_workspace(five_bar(), options).area, expected, 1e-6 * expected);
}

TEST(ExactMeasure, APrismOfPlanes) {
  const Machine machine = block();
  EXPECT_NEAR(reach_of(machine, 1e-9).value, 0.4 * 0.4 * 0.2, 1e-9 * 0.032);
}

TEST(ExactMeasure, AgreesWithSamplesOnOneSideOfASingularSurface) {
  const Vector3 tool(0, 0, 0.3);
  const double r = 1 / std::sqrt(3);
  std::vector<Vector3> feet;
  for (int i = 0; i < 3; ++i)
    feet.push_back(r * Vector3(std::cos(i * M_PI / 1.5), std::sin(i * M_PI / 1.5), 0));
  const Workspace workspace = compute_workspace(tripod(feet, tool, 1));
  const double whole = value_of("three_unit_spheres_distance1");
  EXPECT_EQ(workspace.method, "quadrature");
  EXPECT_NEAR(workspace.volume, whole / 2, 1e-6 * whole);
  ASSERT_TRUE(workspace.reach);
  EXPECT_NEAR(*workspace.reach, whole, 1e-6 * whole);
}

TEST(ExactMeasure, IsTheSameForAnyNumberOfThreads) {
  const Machine machine = prepare(linear_delta(0.25, 1, 1.5, -0.4), task_of({0, 1, 2}));
  const double two = reach_of(machine, 1e-5).value;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(two, reach_of(machine, 1e-5).value);
}

TEST(ExactMeasure, MachinesWithoutClosedFormHaveNone) {
  const Machine machine = catalog_machine("3-rps");
  EXPECT_FALSE(LineLimits::make(machine, {}, Eigen::Quaterniond::Identity(), {}));
}

TEST(RealRoots, OfProductsOfLines) {
  // (z - 1)(z - 2)(z + 3)(z + 0.5)
  const Quartic expanded{3.0, 2.5, -7.0, 0.5, 1};
  const Roots roots = real_roots(expanded, -5, 5);
  ASSERT_EQ(roots.count, 4);
  EXPECT_NEAR(roots.at[0], -3, 1e-12);
  EXPECT_NEAR(roots.at[1], -0.5, 1e-12);
  EXPECT_NEAR(roots.at[2], 1, 1e-12);
  EXPECT_NEAR(roots.at[3], 2, 1e-12);
  EXPECT_EQ(real_roots(expanded, 0, 1.5).count, 1);
  EXPECT_EQ(real_roots({1, 0, 1, 0, 0}, -9, 9).count, 0);
  EXPECT_EQ(real_roots({}, -9, 9).count, 0);
}

}  // namespace
}  // namespace polyglide
