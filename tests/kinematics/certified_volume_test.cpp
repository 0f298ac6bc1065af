#include "kinematics/certified_volume.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <chrono>

#include "kinematics/region_measure.hpp"
#include "kinematics/workspace.hpp"
#include "random_machine.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

std::optional<CertifiedVolume> proved(const Machine& machine, double tolerance,
                                      const std::vector<std::string>& ignored = {},
                                      int budget = 1000000, bool singular_too = false) {
  const Evaluator evaluator(machine, ignored);
  const Probe probe(evaluator, Eigen::Quaterniond::Identity());
  const auto start = std::chrono::steady_clock::now();
  const auto result = certify_volume(evaluator.machine(), ignored, Eigen::Quaterniond::Identity(),
                                     search_bounds(probe), {singular_too, {}}, tolerance, budget);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (result)
    std::printf("%s: %.6g to %.6g, %.3g %%, %d cells, %.3f s\n",
                machine.model.mechanism.name.c_str(), result->lower, result->upper,
                100 * (1 - result->lower / result->upper), result->cells, seconds);
  return result;
}

TEST(CertifiedVolume, OfDeltaOneIsKnownToAThousandth) {
  const auto dut = proved(catalog_machine("delta-1"), 1e-3);
  ASSERT_TRUE(dut);
  EXPECT_TRUE(dut->reached);
  EXPECT_LE(dut->upper - dut->lower, 1e-3 * dut->upper);
  EXPECT_NEAR(dut->lower, 10.007e-3, 0.002 * 10.007e-3);
  const auto wider = proved(catalog_machine("delta-1"), 1e-3, {"triangle"});
  ASSERT_TRUE(wider);
  EXPECT_NEAR(wider->lower, 12.010e-3, 0.002 * 12.010e-3);
  EXPECT_GT(wider->lower, dut->upper);
}

TEST(CertifiedVolume, TakesFewCellsForAThousandth) {
  // Gap and square of the cell shrink together: some four times the cells for a fourth of the gap.
  for (const std::vector<std::string>& ignored :
       {std::vector<std::string>{}, std::vector<std::string>{"triangle"}}) {
    const auto rough = proved(catalog_machine("delta-1"), 1e-3, ignored),
               fine = proved(catalog_machine("delta-1"), 2.5e-4, ignored);
    ASSERT_TRUE(rough && fine);
    EXPECT_TRUE(rough->reached && fine->reached);
    EXPECT_LT(rough->cells, 80000);
    EXPECT_LT(fine->cells, 6 * rough->cells);
    EXPECT_GE(fine->lower, rough->lower * (1 - 1e-3));
    EXPECT_LE(fine->lower, rough->upper);
    EXPECT_GE(fine->upper, rough->lower);
  }
}

TEST(CertifiedVolume, EnclosesWhatQuadratureFindsOnCatalogMachines) {
  for (const char* name : {"linear-delta", "3-ruu"}) {
    const Machine machine = catalog_machine(name);
    const Workspace workspace = compute_workspace(machine);
    const auto dut = proved(machine, 1e-3);
    ASSERT_TRUE(dut) << name;
    EXPECT_TRUE(dut->reached) << name;
    EXPECT_EQ(workspace.method, "quadrature") << name;
    EXPECT_LE(dut->lower, workspace.volume + workspace.error) << name;
    EXPECT_GE(dut->upper, workspace.volume - workspace.error) << name;
  }
}

TEST(CertifiedVolume, EnclosesTheAreaOfPlanarMachines) {
  for (const char* name : {"3-rrr-planar", "3-prr-planar", "3-rpr-planar", "five-bar"}) {
    const Workspace dut = compute_workspace(catalog_machine(name));
    EXPECT_TRUE(dut.certified) << name;
    EXPECT_EQ(dut.method, "quadrature") << name;
    EXPECT_LE(dut.area_lower, dut.area) << name;
    EXPECT_GE(dut.area_upper, dut.area) << name;
    EXPECT_LT(dut.area_upper - dut.area_lower, 1e-3 * dut.area) << name;
    EXPECT_EQ(dut.volume_upper, 0) << name;
  }
}

