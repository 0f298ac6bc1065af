#include "kinematics/orientation_workspace.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "kinematics/region.hpp"
#include "kinematics/workspace.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;
using std::numbers::pi;

Eigen::Quaterniond random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized();
}

void add(PoseBatch& poses, const Vector3& at, const Eigen::Quaterniond& q) {
  poses.x.push_back(at.x());
  poses.y.push_back(at.y());
  poses.z.push_back(at.z());
  const std::array<double, 4> parts{q.w(), q.x(), q.y(), q.z()};
  for (std::size_t k = 0; k < 4; ++k) poses.quaternion[k].push_back(parts[k]);
}

/// A platform on a ball at the origin, held by telescopes from base points to platform points.
Machine wrist(const std::vector<std::pair<Vector3, Vector3>>& legs, const Range& stroke) {
  Mechanism mechanism = strutted(legs, stroke);
  mechanism.joints.push_back(joint_of("ball", JointType::spherical, 0, 1, Vector3::Zero()));
  return prepare(mechanism, task_of({3, 4, 5}));
}

TEST(OrientationWorkspace, OfAHexapodIsWhatRandomRotationsSay) {
  const Machine machine = catalog_machine("hexapod-6ups");
  OrientationOptions options;
  options.at = Vector3(0.05, -0.03, 0.02);
  const OrientationWorkspace dut = orientation_workspace(machine, options);
  ASSERT_TRUE(dut.reachable);
  const Evaluator evaluator(machine);
  const Probe probe(evaluator, Eigen::Quaterniond::Identity());
  std::mt19937_64 random(7);
  constexpr int kSamples = 400000;
  PoseBatch poses;
  for (int i = 0; i < kSamples; ++i) add(poses, options.at, random_rotation(random));
  const auto answers = probe.ask(poses, false);
  const auto hits = std::count(answers.limit.begin(), answers.limit.end(), -1);
  const double share = static_cast<double>(hits) / kSamples;
  EXPECT_NEAR(dut.share, share, 4 * std::sqrt(share / kSamples));
  EXPECT_LT(dut.share_error, 0.01 * dut.share);
}

TEST(OrientationWorkspace, EveryTiltEndsWhereItSays) {
  const Machine machine = catalog_machine("hexapod-6ups");
  const OrientationWorkspace dut = orientation_workspace(machine);
  const Evaluator evaluator(machine);
  const Probe probe(evaluator, Eigen::Quaterniond::Identity());
  ASSERT_FALSE(dut.directions.empty());
  for (const TiltDirection& direction : dut.directions) {
    PoseBatch poses;
    for (double by : {-1e-5, 1e-5})
      add(poses, Vector3::Zero(),
          turned(machine.task, direction.azimuth, direction.end.angle + by));
    const auto answers = probe.ask(poses, false);
    EXPECT_TRUE(answers.inside(0));
    ASSERT_FALSE(answers.inside(1));
    EXPECT_EQ(probe.names()[answers.limit[1]], direction.end.limit);
    EXPECT_GE(direction.any_torsion, direction.end.angle - 1e-5);
    EXPECT_GE(direction.end.angle, dut.worst.end.angle);
  }
}

// A telescope between points that lie at angle δ on circles of radii r and R about the axis, z
// apart: length² = r² + R² + z² − 2 r R cos(δ + torsion).
TEST(OrientationWorkspace, TorsionOfAWristEndsByTheLawOfCosines) {
  constexpr double kInner = 0.1, kOuter = 0.2, kHeight = 0.15, kLag = 0.6, kStroke = 0.012;
  std::vector<std::pair<Vector3, Vector3>> legs;
  for (int leg = 0; leg < 3; ++leg) {
    const double at = 2 * pi * leg / 3;
    legs.emplace_back(Vector3(kOuter * std::cos(at), kOuter * std::sin(at), -kHeight),
                      Vector3(kInner * std::cos(at + kLag), kInner * std::sin(at + kLag), 0));
  }
  const OrientationWorkspace dut = orientation_workspace(wrist(legs, {-kStroke, kStroke}));
  ASSERT_TRUE(dut.reachable);
  const double squares = kInner * kInner + kOuter * kOuter + kHeight * kHeight;
  const auto length = [&](double angle) {
    return std::sqrt(squares - 2 * kInner * kOuter * std::cos(angle));
  };
  const auto angle_of = [&](double l) {
    return std::acos((squares - l * l) / (2 * kInner * kOuter));
  };
  EXPECT_NEAR(dut.most.angle, angle_of(length(kLag) + kStroke) - kLag, 1e-5);
  EXPECT_NEAR(dut.least.angle, angle_of(length(kLag) - kStroke) - kLag, 1e-5);
  EXPECT_TRUE(dut.most.limit.starts_with("stroke")) << dut.most.limit;
}

TEST(OrientationWorkspace, OfAMachineWithOneRotationIsAnInterval) {
  const Machine machine = catalog_machine("table1-6");
  const OrientationWorkspace dut = orientation_workspace(machine);
  EXPECT_NEAR(dut.least.angle, -dut.most.angle, 1e-5);  // a symmetric machine
  EXPECT_NEAR(dut.share, (dut.most.angle - dut.least.angle) / (2 * pi), 1e-12);
  EXPECT_TRUE(dut.directions.empty());
}

