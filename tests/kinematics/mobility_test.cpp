#include "kinematics/mobility.hpp"

#include <gtest/gtest.h>

#include "cases.hpp"
#include "catalog/json_file.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

/// The layout with the joint word of both ends of one limb's rods replaced.
Mechanism with_end(const std::string& name, int limb, const char* end,
                   const nlohmann::json& change) {
  nlohmann::json document = find_layout(name).document;
  document["limbs"][limb]["rods"][end].update(change);
  return expand(parse_layout(document, name));
}

// --- Table 1 of the four-axis milling machine paper: six layouts, computed ---

TEST(TableOne, Layout1MovesXYZAAndIsHeldWithTwoRedundantConstraints) {
  const MobilityReport report = check("table1-1");
  EXPECT_EQ(report.verdict, Verdict::determinate);
  EXPECT_EQ(report.pattern, "3T1R");
  EXPECT_EQ(report.axes, "XYZA");
  EXPECT_EQ(report.finite, 4);
  EXPECT_EQ(report.redundant_constraints, 2);
  EXPECT_EQ(report.home_locked_platform, 0);
}

TEST(TableOne, Layout2IsUncertainBecauseTwoFreedomsAreLeftEverywhere) {
  const MobilityReport report = check("table1-2");
  EXPECT_EQ(report.verdict, Verdict::uncertain);
  EXPECT_EQ(report.platform_dof, 6);
  EXPECT_EQ(report.locked_platform, 2);
}

TEST(TableOne, Layout3IsUncertainBecauseBranchesMeetAtHome) {
  const MobilityReport report = check("table1-3");
  EXPECT_EQ(report.verdict, Verdict::uncertain);
  EXPECT_EQ(report.home, 4);
  EXPECT_EQ(report.finite, 3);
  EXPECT_EQ(report.home_locked_platform, 1);
  EXPECT_EQ(report.locked_platform, 0);
  EXPECT_GE(report.branches.size(), 2u);
}

TEST(TableOne, Layout4IsUncertainBecauseOfASelfMotionThroughHome) {
  const MobilityReport report = check("table1-4");
  EXPECT_EQ(report.verdict, Verdict::uncertain);
  EXPECT_EQ(report.axes, "XYZC");
  EXPECT_EQ(report.locked_platform, 0);
  EXPECT_EQ(report.home_locked_platform, 1);
  ASSERT_FALSE(report.modes.empty());
  EXPECT_GT(report.modes[0].frames.size(), 5u);  // a finite motion one can animate
}

TEST(TableOne, Layout5MovesXYZOnlyAndHasOneDriveTooMany) {
  const MobilityReport report = check("table1-5");
  EXPECT_EQ(report.verdict, Verdict::overdriven);
  EXPECT_EQ(report.axes, "XYZ");
  EXPECT_EQ(report.redundant_constraints, 1);
  EXPECT_EQ(report.surplus, 1);
}

TEST(TableOne, Layout6MovesThreeTranslationsAndARotationExactlyConstrained) {
  const MobilityReport report = check("table1-6");
  EXPECT_EQ(report.verdict, Verdict::determinate);
  EXPECT_EQ(report.pattern, "3T1R");
  EXPECT_EQ(report.redundant_constraints, 0);
  EXPECT_NEAR(report.task.rotation_axis.z(), 0, 1e-9);  // a horizontal axis
}

TEST(TableOne, OneChangedJointChangesTheVerdict) {
  // One pair's cardan axis turned by 90°: layout 1 loses a motion and fights itself.
  EXPECT_EQ(check(with_end("table1-1", 0, "carriage", {{"axis", "y"}})).verdict,
            Verdict::overdriven);
  // Balls instead of cardans below one pair only take redundant constraints away.
  const MobilityReport balls = check(with_end("table1-1", 0, "platform", {{"joint", "spherical"}}));
  EXPECT_EQ(balls.verdict, Verdict::determinate);
  EXPECT_LT(balls.redundant_constraints, check("table1-1").redundant_constraints);
  // A cardan in place of layout 2's balls takes the freedoms that were left, but not at home.
  EXPECT_EQ(
      check(with_end("table1-2", 0, "platform", {{"joint", "universal"}, {"axis", "x"}})).verdict,
      Verdict::singular_home);
}

// --- Limits ---

TEST(Mobility, OfAnOpenChainIsTheSumOfItsFreedoms) {
  const auto document = nlohmann::json::parse(R"({
    "format": "polyglide/mechanism/1", "name": "arm", "base": "ground", "platform": "hand", "joints": [
      {"name": "a", "type": "revolute", "between": ["ground", "arm"], "at": [0,0,0], "axis": [0,0,1], "drive": true},
      {"name": "b", "type": "revolute", "between": ["arm", "hand"], "at": [100,0,0], "axis": [0,0,1], "drive": true}]})");
  const MobilityReport report = check(expand(parse_layout(document, "arm.json")));
  EXPECT_EQ(report.verdict, Verdict::determinate);
  EXPECT_EQ(report.finite, 2);
  EXPECT_EQ(report.kutzbach, 2);
}

TEST(Mobility, WithoutDrivesAMovingPlatformIsUncertain) {
  nlohmann::json document = find_layout("four-bar").document;
  for (auto& joint : document["joints"]) joint.erase("drive");
  EXPECT_EQ(check(expand(parse_layout(document, "four-bar"))).verdict, Verdict::uncertain);
}

TEST(Mobility, NamesTheRodsThatSpinIdly) {
  // A rod between two balls spins without moving anything.
  const MobilityReport report =
      check(with_end("table1-6", 1, "carriage", {{"joint", "spherical"}}));
  EXPECT_EQ(report.idle, 2);
  EXPECT_EQ(report.idle_rods.size(), 2u);
}

}  // namespace
}  // namespace polyglide
