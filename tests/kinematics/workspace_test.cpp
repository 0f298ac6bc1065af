#include "kinematics/workspace.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

Workspace volume_of(const Machine& machine, const std::vector<std::string>& ignored = {},
                    double accuracy = 5e-4) {
  WorkspaceOptions options;
  options.ignored = ignored;
  options.accuracy = accuracy;
  options.volume_only = true;
  return compute_workspace(machine, options);
}

TEST(Workspace, DeltaOneHasThePublishedGeometryAndOurVolume) {
  const Machine machine = catalog_machine("delta-1");
  EXPECT_NEAR(volume_of(machine).volume, 10.007e-3, 0.002 * 10.007e-3);
  EXPECT_NEAR(volume_of(machine, {"triangle"}).volume, 12.010e-3, 0.002 * 12.010e-3);
}

TEST(Workspace, DeltaOneTravelsTwoHundredMillimetresOnItsAxis) {
  const Evaluator evaluator(catalog_machine("delta-1"));
  const auto reachable = [&](double z) {
    Eigen::VectorXd drives;
    return evaluator.inverse({Vector3(0, 0, z)}, drives) < 0;
  };
  const auto end = [&](double way) {
    double free = 0, stopped = way;
    for (int i = 0; i < 50; ++i)
      (reachable((free + stopped) / 2) ? free : stopped) = (free + stopped) / 2;
    return free;
  };
  EXPECT_NEAR(end(1) - end(-1), 0.2012, 5e-5);
}

TEST(Workspace, ALinearDeltaHasTheVolumeOfItsClosedForm) {
  const auto expected = truth()["linear_delta_vertical_e0.25_L1.0_H1.5"]["value"].get<double>();
  const Machine machine = prepare(linear_delta(0.25, 1, 1.5, 0), task_of({0, 1, 2}));
  const Workspace workspace = volume_of(machine);
  EXPECT_NEAR(workspace.volume, expected, 1e-3 * expected);
  EXPECT_LT(workspace.volume_lower, expected);
  EXPECT_GT(workspace.volume_upper, expected);
}

/// Telescopes from `feet` to one point, home at `home`, each at most of length 1; three of them
/// are singular in the plane of their feet, which halves what is symmetric about it.
Machine telescopes(const std::vector<Vector3>& feet, const Vector3& home) {
  std::vector<std::pair<Vector3, Vector3>> limbs;
  for (const Vector3& foot : feet) limbs.emplace_back(foot, home);
  Mechanism mechanism = strutted(limbs);
  std::size_t leg = 0;
  for (Joint& joint : mechanism.joints)
    if (joint.type == JointType::prismatic)
      joint.range = {{-0.99, 1 - (home - feet[leg++]).norm()}};
  return prepare(mechanism, task_of({0, 1, 2}));
}

TEST(Workspace, ProvedBoundsHoldHalfOfWhatThreeSpheresShare) {
  const auto expected = truth()["three_unit_spheres_distance1"]["value"].get<double>() / 2;
  const double height = std::sqrt(3) / 2;
  WorkspaceOptions options;
  options.ignored = {"stroke leg1.strut min", "stroke leg2.strut min", "stroke leg3.strut min"};
  const Workspace dut = compute_workspace(
      telescopes({{-0.5, 0, 0}, {0.5, 0, 0}, {0, height, 0}}, {0, height / 3, 0.3}), options);
  EXPECT_TRUE(dut.certified);
  EXPECT_LE(dut.volume_lower, expected);
  EXPECT_GE(dut.volume_upper, expected);
  EXPECT_LT(dut.volume_upper - dut.volume_lower, 1.5e-3 * expected);
  EXPECT_NEAR(dut.volume, expected, 1e-3 * expected);
  EXPECT_GT(dut.limits_hit.at("singularity"), 0.1);
}

TEST(Workspace, APrismHasItsVolumeWhateverTheGrid) {
  const Machine machine = block();
  const Workspace workspace = volume_of(machine);
  EXPECT_NEAR(workspace.volume, 0.4 * 0.4 * 0.2, 1e-3 * 0.032);
  EXPECT_TRUE(workspace.lower.isApprox(Vector3(-0.1, -0.2, -0.05), 1e-3));
  EXPECT_TRUE(workspace.upper.isApprox(Vector3(0.3, 0.2, 0.15), 1e-3));
  EXPECT_NEAR(workspace.limits_hit.at("prism"), 1, 1e-9);
}

TEST(Workspace, SharesOfTheBoundaryAddUpAndAreasAddUpToTheVolume) {
  const Workspace workspace = volume_of(catalog_machine("tripod-70"));
  double shares = 0, sum = 0;
  for (const auto& [limit, share] : workspace.limits_hit) shares += share;
  EXPECT_NEAR(shares, 1, 1e-9);
  ASSERT_GT(workspace.area_by_z.size(), 1u);
  const double thickness = workspace.area_by_z[1].first - workspace.area_by_z[0].first;
  for (const auto& [z, area] : workspace.area_by_z) sum += area * thickness;
  EXPECT_NEAR(sum, workspace.volume, 1e-6 * workspace.volume);
}