TEST(OrientationWorkspace, BeyondReachIsNotReachable) {
  OrientationOptions options;
  options.at = Vector3(0, 0, 50);
  const OrientationWorkspace dut = orientation_workspace(catalog_machine("hexapod-6ups"), options);
  EXPECT_FALSE(dut.reachable);
  EXPECT_FALSE(dut.limit.empty());
  EXPECT_EQ(dut.share, 0);
}

TEST(OrientationWorkspace, NeedsARotationAndAPlace) {
  EXPECT_THROW(orientation_workspace(catalog_machine("delta-1")), std::invalid_argument);
  OrientationOptions options;
  options.at.x() = std::nan("");
  EXPECT_THROW(orientation_workspace(catalog_machine("hexapod-6ups"), options),
               std::invalid_argument);
}

TEST(OrientationSet, TiltsTheVerticalTowardsTheAzimuth) {
  for (const TaskSpace& task : {task_of({0, 1, 2, 3, 4, 5}), task_of({2, 3, 4})})
    for (double azimuth : {0.0, 1.0, 2.5, 4.0, 6.0})
      for (double tilt : {0.0, 0.4, 1.5}) {
        const Vector3 up = turned(task, azimuth, tilt) * Vector3::UnitZ();
        const Vector3 expected(std::sin(tilt) * std::cos(azimuth),
                               std::sin(tilt) * std::sin(azimuth), std::cos(tilt));
        EXPECT_LT((up - expected).norm(), 1e-12);
      }
}

Workspace total(const Machine& machine, const OrientationSet& set, double accuracy = 5e-3) {
  WorkspaceOptions options;
  options.orientations = set;
  options.accuracy = accuracy;
  options.volume_only = true;
  return compute_workspace(machine, options);
}

TEST(TotalOrientation, OfNoTiltIsTheWorkspaceAndOfMoreTiltIsLess) {
  const Machine machine = catalog_machine("hexapod-6ups");
  WorkspaceOptions plain;
  plain.volume_only = true;
  const double all = compute_workspace(machine, plain).volume;
  const Workspace none = total(machine, {0, 0});
  EXPECT_NEAR(none.volume, all, 0.01 * all);
  EXPECT_EQ(none.orientations->count, 1u);
  double before = all;
  for (double degrees : {10.0, 20.0, 30.0}) {
    const Workspace dut = total(machine, {degrees * pi / 180, 0});
    EXPECT_LT(dut.volume, before);
    EXPECT_GE(dut.orientations->change, 0);
    EXPECT_LT(dut.orientations->change, 0.1);
    EXPECT_FALSE(dut.certified);
    before = dut.volume;
  }
}

TEST(TotalOrientation, IsWhatRandomPlacesAndOrientationsSay) {
  const Machine machine = catalog_machine("hexapod-6ups");
  const OrientationSet set{20 * pi / 180, 10 * pi / 180};
  const Workspace dut = total(machine, set);
  const Evaluator evaluator(machine);
  const Probe probe(evaluator, Eigen::Quaterniond::Identity());
  const Vector3 margin = 0.05 * (dut.upper - dut.lower), low = dut.lower - margin,
                size = dut.upper - dut.lower + 2 * margin;
  Uniform random;
  constexpr int kPlaces = 4000, kOrientations = 400;
  int inside = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const Vector3 at = low + size.cwiseProduct((random.vector() + Vector3::Ones()).eval() / 2);
    PoseBatch poses;
    for (int k = 0; k < kOrientations; ++k) {
      // Half of them on the rim of the set, where most is stopped.
      const double tilt = k % 2 == 0 ? 1 : std::sqrt(std::abs(random()));
      const double torsion = k % 4 < 2 ? random() : k % 8 < 4 ? -1 : 1;
      add(poses, at, turned(machine.task, pi * random(), set.tilt * tilt, set.torsion * torsion));
    }
    const auto answers = probe.ask(poses, false);
    inside += std::all_of(answers.limit.begin(), answers.limit.end(),
                          [](int limit) { return limit < 0; });
  }
  const double share = static_cast<double>(inside) / kPlaces, brute = share * size.prod();
  // Either samples miss some of the set: random ones claim a little more.
  EXPECT_LT(dut.volume, brute * (1 + 4 * std::sqrt((1 - share) / inside)));
  EXPECT_GT(dut.volume, brute * (0.98 - 4 * std::sqrt((1 - share) / inside)));
}

TEST(TotalOrientation, RefusesSetsThatCannotBe) {
  const Machine machine = catalog_machine("hexapod-6ups");
  EXPECT_THROW(total(machine, {-1, 0}), std::invalid_argument);
  EXPECT_THROW(total(machine, {std::nan(""), 0}), std::invalid_argument);
  EXPECT_THROW(total(machine, {0.1, 7}), std::invalid_argument);
}

}  // namespace
}  // namespace polyglide
