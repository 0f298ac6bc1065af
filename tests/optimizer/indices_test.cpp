#include "optimizer/indices.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "catalog/catalog.hpp"
#include "optimizer/envelope.hpp"

namespace polyglide {
namespace {

Requirements cylinder(double diameter, double height) {
  Requirements requirements;
  requirements.zone.shape = Zone::Shape::cylinder;
  requirements.zone.size = {diameter, diameter, height};
  requirements.objectives = {{"workspace", 1}, {"conditioning", 1}};
  return requirements;
}

Machine delta() { return prepare(expand(find_layout("delta-1"))); }

TEST(Zone, ABoxIsSampledToItsCorners) {
  Zone zone;
  zone.size = {2, 4, 6};
  const auto positions = zone_positions(zone, Vector3::Zero(), 3, 2);
  ASSERT_EQ(positions.size(), 18u);
  EXPECT_EQ(positions.front(), Vector3(-1, -2, -3));
  EXPECT_EQ(positions.back(), Vector3(1, 2, 3));
}

TEST(Zone, ACylinderIsSampledToItsRimAndNotBeyond) {
  Zone zone;
  zone.shape = Zone::Shape::cylinder;
  zone.size = {2, 2, 1};
  int on_rim = 0;
  for (const Vector3& p : zone_positions(zone, Vector3::Zero(), 9, 3)) {
    const double radius = p.head<2>().norm();
    EXPECT_LE(radius, 1 + 1e-12);
    on_rim += radius > 1 - 1e-12 ? 1 : 0;
  }
  EXPECT_EQ(on_rim, 3 * 32);
  EXPECT_NEAR(volume(zone), std::numbers::pi, 1e-12);
}

TEST(Zone, ItsFirstEdgeIsAlongTheRotationAxis) {
  Zone zone;
  zone.size = {4, 2, 2};
  Eigen::AlignedBox3d box;
  for (const Vector3& p : zone_positions(zone, Vector3::UnitY(), 3, 3)) box.extend(p);
  EXPECT_NEAR(box.sizes().x(), 2, 1e-12);
  EXPECT_NEAR(box.sizes().y(), 4, 1e-12);
}

TEST(Zone, TiltsToBothSidesAboutTheMachinesAxis) {
  Zone zone;
  zone.tilt = 0.3;
  TaskSpace task;
  task.rotations = 1;
  task.rotation_axis = Vector3::UnitX();
  const auto turns = zone_turns(zone, task, 2);
  ASSERT_EQ(turns.size(), 5u);
  EXPECT_TRUE(turns[0].isApprox(Eigen::Quaterniond::Identity()));
  EXPECT_NEAR(Eigen::AngleAxisd(turns[4]).angle(), 0.3, 1e-12);
  zone.tilt = 0;
  EXPECT_EQ(zone_turns(zone, task, 2).size(), 1u);
}

// On the axis of a machine with three equal vertical guides, rods leaning by φ from the
// vertical give singular values √3 (up) and √(3/2)·tan φ (sideways).
TEST(Indices, ConditioningOnTheAxisOfADeltaIsTheClosedForm) {
  const Evaluator evaluator(delta());
  const Measures measures =
      measure(evaluator, cylinder(1e-6, 1e-6), Vector3::Zero(), kSearchFineness);
  const double offset = 368 / std::sqrt(3) - (120.88 + 140) / std::sqrt(3) + 70 * std::sqrt(3) / 2;
  const double tangent = offset / std::sqrt(256 * 256 - offset * offset);
  EXPECT_NEAR(measures.conditioning, tangent / std::numbers::sqrt2, 1e-6);
  EXPECT_NEAR(measures.worst_conditioning, tangent / std::numbers::sqrt2, 1e-6);
  EXPECT_EQ(measures.coverage, 1);
}

TEST(Indices, VolumeOfDelta1IsThePublishedOne) {
  const Evaluator evaluator(delta());
  const Measures fine = measure(evaluator, cylinder(0.01, 0.01), Vector3::Zero(), kFinalFineness);
  EXPECT_NEAR(fine.volume, 0.010007, 0.010007 * 0.01);
  const Measures coarse =
      measure(evaluator, cylinder(0.01, 0.01), Vector3::Zero(), kSearchFineness);
  EXPECT_NEAR(coarse.volume, 0.010007, 0.010007 * 0.05);
}

TEST(Indices, AZoneTooLargeIsCoveredInPartAndScoresBelowZero) {
  const Evaluator evaluator(delta());
  const Requirements requirements = cylinder(0.4, 0.3);
  const Measures measures = measure(evaluator, requirements, Vector3::Zero(), kSearchFineness);
  EXPECT_GT(measures.coverage, 0);
  EXPECT_LT(measures.coverage, 1);
  EXPECT_LT(score(measures, requirements.objectives), 0);
  EXPECT_GE(score(measures, requirements.objectives), -1);
}

TEST(Indices, AZoneOutOfReachHasCoverageZero) {
  const Evaluator evaluator(delta());
  const Measures measures =
      measure(evaluator, cylinder(0.01, 0.01), Vector3(5, 0, 0), kSearchFineness);
  EXPECT_EQ(measures.coverage, 0);
  EXPECT_EQ(measures.worst_conditioning, 0);
}

TEST(Indices, ABoundOnTheConditionLeavesLessUsableWorkspace) {
  const Evaluator evaluator(delta());
  Requirements requirements = cylinder(0.05, 0.05);
  const Vector3 middle(0, 0, 0.066);
  const double free = measure(evaluator, requirements, middle, kFinalFineness).volume;
  requirements.condition = 3;
  const double bound = measure(evaluator, requirements, middle, kFinalFineness).volume;
  EXPECT_GT(free, 0.0099);
  EXPECT_LT(bound, 0.95 * free);
}

TEST(Indices, TheScoreIsTheWeightedGeometricMean) {
  Measures measures;
  measures.coverage = measures.credit = 1;
  measures.workspace = 0.25;
  measures.conditioning = 0.5;
  EXPECT_NEAR(score(measures, {{"workspace", 1}, {"conditioning", 1}}), std::sqrt(0.125), 1e-12);
  EXPECT_NEAR(score(measures, {{"workspace", 2}, {"conditioning", 1}}), std::cbrt(0.03125), 1e-12);
  EXPECT_NEAR(score(measures, {{"conditioning", 7}}), 0.5, 1e-12);
}

TEST(Indices, EveryIndexHasAValueAndSaysWhatItIs) {
  const Measures measures;
  for (const Index& index : indices()) {
    EXPECT_NO_THROW((void)measures[index.key]);
    EXPECT_GT(index.about.size(), 20u) << index.key;
  }
  EXPECT_THROW((void)measures["beauty"], std::invalid_argument);
  EXPECT_EQ(indices_json().size(), indices().size());
}

TEST(Envelope, HoldsCarriagesAtBothEndsAndThePlatformInTheZone) {
  const Machine machine = delta();
  const std::vector<Eigen::Quaterniond> untilted{Eigen::Quaterniond::Identity()};
  const auto small = envelope(machine, {Vector3::Zero()}, untilted);
  EXPECT_NEAR(small.max().z(), 0.426, 1e-9);  // L - e
  EXPECT_LT(small.min().z(), 0.061);          // the platform hangs below L - n - e
  EXPECT_GT(small.sizes().x(), 0.368);
  const auto large = envelope(machine, {Vector3(0, 0, -1), Vector3(0, 0, 1)}, untilted);
  EXPECT_NEAR(large.min().z(), small.min().z() - 1, 1e-9);
}

TEST(Envelope, TheReachBoxHoldsEveryReachablePlace) {
  const Machine machine = delta();
  const auto box = reach_box(machine);
  const Evaluator evaluator(machine);
  PoseBatch batch;
  for (double x = -0.4; x <= 0.4; x += 0.05)
    for (double y = -0.4; y <= 0.4; y += 0.05)
      for (double z = -0.5; z <= 0.5; z += 0.05) {
        batch.x.push_back(x);
        batch.y.push_back(y);
        batch.z.push_back(z);
      }
  BatchResult result;
  evaluator.evaluate(batch, result);
  for (std::size_t i = 0; i < batch.size(); ++i)
    if (result.limit[i] < 0) {
      EXPECT_TRUE(box.contains(Vector3(batch.x[i], batch.y[i], batch.z[i])));
    }
}

}  // namespace
}  // namespace polyglide
