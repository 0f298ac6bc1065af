#include "kinematics/legs.hpp"

#include <gtest/gtest.h>

#include <set>

#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

TEST(Legs, GuidesWithRodsAreRecognisedWithLengthSideAndStroke) {
  const auto legs = recognise_legs(compile(linear_delta(0.25, 1, 1.5, 0.3)));
  ASSERT_TRUE(legs);
  ASSERT_EQ(legs->legs.size(), 3u);
  EXPECT_EQ(legs->primary, (std::vector<int>{0, 1, 2}));
  for (const Leg& leg : legs->legs) {
    EXPECT_EQ(leg.kind, Leg::Kind::guide_rod);
    EXPECT_NEAR(leg.length, 1, 1e-12);
    EXPECT_EQ(leg.side, 1);  // carriage above the platform
    EXPECT_NEAR(leg.stroke.max - leg.stroke.min, 1.5, 1e-12);
  }
}

TEST(Legs, AGuideWhoseAxisPointsFromCarriageToBaseIsTurnedRound) {
  Mechanism mechanism = linear_delta(0.25, 1, 1.5, 0.3);
  std::swap(mechanism.joints[0].bodies[0], mechanism.joints[0].bodies[1]);
  const auto legs = recognise_legs(compile(mechanism));
  ASSERT_TRUE(legs);
  EXPECT_TRUE(legs->legs[0].direction.isApprox(-Vector3::UnitZ()));
  EXPECT_EQ(legs->legs[0].side, -1);
}

TEST(Legs, BothRodsOfAParallelogramShareTheirDrive) {
  const auto legs = recognise_legs(compile(expand(find_layout("delta-1"))));
  ASSERT_TRUE(legs);
  EXPECT_EQ(legs->legs.size(), 6u);
  EXPECT_EQ(legs->primary.size(), 3u);
  std::multiset<int> drives;
  for (const Leg& leg : legs->legs) drives.insert(leg.drive);
  for (int drive = 0; drive < 3; ++drive) EXPECT_EQ(drives.count(drive), 2u);
}

TEST(Legs, StrutsOfAHexapodAreRecognised) {
  const auto legs = recognise_legs(compile(expand(find_layout("hexapod-6ups"))));
  ASSERT_TRUE(legs);
  EXPECT_EQ(legs->primary.size(), 6u);
  for (const Leg& leg : legs->legs) EXPECT_EQ(leg.kind, Leg::Kind::strut);
}

TEST(Legs, MachinesWithOtherLimbsAreGeneral) {
  for (const char* name : {"3-rps", "3-prp", "hybrid-3prp-3rps", "four-bar", "bennett", "sarrus"})
    EXPECT_FALSE(recognise_legs(compile(expand(find_layout(name))))) << name;
}

TEST(Legs, ARangeOnAPassiveJointMakesTheMachineGeneral) {
  Mechanism mechanism = orthoglide(1);
  mechanism.joints[1].type = JointType::universal;
  mechanism.joints[1].axes = {Vector3::UnitY(), Vector3::UnitZ()};
  EXPECT_TRUE(recognise_legs(compile(mechanism)));
  mechanism.joints[1].range = {{-0.5, 0.5}, {-0.5, 0.5}};
  EXPECT_FALSE(recognise_legs(compile(mechanism)));
}

TEST(Legs, ALimbWithoutDriveMakesTheMachineGeneral) {
  Mechanism mechanism = orthoglide(1);
  mechanism.joints[0].driven.clear();
  EXPECT_FALSE(recognise_legs(compile(mechanism)));
}

TEST(Legs, AHalfSpaceLimitOnARodMakesTheMachineGeneralOnACarriageNot) {
  Mechanism mechanism = orthoglide(1);
  const std::vector<HalfSpaceLimit::Plane> plane{{Vector3::UnitX(), 2}};
  mechanism.limits = {{"column", 2, {Vector3::UnitX()}, plane}};  // body 2: leg1.carriage
  EXPECT_TRUE(recognise_legs(compile(mechanism)));
  mechanism.limits[0].body = 3;  // leg1.rod
  EXPECT_FALSE(recognise_legs(compile(mechanism)));
}

TEST(Legs, AStrutThatDoesNotSlideAlongItsLineIsGeneral) {
  Mechanism mechanism = strutted({{{0, 0, 0}, {0, 0, 1}}});
  EXPECT_TRUE(recognise_legs(compile(mechanism)));
  mechanism.joints[1].axes[0] = Vector3(0.1, 0, 1).normalized();
  EXPECT_FALSE(recognise_legs(compile(mechanism)));
}

}  // namespace
}  // namespace polyglide