TEST(CertifiedVolume, EnclosesTheClosedFormOfALinearDelta) {
  const auto expected = truth()["linear_delta_vertical_e0.25_L1.0_H1.5"]["value"].get<double>();
  const Machine machine = prepare(linear_delta(0.25, 1, 1.5, 0), task_of({0, 1, 2}));
  for (double tolerance : {1e-1, 1e-2, 2e-3}) {
    const auto dut = proved(machine, tolerance);
    ASSERT_TRUE(dut);
    EXPECT_LE(dut->lower, expected);
    EXPECT_GE(dut->upper, expected);
    EXPECT_TRUE(dut->reached);
  }
}

TEST(CertifiedVolume, EnclosesTheVolumeOfAPrism) {
  // Planes are exact: the bounds close at once, and they close around the truth, slack of the
  // limits (1e-9 m) included.
  const Machine machine = prism({{Vector3::UnitX(), 0.3},
                                 {-Vector3::UnitX(), 0.1},
                                 {Vector3::UnitY(), 0.2},
                                 {-Vector3::UnitY(), 0.2},
                                 {Vector3(1, 0, 1).normalized(), 0.15},
                                 {-Vector3::UnitZ(), 0.05}});
  // z <= 0.15 √2 - x over x in [-0.1, 0.3], with z >= -0.05 where that is less than nothing.
  const double top = 0.15 * std::sqrt(2.0) + 0.05, from = -0.1, to = std::min(0.3, top);
  const double expected = 0.4 * (top * (to - from) - (to * to - from * from) / 2);
  const auto dut = proved(machine, 1e-3);
  ASSERT_TRUE(dut);
  EXPECT_LE(dut->lower, expected * (1 + 1e-7));
  EXPECT_GE(dut->upper, expected * (1 - 1e-7));
}

double sampled_volume(const Machine& machine) {
  const Evaluator evaluator(machine);
  Probe probe(evaluator, Eigen::Quaterniond::Identity());
  const RegionFineness fineness = region_fineness(5e-3, true);
  return measure_region(probe, explore(probe, fineness.nodes), fineness, 5e-3).value;
}

TEST(CertifiedVolume, HoldsWhatSamplingFindsOnCatalogMachines) {
  for (const char* name : {"tripod-70", "hexapod-6ups", "table1-2", "table1-6", "delta", "hexa"}) {
    const Machine machine = catalog_machine(name);
    const auto dut = proved(machine, 2e-2, {}, 60000);
    if (!dut) {
      std::printf("%s: none\n", name);
      continue;
    }
    const double sampled = sampled_volume(machine);
    EXPECT_LE(dut->lower, sampled * 1.01) << name;
    EXPECT_GE(dut->upper, sampled * 0.99) << name;
    EXPECT_GT(dut->lower, 0) << name;
  }
}

TEST(CertifiedVolume, HoldsWhatSamplingFindsOfRandomMachines) {
  std::mt19937_64 random(29);
  constexpr std::array kKinds{DriveKind::guide, DriveKind::strut, DriveKind::crank};
  std::array<int, 3> compared{};
  for (int trial = 0; trial < 180; ++trial) {
    const Machine machine = random_machine(random, kKinds[trial % 3]);
    const auto dut = proved(machine, 5e-3, {}, 60000);
    if (!dut) continue;  // home outside
    const double sampled = sampled_volume(machine);
    EXPECT_LE(dut->lower, sampled * 1.02) << trial;
    EXPECT_GE(dut->upper, sampled * 0.98) << trial;
    ++compared[trial % 3];
  }
  for (const int count : compared) EXPECT_GT(count, 4);
}

// A Tripteron's drives are x, y and z, and its limbs 2R arms across them, R long in all: with
// A(a, b) = [hypot(0.44 - a, b) <= R] the volume is the integral of A(y, z) A(z, x) A(x, y).
TEST(CertifiedVolume, EnclosesTheClosedFormOfATripteron) {
  const double reach = std::hypot(0.2, 0.25) + std::hypot(0.24, 0.25);
  constexpr int kSteps = 300;
  const auto at = [](int i) { return 0.4 * (i + 0.5) / kSteps - 0.2; };
  Eigen::MatrixXd within(kSteps, kSteps);
  for (int i = 0; i < kSteps; ++i)
    for (int k = 0; k < kSteps; ++k)
      within(i, k) = std::hypot(0.44 - at(i), at(k)) <= reach ? 1 : 0;
  const double expected = (within * within * within).trace() * std::pow(0.4 / kSteps, 3);
  const Workspace dut = compute_workspace(catalog_machine("tripteron"));
  EXPECT_TRUE(dut.certified);
  EXPECT_LE(dut.volume_lower, expected);
  EXPECT_GE(dut.volume_upper, expected);
  EXPECT_NEAR(dut.volume, expected, 3 * dut.error);
}

