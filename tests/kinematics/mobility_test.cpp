#include "kinematics/mobility.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "catalog/catalog.hpp"
#include "catalog/json_file.hpp"

namespace polyglide {
namespace {

MobilityReport check(const Mechanism& mechanism) { return analyse_mobility(compile(mechanism)); }
MobilityReport check(const std::string& name) { return check(expand(find_layout(name))); }

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

// --- Laws for every catalog entry ---

Mechanism moved(Mechanism mechanism, const Eigen::Isometry3d& motion, double scale) {
  const auto point = [&](Vector3& p) { p = motion * (scale * p); };
  const auto direction = [&](Vector3& d) { d = motion.linear() * d; };
  point(mechanism.tool);
  for (Joint& joint : mechanism.joints) {
    point(joint.at);
    for (Vector3& axis : joint.axes) direction(axis);
    joint.pitch *= scale;
  }
  return mechanism;
}

/// The same mechanism with joints and bodies in another order and every joint's
/// two bodies swapped (a universal's axes with them).
Mechanism renumbered(const Mechanism& mechanism, std::mt19937_64& random) {
  Mechanism other = mechanism;
  std::shuffle(other.joints.begin(), other.joints.end(), random);
  std::vector<int> place(mechanism.bodies.size());
  std::iota(place.begin(), place.end(), 0);
  std::shuffle(place.begin(), place.end(), random);
  for (std::size_t i = 0; i < place.size(); ++i) other.bodies[place[i]] = mechanism.bodies[i];
  other.base = place[mechanism.base];
  other.platform = place[mechanism.platform];
  for (Joint& joint : other.joints) {
    joint.bodies = {place[joint.bodies[1]], place[joint.bodies[0]]};
    if (joint.type == JointType::universal) std::swap(joint.axes[0], joint.axes[1]);
  }
  return other;
}

void expect_same_verdict(const MobilityReport& a, const MobilityReport& b) {
  EXPECT_EQ(a.verdict, b.verdict);
  EXPECT_EQ(a.home, b.home);
  EXPECT_EQ(a.finite, b.finite);
  EXPECT_EQ(a.redundant_constraints, b.redundant_constraints);
  EXPECT_EQ(a.pattern, b.pattern);
  EXPECT_EQ(a.locked_platform, b.locked_platform);
  EXPECT_EQ(a.home_locked_platform, b.home_locked_platform);
  EXPECT_EQ(a.surplus, b.surplus);
}

class CatalogVerdict : public testing::TestWithParam<std::string> {};

TEST_P(CatalogVerdict, DoesNotDependOnUnitFrameOrOrder) {
  const Mechanism mechanism = expand(find_layout(GetParam()));
  const MobilityReport reference = check(mechanism);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  for (double scale : {1e-3, 1.0, 1e3}) {
    SCOPED_TRACE(testing::Message() << "scale " << scale);
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.linear() =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
            .normalized()
            .toRotationMatrix();
    motion.translation() = scale * Vector3(normal(random), normal(random), normal(random));
    expect_same_verdict(reference, check(moved(renumbered(mechanism, random), motion, scale)));
  }
}

TEST_P(CatalogVerdict, DoesNotDependOnTheSeed) {
  const Model model = compile(expand(find_layout(GetParam())));
  const MobilityReport reference = analyse_mobility(model);
  for (std::uint64_t seed = 2; seed < 5; ++seed)
    expect_same_verdict(reference, analyse_mobility(model, {.seed = seed}));
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Catalog, CatalogVerdict, testing::ValuesIn(catalog_names()), test_name);

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