TEST(Workspace, LimitsOnlyTakeAwayAndLongerStrokesOnlyAdd) {
  double before = 0;
  for (double height : {0.9, 1.1, 1.3, 1.5}) {
    const double volume =
        volume_of(prepare(linear_delta(0.25, 1, height, -0.4), task_of({0, 1, 2})), {}, 5e-3)
            .volume;
    EXPECT_GT(volume, before);
    before = volume;
  }
  const Machine machine = catalog_machine("delta-1");
  const double all = volume_of(machine, {}, 5e-3).volume;
  for (const char* limit : {"triangle", "stroke", "table"})
    EXPECT_GT(volume_of(machine, {limit}, 5e-3).volume, all) << limit;
}

TEST(Workspace, ASmallWorkspaceInAWideSearchBoxIsFound) {
  const double stroke = 0.004;
  const Workspace workspace =
      volume_of(prepare(orthoglide(1, {-stroke / 2, stroke / 2}), task_of({0, 1, 2})));
  EXPECT_NEAR(workspace.volume, std::pow(stroke, 3), 0.01 * std::pow(stroke, 3));
}

TEST(Workspace, HomeSideOfASingularSurfaceIsKept) {
  // The Orthoglide is singular at x = y = z = L/sqrt(6), well inside its reach.
  const Workspace workspace = volume_of(prepare(orthoglide(1), task_of({0, 1, 2})), {}, 2e-3);
  EXPECT_GT(workspace.limits_hit.at("singularity"), 0.05);
  EXPECT_LT(workspace.volume, 0.99 * truth()["orthoglide_reach_volume"]["value"].get<double>());
  EXPECT_GT(workspace.worst, 0);
  EXPECT_NEAR(workspace.best, 1, 0.06);
}

TEST(Workspace, OneAndTwoThreadsGiveTheSameBits) {
  const Machine machine = catalog_machine("delta-1");
  WorkspaceOptions options;
  options.accuracy = 5e-3;
  const auto run = [&] {
    nlohmann::ordered_json json = to_json(compute_workspace(machine, options));
    json.erase("seconds");
    return json.dump();
  };
  std::string one;
  {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    one = run();
  }
  EXPECT_EQ(one, run());
}

TEST(Workspace, FewerThanThreeTranslationsGiveExtentsAndNoVolume) {
  const Workspace planar = compute_workspace(catalog_machine("3-prp"));
  EXPECT_EQ(planar.volume, 0);
  EXPECT_GT(planar.upper.x() - planar.lower.x(), 0.1);
  EXPECT_GT(planar.upper.y() - planar.lower.y(), 0.1);
  EXPECT_EQ(planar.upper.z(), planar.lower.z());
  EXPECT_EQ(planar.area_by_z.size(), 1u);
  EXPECT_EQ(planar.inscribed_cylinder.height, 0);

  const Workspace vertical = compute_workspace(catalog_machine("3-rps"));
  EXPECT_EQ(vertical.volume, 0);
  EXPECT_GT(vertical.upper.z(), vertical.lower.z());

  EXPECT_EQ(compute_workspace(catalog_machine("bennett")).volume, 0);
}

TEST(Workspace, AnUnreachableOrientationIsAnEmptyWorkspace) {
  WorkspaceOptions options;
  options.rotation = Eigen::AngleAxisd(0.3, Vector3::UnitX());
  const Workspace workspace = compute_workspace(catalog_machine("delta-1"), options);
  EXPECT_EQ(workspace.volume, 0);
  EXPECT_TRUE(workspace.limits_hit.empty());
}

TEST(Workspace, UnlimitedStrokesEndAtTheSearchBox) {
  const Machine machine = prepare(linear_delta(0.25, 1, 1.5, 0), task_of({0, 1, 2}));
  const Workspace workspace = volume_of(machine, {"stroke"}, 5e-3);
  EXPECT_GT(workspace.volume, 2.3);
  EXPECT_GT(workspace.limits_hit.at("search box"), 0);
}

TEST(Workspace, ALayoutWithARotationStatesHowFarItTurnsAndWhatStopsIt) {
  const Machine machine = catalog_machine("table1-6");
  const Workspace workspace = compute_workspace(machine);
  ASSERT_TRUE(workspace.rotation_range);
  const auto& range = *workspace.rotation_range;
  EXPECT_EQ(range.axis, 'B');
  EXPECT_LT(range.min, -0.2);
  EXPECT_GT(range.max, 0.2);
  const Evaluator evaluator(machine);
  Eigen::VectorXd drives;
  for (double share : {0.05, 0.5, 0.95}) {
    const double angle = range.min + share * (range.max - range.min);
    const Pose pose{range.at, Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3::UnitY()))};
    EXPECT_LT(evaluator.inverse(pose, drives), 0) << angle;
  }
  EXPECT_FALSE(range.max_limit.empty());
}

TEST(Workspace, TheDocumentHasTheWordsOfTheContract) {
  WorkspaceOptions options;
  options.accuracy = 5e-3;
  options.box = Vector3(0.1, 0.1, 0.1);
  const auto json = to_json(compute_workspace(catalog_machine("delta-1"), options));
  for (const char* word : {"volume", "volume_bounds", "area_by_z", "inscribed_cylinder",
                           "inscribed_box", "conditioning", "characteristic_length", "limits_hit",
                           "poses", "seconds", "slices", "zone"})
    EXPECT_TRUE(json.contains(word)) << word;
  EXPECT_EQ(json["slices"].size(), 9u);
  const auto& slice = json["slices"][4];
  EXPECT_EQ(slice["values"].size(), slice["v"].size());
  EXPECT_EQ(slice["values"][0].size(), slice["u"].size());
}

}  // namespace
}  // namespace polyglide