// Both platforms are singular wherever they are: what is left is where the struts reach.
TEST(CertifiedVolume, CountsSingularPlacesWhereAsked) {
  for (const char* name : {"wren-platform", "griffis-duffy", "table1-2"}) {
    const Machine machine = catalog_machine(name);
    EXPECT_FALSE(proved(machine, 1e-3)) << name;
    const auto dut = proved(machine, 1e-3, {}, 300000, true);
    ASSERT_TRUE(dut) << name;
    EXPECT_TRUE(dut->reached) << name;
    if (machine.task.rotations == 3) continue;  // hexapods take longer to measure
    const Workspace workspace = compute_workspace(machine);
    EXPECT_TRUE(workspace.singular_throughout) << name;
    EXPECT_TRUE(workspace.certified) << name;
    EXPECT_LE(dut->lower, workspace.volume + workspace.error) << name;
    EXPECT_GE(dut->upper, workspace.volume - workspace.error) << name;
  }
}

// Each drive of these is a coordinate of the tool: a cube, from which the arms of the
// 3-CRR and the tripteron may take corners.
TEST(CertifiedVolume, OfDecoupledMachinesIsTheCubeOfTheirStrokes) {
  const auto dut = [](const char* name, double half, int budget) {
    const Machine machine = catalog_machine(name);
    const Vector3 room = Vector3::Constant(1.1 * half);
    return certify_volume(machine, {}, Eigen::Quaterniond::Identity(), {-room, room}, {}, 1e-2,
                          budget);
  };
  const auto cube = dut("3-cpu", 0.15, 20000);
  ASSERT_TRUE(cube);
  EXPECT_LE(cube->lower, 0.3 * 0.3 * 0.3);
  EXPECT_GE(cube->upper, 0.3 * 0.3 * 0.3);
  EXPECT_LT(cube->upper - cube->lower, 0.02 * cube->upper);
  const auto cut = dut("3-crr", 0.2, 20000);
  ASSERT_TRUE(cut);
  EXPECT_GT(cut->upper, 0.0635);
  EXPECT_LT(cut->lower, 0.4 * 0.4 * 0.4);
  EXPECT_GT(cut->lower, 0.8 * cut->upper);
}

TEST(CertifiedVolume, WithoutClosedFormIsTheSameForAnyNumberOfThreads) {
  const Machine machine = catalog_machine("3-ppsp");
  const auto dut = [&] {
    const Vector3 room = Vector3::Constant(0.13);
    return certify_volume(machine, {}, Eigen::Quaterniond::Identity(), {-room, room}, {}, 1e-2,
                          4000);
  };
  const auto two = dut();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto alone = dut();
  ASSERT_TRUE(two && alone);
  EXPECT_EQ(two->lower, alone->lower);
  EXPECT_EQ(two->upper, alone->upper);
  EXPECT_LE(two->lower, 0.006965 * 1.02);
  EXPECT_GE(two->upper, 0.006965 * 0.98);
}

TEST(CertifiedVolume, ABudgetTooSmallLeavesWideBounds) {
  const auto dut = proved(catalog_machine("delta-1"), 1e-4, {}, 3000);
  ASSERT_TRUE(dut);
  EXPECT_FALSE(dut->reached);
  EXPECT_LT(dut->lower, 10.007e-3);
  EXPECT_GT(dut->upper, 10.007e-3);
}

TEST(CertifiedVolume, IsTheSameForAnyNumberOfThreads) {
  const Machine machine = catalog_machine("delta-1");
  const auto two = proved(machine, 1e-2);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto alone = proved(machine, 1e-2);
  ASSERT_TRUE(two && alone);
  EXPECT_EQ(two->lower, alone->lower);
  EXPECT_EQ(two->upper, alone->upper);
}

TEST(CertifiedVolume, ProvesNothingWithoutClosedFormOrBounds) {
  EXPECT_FALSE(proved(catalog_machine("3-rps"), 1e-2));     // parasitic motion
  EXPECT_FALSE(proved(catalog_machine("four-bar"), 1e-2));  // no volume
  // Everything forbidden: nothing to enclose.
  const Machine machine = prism({{Vector3::UnitX(), -0.2}, {-Vector3::UnitX(), 0.1}});
  EXPECT_FALSE(proved(machine, 1e-2));
}

}  // namespace
}  // namespace polyglide
