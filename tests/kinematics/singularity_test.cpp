#include "kinematics/singularity.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "catalog/catalog.hpp"
#include "catalog/json_file.hpp"
#include "kinematics/mobility.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

Singularity at_home(const Mechanism& mechanism) {
  const Machine machine = prepare(mechanism);
  const int mobility = analyse_mobility(machine.model, screening_options(1)).finite;
  return singularity_at(machine, home(machine.model), mobility);
}

Pose turned(double angle) {
  Pose pose;
  pose.rotation = Eigen::AngleAxisd(angle, Vector3::UnitZ());
  return pose;
}

Pose moved(const Vector3& way) {
  Pose pose;
  pose.position = way;
  return pose;
}

// Fichter 1986: a symmetric hexapod turned by 90 degrees about its axis is singular.
TEST(Singularity, OfASymmetricHexapodTurnedBy90DegreesIsDirect) {
  const Machine machine = prepare(expand(find_layout("hexapod-6ups")));
  const PathSingularities path =
      singularities_on_path(machine, Pose(), turned(2 * std::numbers::pi / 3));
  ASSERT_EQ(path.crossings.size(), 1u);
  EXPECT_TRUE(path.reached);
  EXPECT_NEAR(path.crossings[0].at, 0.75, 1e-6);
  EXPECT_TRUE(path.crossings[0].singularity.direct);
  EXPECT_FALSE(path.crossings[0].singularity.inverse);
  ASSERT_EQ(path.crossings[0].singularity.gained.size(), 1u);
  const Screw twist = path.crossings[0].singularity.gained[0].screw;
  EXPECT_NEAR(std::abs(twist[2]) / twist.head<3>().norm(), 1, 1e-5);  // a screw about its axis
}

// A rod of length L on a guide ends its reach where it stands square to the guide.
TEST(Singularity, AtTheEndOfARodsReachIsInverse) {
  const Machine machine = prepare(fixtures::linear_delta(0.25, 1, 1.5, 0.3));
  const PathSingularities path = singularities_on_path(machine, Pose(), moved({0, 2, 0}));
  EXPECT_FALSE(path.reached);
  EXPECT_TRUE(path.at_end.inverse);
  EXPECT_TRUE(path.crossings.empty());
  const double reach = path.end * 2;  // the guides at the far side: e·sin 30° + y = sqrt(L² − …)
  EXPECT_NEAR(std::hypot(0.25 * std::cos(std::numbers::pi / 6), reach + 0.125), 1, 1e-5);
  EXPECT_FALSE(path.at_end.lost.empty());
}

TEST(Singularity, OfAFlatParallelogramIsAConstraintSingularity) {
  const auto path = std::filesystem::path(POLYGLIDE_SOURCE_DIR) /
                    "tests/truth/mobility/mechanisms/parallelogram_4R_flattened.json";
  const Singularity found = at_home(expand(load_layout(path)));
  EXPECT_TRUE(found.constraint);
  EXPECT_NE(singularity_name(found).find("constraint"), std::string::npos);
}

TEST(Singularity, OfLayout4IsDirectAndTurnsAboutTheVertical) {
  const Singularity found = at_home(expand(find_layout("table1-4")));
  EXPECT_TRUE(found.direct);
  ASSERT_EQ(found.gained.size(), 1u);
  EXPECT_NEAR(std::abs(found.gained[0].screw[2]), 1, 1e-6);
}

TEST(Singularity, OfADeterminateMachineAtHomeIsNone) {
  for (const std::string name : {"delta-1", "table1-1", "table1-6", "hexapod-6ups", "3-rps"}) {
    const Singularity found = at_home(expand(find_layout(name)));
    EXPECT_TRUE(found.regular()) << name << " " << singularity_name(found);
    EXPECT_GT(found.direct_margin, 1e-3);
    EXPECT_GT(found.inverse_margin, 1e-3);
    EXPECT_TRUE(found.gained.empty() && found.lost.empty());
  }
}

TEST(Singularity, MarginsAgreeWithTheVerdictForEveryCatalogEntry) {
  for (const std::string& name : catalog_names()) {
    const Mechanism mechanism = expand(find_layout(name));
    const MobilityReport report = analyse_mobility(compile(mechanism), screening_options(1));
    if (report.verdict == Verdict::rigid) continue;
    const Singularity found = at_home(mechanism);
    EXPECT_EQ(found.direct, report.home_locked_platform > 0) << name;
    EXPECT_EQ(found.constraint, report.home > report.finite) << name;
    EXPECT_EQ(found.gained.size(), static_cast<std::size_t>(report.home_locked_platform)) << name;
  }
}

TEST(NearestSingularity, OfASymmetricHexapodIsNoFartherThanItsQuarterTurn) {
  const Machine machine = prepare(expand(find_layout("hexapod-6ups")));
  const NearestSingularity nearest = nearest_singularity(machine, Pose(), 1.0, 24);
  ASSERT_TRUE(nearest.found);
  EXPECT_LE(nearest.distance, machine.task.characteristic_length * std::numbers::pi / 2 + 1e-6);
  EXPECT_TRUE(nearest.singularity.direct || nearest.singularity.inverse);
}

TEST(NearestSingularity, SaysWhenNoneLiesWithinTheRadius) {
  const Machine machine = prepare(expand(find_layout("delta-1")));
  EXPECT_FALSE(nearest_singularity(machine, Pose(), 0.01, 8).found);
}

TEST(PathSingularities, OfAWayThatCannotBeginIsEmpty) {
  const Machine machine = prepare(expand(find_layout("delta-1")));
  const PathSingularities path = singularities_on_path(machine, moved({5, 0, 0}), moved({6, 0, 0}));
  EXPECT_FALSE(path.reached);
  EXPECT_EQ(path.end, 0);
}

}  // namespace
}  // namespace polyglide
