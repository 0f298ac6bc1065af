#include "kinematics/mobility.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "cases.hpp"
#include "catalog/json_file.hpp"
#include "kinematics/manifold.hpp"
#include "kinematics/motion.hpp"
#include "machines.hpp"

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

// --- Freedoms that are instantaneous everywhere and continue nowhere ---
//
// On equal parallel rods a table keeps parallel: |R aᵢ + t - aᵢ| = |t₀| for four points or more
// that are generic leaves R = 1, |t| = |t₀|. But its rods push along one direction only, so that at
// every posture it can also begin to turn about that direction.

TEST(Mobility, OfATableOnEqualParallelRodsIsTranslation) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> part(-1, 1);
  for (int count : {4, 5, 6})
    for (const double height : {0.0, 0.5}) {
      SCOPED_TRACE(fmt::format("{} rods, points within {} m of a plane", count, height));
      std::vector<Vector3> points;
      for (int i = 0; i < count; ++i) {
        const double angle = 2 * M_PI * (i + 0.3 * part(random)) / count;
        const double radius = 1 + 0.3 * part(random);
        points.push_back(
            {radius * std::cos(angle), radius * std::sin(angle), height * part(random)});
      }
      for (const Vector3& rod : {Vector3(0, 0, 1), Vector3(0.3, -0.2, 1)}) {
        const MobilityReport report = check(table_on_rods(points, rod));
        EXPECT_EQ(report.verdict, Verdict::uncertain);
        EXPECT_EQ(report.home, count + 3);
        EXPECT_EQ(report.finite, count + 2);
        EXPECT_EQ(report.idle, count);
        EXPECT_EQ(report.pattern, "2T0R");
        EXPECT_EQ(report.redundant_constraints, count - 3);
      }
    }
}

TEST(Mobility, OfAHingeInTwoBearingsDrawnToNineDigitsIsARotation) {
  // The second bearing, a metre along the axis, repeats all that the first demands.
  const Vector3 axis(0.379153124, 0.925312468, 0.00630439914);
  for (const double noise : {0.0, 5e-10}) {
    Mechanism mechanism;
    mechanism.bodies = {"base", "door"};
    mechanism.platform = 1;
    mechanism.joints = {joint_of("first", JointType::revolute, 0, 1, {0, 0, 0}, axis.normalized()),
                        joint_of("second", JointType::revolute, 0, 1,
                                 axis + Vector3(noise, 0, -noise), axis.normalized())};
    mechanism.joints[0].driven = {0};
    const MobilityReport report = check(mechanism);
    EXPECT_EQ(report.verdict, Verdict::determinate) << noise;
    EXPECT_EQ(report.finite, 1) << noise;
    EXPECT_EQ(report.pattern, "0T1R") << noise;
    EXPECT_EQ(report.redundant_constraints, 5) << noise;
  }
}

TEST(Mobility, OfATableOnFourUprightRodsOnARectangleIsTranslation) {
  // (R₁₂ + R₂₁) = 4 q₁ q₂ = 0 and (Rᵀt - t) ⟂ z: branches R = 1, q₁ = 0 and q₂ = 0, two freedoms
  // each.
  const MobilityReport report =
      check(table_on_rods({{1, 0.6, 1}, {-1, 0.6, 1}, {-1, -0.6, 1}, {1, -0.6, 1}}, {0, 0, 1}));
  EXPECT_EQ(report.verdict, Verdict::uncertain);
  EXPECT_EQ(report.home, 7);
  EXPECT_EQ(report.finite, 6);
  EXPECT_EQ(report.pattern, "2T0R");
  EXPECT_TRUE(report.motions_meet);
}

TEST(Polish, TakesAPostureToTheDoubleZeroNewtonCreepsUpOn) {
  const Vector3 rod(0.3, -0.2, 1);
  const Model model =
      compile(table_on_rods({{1, 0.1, 1}, {0.5, 0.9, 1}, {-0.6, 0.7, 1}, {-1.1, 0, 1}}, rod));
  Posture posture = home(model);
  // Turned about the rods' direction by 0.001 rad the loops close to 1e-6 only.
  const Freedoms free = freedoms_at(model, posture);
  const Kernel still = kernel_of(free.platform.bottomRows(3), 1);
  const Eigen::VectorXd turning = free.kernel * still.basis.col(0);
  advance(model, posture,
          (1e-3 * turning / turning.cwiseAbs().maxCoeff()).cwiseProduct(freedom_scale(model)));
  const std::vector<int> active = all_freedoms(model);
  Posture crept = posture;
  const Projection projection = project(model, crept, active);
  EXPECT_TRUE(projection.closed);
  EXPECT_TRUE(projection.linear);
  const auto turned = [&] {
    return Eigen::AngleAxisd(home(model).bodies[1].linear().transpose() * crept.bodies[1].linear())
        .angle();
  };
  EXPECT_GT(turned(), 1e-6);
  EXPECT_LT(polish(model, crept, active), 1e-15);
  EXPECT_LT(turned(), 1e-7);
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
