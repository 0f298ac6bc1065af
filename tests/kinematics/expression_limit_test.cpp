#include <gtest/gtest.h>

#include "kinematics/workspace.hpp"
#include "late_limits.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

TEST(Expressions, BoundTheWorkspaceAsPlanesAndBallsDo) {
  Mechanism mechanism = balls(0);
  mechanism.clearances.clear();
  mechanism.shapes.clear();
  mechanism.expressions = {{"ball", "hypot(hypot(x, y), z)", {-1e9, 250}}, {"up", "q3", {0, 1e9}}};
  const Machine machine = prepare(mechanism, task_of({0, 1, 2}));
  const double radius = 0.25;
  const Workspace workspace = compute_workspace(machine);
  EXPECT_NEAR(workspace.volume, 2 * M_PI / 3 * std::pow(radius, 3), 2e-3 * workspace.volume);
  EXPECT_FALSE(workspace.certified);
  EXPECT_GT(workspace.limits_hit.at("ball"), 0.3);
  EXPECT_EQ(solve_inverse(machine, Pose{{0, 0, -0.01}, Eigen::Quaterniond::Identity()}).limit,
            "up");
  EXPECT_TRUE(solve_inverse(machine, Pose{{0, 0, -0.01}, Eigen::Quaterniond::Identity()}, {"up"})
                  .reachable);
}

TEST(Expressions, WithoutAValueStopAPose) {
  Mechanism mechanism = orthoglide(50);
  mechanism.expressions = {{"root", "sqrt(x)", {-1e9, 1e9}}};
  const Machine machine = prepare(mechanism, task_of({0, 1, 2}));
  EXPECT_TRUE(solve_inverse(machine, Pose{{0.01, 0, 0}, Eigen::Quaterniond::Identity()}).reachable);
  EXPECT_EQ(solve_inverse(machine, Pose{{-0.01, 0, 0}, Eigen::Quaterniond::Identity()}).limit,
            "root");
}

TEST(Expressions, KnowAnglesAndDrivesInTheUnitsOfTheFile) {
  expect_same_as_general(with("hexapod-6ups", R"({"limits": [
    {"name": "tilt", "expression": "abs(a) + abs(b) + 0", "max": 15},
    {"name": "sum", "expression": "strut1.strut + q2 + Rb/10", "min": -100, "max": 200}]
})"),
                         0.2, 0.3);
}

}  // namespace
}  // namespace polyglide
