// What a check says beside its verdict: wrenches, redundant constraints, idle freedoms, motion.

#include "kinematics/evidence.hpp"

#include <gtest/gtest.h>

#include "cases.hpp"
#include "catalog/json_file.hpp"
#include "kinematics/manifold.hpp"
#include "kinematics/screw_words.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

int couples(const std::vector<Screw>& wrenches) {
  return static_cast<int>(std::ranges::count_if(
      wrenches, [](const Screw& wrench) { return wrench.head<3>().isZero(1e-9); }));
}

double pitch(const Screw& screw) {
  const Vector3 axis = screw.head<3>(), moment = screw.tail<3>();
  return axis.dot(moment) / axis.squaredNorm();
}

// Ni, Wang, Miao, Wang 2016: every PRP leg gives one force along z and two couples in the xy plane.
TEST(LimbWrenches, OfA3PrpAreAForceAndTwoCouples) {
  const MobilityReport report = check("3-prp");
  ASSERT_EQ(report.limbs.size(), 3u);
  for (const LimbWrenches& limb : report.limbs) {
    EXPECT_EQ(limb.connectivity, 3);
    ASSERT_EQ(limb.constraints.size(), 3u);
    EXPECT_EQ(couples(limb.constraints), 2);
    EXPECT_NEAR(std::abs(limb.constraints.back().head<3>().normalized().z()), 1, 1e-12);
    EXPECT_EQ(limb.actuations.size(), 1u);
  }
}

// Ibid.: every RPS leg gives one force through its ball, parallel to its hinge.
TEST(LimbWrenches, OfA3RpsAreForcesThroughTheBallsParallelToTheHinges) {
  const Mechanism mechanism = expand(find_layout("3-rps"));
  const MobilityReport report = check("3-rps");
  ASSERT_EQ(report.limbs.size(), 3u);
  for (const LimbWrenches& limb : report.limbs) {
    ASSERT_EQ(limb.constraints.size(), 1u);
    const Vector3 force = limb.constraints.front().head<3>();
    const Vector3 moment = limb.constraints.front().tail<3>();
    for (const Joint& joint : mechanism.joints) {
      if (std::ranges::find(limb.joints, joint.name) == limb.joints.end()) continue;
      if (joint.type == JointType::revolute) {
        EXPECT_NEAR(force.cross(joint.axes[0]).norm(), 0, 1e-9);
      }
      if (joint.type == JointType::spherical) {
        EXPECT_NEAR((moment - joint.at.cross(force)).norm(), 0, 1e-9);
      }
    }
  }
}

TEST(LimbWrenches, OfADrivenRodAreAForceAlongIt) {
  const Mechanism mechanism = expand(find_layout("table1-1"));
  for (const LimbWrenches& limb : check("table1-1").limbs) {
    ASSERT_EQ(limb.actuations.size(), 1u);
    std::vector<Vector3> ends;
    for (const Joint& joint : mechanism.joints)
      if (joint.type == JointType::universal &&
          std::ranges::find(limb.joints, joint.name) != limb.joints.end())
        ends.push_back(joint.at);
    ASSERT_EQ(ends.size(), 2u);
    const Vector3 rod = (ends[1] - ends[0]).normalized();
    EXPECT_NEAR(limb.actuations[0].head<3>().cross(rod).norm(), 0, 1e-9);
    EXPECT_NEAR(pitch(limb.actuations[0]), 0, 1e-9);
  }
}

TEST(LimbWrenches, OfAHybridBelongToItsStages) {
  const Mechanism mechanism = expand(find_layout("hybrid-3prp-3rps"));
  const auto limbs = limb_wrenches(mechanism);
  ASSERT_EQ(limbs.size(), 6u);
  EXPECT_EQ(limbs.front().from, mechanism.base);
  EXPECT_EQ(limbs.front().to, limbs.back().from);
  EXPECT_EQ(limbs.back().to, mechanism.platform);
}

TEST(LimbWrenches, AreReciprocalToWhatThePlatformDoes) {
  for (const std::string& name : catalog_names()) {
    const MobilityReport report = check(name);
    for (const LimbWrenches& limb : report.limbs) {
      if (limb.to != compile(expand(find_layout(name))).mechanism.platform || limb.from != 0)
        continue;
      for (const Screw& wrench : limb.constraints)
        for (const PlatformMotion& motion : report.platform_motions) {
          const double power = wrench.head<3>().dot(motion.twist.tail<3>()) +
                               wrench.tail<3>().dot(motion.twist.head<3>());
          EXPECT_NEAR(power, 0, 1e-6) << name << " " << limb.name << " " << motion.about;
        }
    }
  }
}

// Ibid., eq. (1): 3(8 − 9 − 1) + 9 = 3 and 6(8 − 9 − 1) + 15 = 3.
TEST(CountingTerms, AreThoseOfTheHybridPaper) {
  const CountingTerms planar = check("3-prp").counting, spatial = check("3-rps").counting;
  EXPECT_EQ(planar.order, 3);
  EXPECT_EQ(planar.virtual_constraints, 0);
  EXPECT_EQ(planar.mobility, 3);
  EXPECT_EQ(spatial.order, 6);
  EXPECT_EQ(spatial.virtual_constraints, 0);
  EXPECT_EQ(spatial.mobility, 3);
}

TEST(CountingTerms, AddUpForEveryMachine) {
  for (const std::string& name : catalog_names()) {
    const MobilityReport report = check(name);
    const CountingTerms& t = report.counting;
    EXPECT_EQ(t.mobility,
              t.order * (t.links - t.joints - 1) + t.freedoms + t.virtual_constraints - t.local)
        << name;
    EXPECT_EQ(t.mobility + t.local, report.finite) << name;
    EXPECT_EQ(static_cast<int>(report.redundant.size()), std::max(0, report.redundant_constraints))
        << name;
  }
}

TEST(RedundantConstraints, AreInnerWrenchesThatNoFreedomFeels) {
  const Model model = compile(expand(find_layout("table1-1")));
  const MobilityReport report = analyse_mobility(model);
  ASSERT_EQ(report.redundant.size(), 2u);
  const Eigen::MatrixXd screws = freedom_screws(model, home(model));
  for (const RedundantConstraint& constraint : report.redundant) {
    Eigen::VectorXd power = Eigen::VectorXd::Zero(screws.cols());
    for (const auto& loop : constraint.loops)
      for (std::size_t i = 0; i < model.loops.size(); ++i) {
        if (model.mechanism.joints[model.loop_joints[i]].name != loop.closed_by) continue;
        for (const auto [joint, sign] : model.loops[i])
          for (int f = model.first_freedom[joint];
               f < model.first_freedom[joint] + freedoms(model.mechanism.joints[joint].type); ++f)
            power[f] += sign * (loop.wrench.head<3>().dot(screws.col(f).tail<3>()) +
                                loop.wrench.tail<3>().dot(screws.col(f).head<3>()));
      }
    EXPECT_LT(power.cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(PlatformMotions, TakeBodiesAlongAndLeaveIdleOnesAtRest) {
  for (const std::string& name : catalog_names()) {
    const Model model = compile(expand(find_layout(name)));
    const MobilityReport report = analyse_mobility(model);
    EXPECT_EQ(static_cast<int>(report.platform_motions.size()), report.platform_home_dof) << name;
    for (const PlatformMotion& motion : report.platform_motions) {
      const auto platform =
          std::ranges::find(motion.bodies, model.mechanism.platform, &BodyMotion::body);
      ASSERT_NE(platform, motion.bodies.end()) << name << " " << motion.about;
      EXPECT_LT((platform->twist - motion.twist).norm(), 1e-9 * (1 + motion.twist.norm())) << name;
      EXPECT_NEAR(motion.bodies.front().speed, 1, 1e-9) << name;
    }
  }
}

/// A hexapod of telescopes between balls: every leg can spin about itself.
Mechanism hexapod_of_balls() {
  Mechanism mechanism = expand(find_layout("hexapod-6ups"));
  for (Joint& joint : mechanism.joints)
    if (joint.type == JointType::universal) {
      joint.type = JointType::spherical;
      joint.range.clear();
    }
  return mechanism;
}

TEST(IdleFreedoms, OfAHexapodOfBallsAreItsSixLegsAboutThemselves) {
  const Mechanism mechanism = hexapod_of_balls();
  const MobilityReport report = check(mechanism);
  EXPECT_EQ(report.platform_dof, 6);
  ASSERT_EQ(report.idle_freedoms.size(), 6u);
  for (const IdleFreedom& idle : report.idle_freedoms) {
    ASSERT_EQ(idle.bodies.size(), 2u) << idle.about;  // the halves of one telescope
    const ScrewLine line = line_of(idle.twist);
    EXPECT_EQ(line.kind, ScrewLine::Kind::line);
    for (const Joint& joint : mechanism.joints) {
      if (joint.type != JointType::spherical) continue;
      const auto ends = {mechanism.bodies[joint.bodies[0]], mechanism.bodies[joint.bodies[1]]};
      const bool mine = std::ranges::any_of(
          ends, [&](const std::string& body) { return std::ranges::count(idle.bodies, body) > 0; });
      if (mine) {
        EXPECT_LT((joint.at - line.point).cross(line.axis).norm(), 1e-9) << idle.about;
      }
    }
  }
}

TEST(LimbWrenches, OfLegsThatMeetBeforeThePlatformAreNamedAfterAllOfThem) {
  const auto limbs = check("h4").limbs;
  ASSERT_EQ(limbs.size(), 2u);
  EXPECT_EQ(limbs[0].name, "leg1–leg2–hinge1");
  EXPECT_EQ(limb_names({"a.x", "a.y"}), "a");
  EXPECT_EQ(limb_names({}), "");
}

TEST(IdleFreedoms, NameTheRodAndItsAxis) {
  nlohmann::json document = find_layout("table1-6").document;
  document["limbs"][1]["rods"]["carriage"]["joint"] = "spherical";
  const Mechanism mechanism = expand(parse_layout(document, "spinning"));
  const MobilityReport report = analyse_mobility(compile(mechanism));
  ASSERT_EQ(report.idle_freedoms.size(), 2u);
  for (const IdleFreedom& idle : report.idle_freedoms) {
    ASSERT_EQ(idle.bodies.size(), 1u);
    EXPECT_NE(idle.bodies[0].find("rod"), std::string::npos);
    EXPECT_NEAR(pitch(idle.twist), 0, 1e-9);
  }
  EXPECT_NE(report.idle_freedoms[0].bodies, report.idle_freedoms[1].bodies);
}

TEST(Motion, SaysWhetherRotationAxesStayParallel) {
  EXPECT_NE(check("table1-1").motion.find("Schoenflies motion"), std::string::npos);
  EXPECT_NE(check("delta-1").motion.find("never turns"), std::string::npos);
  EXPECT_NE(check("3-rps").motion.find("not Schoenflies"), std::string::npos);
  EXPECT_EQ(check("hexapod-6ups").motion, "all six freedoms");
}

TEST(Motion, OfA3RpsIsParasiticInXAndY) {
  std::string axes;
  for (const ParasiticMotion& motion : check("3-rps").parasitic) axes += "XYZABC"[motion.axis];
  EXPECT_EQ(axes, "XYC");  // C because poses count turns about z after those about x and y
}

TEST(Modes, ShowTheSelfMotionOfLayout4WithDrivesHeld) {
  const Model model = compile(expand(find_layout("table1-4")));
  const MobilityReport report = analyse_mobility(model);
  ASSERT_EQ(report.modes.size(), 1u);
  EXPECT_EQ(report.modes[0].bodies.front().body, model.mechanism.platform);
  for (const BodyMotion& motion : report.modes[0].bodies)
    EXPECT_EQ(model.mechanism.bodies[motion.body].find("carriage"), std::string::npos);
}

// --- Words ---

TEST(ScrewWords, NameRotationTranslationAndScrew) {
  Screw screw;
  screw << 0, 0, 2, 0, 0, 0;
  EXPECT_EQ(describe_twist(screw), "rotation about the axis along (0, 0, 1) through (0, 0, 0) mm");
  screw << 0, 0, 0, 0, -3, 0;
  EXPECT_EQ(describe_twist(screw), "translation along (0, 1, 0)");
  screw << 0, 0, 1, 0, 0, 0.01;
  EXPECT_EQ(describe_twist(screw),
            "screw motion of pitch 10 mm/rad about the axis along (0, 0, 1) through (0, 0, 0) mm");
  EXPECT_EQ(describe_twist(Screw::Zero()), "no motion");
}

TEST(ScrewWords, NameForceCoupleAndWrench) {
  Screw wrench;
  wrench << 1, 0, 0, 0, 0, -0.2;
  EXPECT_EQ(describe_wrench(wrench), "force along (1, 0, 0) through (0, 200, 0) mm");
  wrench << 0, 0, 0, 0, 0, 1;
  EXPECT_EQ(describe_wrench(wrench), "couple about (0, 0, 1)");
  EXPECT_EQ(describe_wrench(Screw::Zero()), "no wrench");
}

TEST(ScrewWords, GiveAxisPointAndPitch) {
  Screw screw;  // 5 mm a radian about the line along -z through x = 0.1, twice as fast
  screw << 0, 0, -2, 0, 0.2, -0.01;
  const ScrewLine line = line_of(screw);
  EXPECT_EQ(line.kind, ScrewLine::Kind::screw);
  EXPECT_EQ(line.axis, Vector3::UnitZ());
  EXPECT_TRUE(line.point.isApprox(Vector3(0.1, 0, 0)));
  EXPECT_NEAR(line.pitch, 0.005, 1e-15);
  EXPECT_EQ(line_of(Screw::Zero()).kind, ScrewLine::Kind::none);
}

TEST(PlainBasis, FindsTranslationsAlongBaseAxesAndPureRotations) {
  // Schoenflies motion about x, given by four mixed columns about a point off the origin.
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(6, 4);
  system(0, 0) = 1;
  system.block<3, 3>(3, 1).setIdentity();
  Eigen::Matrix4d mix;
  mix << 1, 2, 3, 4, 0, 1, 5, 2, 1, 0, 1, 3, 2, 2, 0, 1;
  const auto basis = plain_basis(system * mix, {0.1, 0.2, 0.3}, 0.5);
  ASSERT_EQ(basis.size(), 4u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::abs(basis[i][3 + i]), 1, 1e-9);
    EXPECT_NEAR(basis[i].norm(), 1, 1e-9);
  }
  EXPECT_NEAR(std::abs(basis[3][0]), 1, 1e-9);
  EXPECT_NEAR(pitch(basis[3]), 0, 1e-9);
}

TEST(PlainBasis, OfNothingIsEmpty) {
  EXPECT_TRUE(plain_basis(Eigen::MatrixXd(6, 0), Vector3::Zero(), 1).empty());
}

}  // namespace
}  // namespace polyglide
