#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "kinematics/batch_kernels.hpp"
#include "leg_machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

void expect_close(const std::vector<double>& a, const std::vector<double>& b, double tolerance,
                  const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i], b[i], tolerance * (1 + std::abs(b[i]))) << what << " at " << i;
  }
}

TEST(Batch, EveryInstructionSetGivesTheNumbersOfTheScalarOne) {
  for (const auto& [name, machine] : leg_machines()) {
    const Evaluator evaluator(machine);
    // No multiple of any register, and larger than a block.
    PoseBatch batch = poses_of(machine, 1003, 0.3, 0.5);
    BatchResult scalar, other;
    batch.instructions = "scalar";
    evaluator.evaluate(batch, scalar);
    EXPECT_GT(std::count(scalar.limit.begin(), scalar.limit.end(), -1), 50) << name;
    for (const batch::Kernel* kernel : batch::available_kernels()) {
      const std::string what = name + ' ' + kernel->name;
      batch.instructions = kernel->name;
      evaluator.evaluate(batch, other);
      EXPECT_EQ(scalar.limit, other.limit) << what;
      for (std::size_t i = 0; i < batch.size(); ++i) {
        // A determinant that is all rounding has no sign (griffis-duffy, wren-platform).
        if (scalar.inverse_condition[i] > kNoSign) {
          EXPECT_EQ(scalar.orientation[i], other.orientation[i]) << what;
        }
        // Near singular postures the rounding of J's own entries is magnified.
        const double tolerance = scalar.inverse_condition[i] > 1e-3 ? 1e-12 : 1e-10;
        ASSERT_NEAR(other.inverse_condition[i], scalar.inverse_condition[i], tolerance) << what;
        ASSERT_NEAR(other.frobenius[i], scalar.frobenius[i], tolerance) << what;
        ASSERT_NEAR(other.smallest[i], scalar.smallest[i], tolerance * (1 + scalar.smallest[i]))
            << what;
        ASSERT_NEAR(other.transmission[i], scalar.transmission[i], tolerance) << what;
      }
      for (std::size_t i = 0; i < batch.size(); ++i) {
        if (scalar.limit[i] >= 0) continue;
        for (std::size_t d = 0; d < machine.model.drives.size(); ++d)
          ASSERT_NEAR(other.drives[d * batch.size() + i], scalar.drives[d * batch.size() + i],
                      1e-12)
              << what;
      }
    }
  }
}

TEST(Batch, EveryLegMachineAgreesWithLoopClosure) {
  for (const auto& [name, machine] : leg_machines()) {
    const Evaluator evaluator(machine);
    ASSERT_TRUE(evaluator.closed_form()) << name;
    const PoseBatch batch = poses_of(machine, 12, 0.05, 0.1);
    BatchResult result;
    evaluator.evaluate(batch, result);
    int compared = 0;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (result.limit[i] >= 0) continue;
      Eigen::Matrix<double, 6, 1> at;
      at << batch.x[i], batch.y[i], batch.z[i], 0, 0, 0;
      for (int k = 0; k < 3; ++k)
        if (!batch.angles[k].empty()) at[3 + k] = batch.angles[k][i];
      Posture posture = home(machine.model);
      const InverseResult general = solve_inverse_general(machine, pose_of(at), posture);
      ASSERT_TRUE(general.reachable) << name;
      for (Eigen::Index d = 0; d < general.drives.size(); ++d)
        EXPECT_NEAR(result.drives[static_cast<std::size_t>(d) * batch.size() + i],
                    general.drives[d], 1e-8)
            << name;
      const auto jacobian = task_jacobian(machine, posture);
      ASSERT_TRUE(jacobian) << name;
      EXPECT_LT((jacobian_at(result, machine, i) - *jacobian).cwiseAbs().maxCoeff(),
                1e-6 * jacobian->norm())
          << name;
      ++compared;
    }
    EXPECT_GE(compared, 4) << name;
  }
}

TEST(Batch, RotationsCommonToABatchEqualThoseOfEveryPose) {
  const Machine machine = catalog_machine("hexapod-6ups");
  const Evaluator evaluator(machine);
  PoseBatch common = poses_of(machine, 37);
  for (auto& angle : common.angles) angle.clear();
  const Eigen::Matrix<double, 6, 1> turn{0, 0, 0, 0.1, -0.15, 0.2};
  common.rotation = pose_of(turn).rotation;
  PoseBatch angles = common, quaternions = common;
  for (int k = 0; k < 3; ++k) angles.angles[k].assign(37, turn[3 + k]);
  const Eigen::Quaterniond q = common.rotation;
  const double parts[]{q.w(), q.x(), q.y(), q.z()};
  for (int k = 0; k < 4; ++k) quaternions.quaternion[k].assign(37, 2.5 * parts[k]);
  BatchResult a, b, c;
  evaluator.evaluate(common, a);
  evaluator.evaluate(angles, b);
  evaluator.evaluate(quaternions, c);
  EXPECT_EQ(a.limit, b.limit);
  EXPECT_EQ(a.limit, c.limit);
  expect_close(b.inverse_condition, a.inverse_condition, 1e-12, "angles");
  expect_close(c.inverse_condition, a.inverse_condition, 1e-12, "quaternions");
  expect_close(b.drives, a.drives, 1e-12, "drives");
}

TEST(Batch, WhatIsNoNumberIsAnsweredWithItsLimit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const char* name : {"delta-1", "hexapod-6ups", "3-rps"}) {
    const Evaluator evaluator(catalog_machine(name));
    PoseBatch batch;
    batch.x = {0, nan, 0, infinite};
    batch.y = {0, 0, -infinite, 0};
    batch.z = {0, 0, 0, nan};
    BatchResult result;
    evaluator.evaluate(batch, result);
    EXPECT_EQ(result.limit[0], -1) << name;
    for (int i = 1; i < 4; ++i) {
      EXPECT_EQ(evaluator.limit_names()[result.limit[i]], "not finite") << name;
      EXPECT_EQ(result.inverse_condition[i], 0) << name;
    }
    batch.angles[0] = {0, 0, 0, nan};
    evaluator.evaluate(batch, result);
    EXPECT_EQ(evaluator.limit_names()[result.limit[3]], "not finite") << name;
  }
}

TEST(Batch, EveryPoseOfADeltaThatTurnsIsStoppedByMotion) {
  const Evaluator evaluator(catalog_machine("delta-1"));
  PoseBatch batch;
  batch.x = batch.y = batch.z = {0, 0, 0};
  batch.angles[1] = {0, 1e-3, M_PI};
  BatchResult result;
  evaluator.evaluate(batch, result);
  EXPECT_EQ(result.limit[0], -1);
  EXPECT_EQ(evaluator.limit_names()[result.limit[1]], "motion");
  EXPECT_EQ(evaluator.limit_names()[result.limit[2]], "motion");
}

TEST(Batch, ADeltaOfCranksReachesAndStopsWhereItsGeometrySays) {
  // Straight below its home the arms turn alike; at the stretched posture the rods are in
  // line with them.
  const Range range{-0.5, 0.5};
  const Evaluator evaluator(prepare(rotary_delta(0.4, 0.3, 0.8, range), task_of({0, 1, 2})));
  ASSERT_TRUE(evaluator.closed_form());
  const double down = std::sqrt(0.64 - 0.36);
  PoseBatch batch;
  batch.wanted = Wanted::drives | Wanted::condition;
  for (double angle : {0.2, -0.3, 0.6, -0.6}) {
    // Elbow at (0.4 + 0.3 cos, 0.3 sin below); an arm turning about its tangent goes down.
    const double out = 0.4 + 0.3 * std::cos(angle) - 0.1;
    const double low = 0.3 * std::sin(angle) + std::sqrt(0.64 - out * out);
    batch.x.push_back(0);
    batch.y.push_back(0);
    batch.z.push_back(down - low);
  }
  batch.x.push_back(0), batch.y.push_back(0), batch.z.push_back(-3);
  BatchResult result;
  evaluator.evaluate(batch, result);
  const std::size_t size = batch.size();
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(result.drives[d * size], 0.2, 1e-12);
    EXPECT_NEAR(result.drives[d * size + 1], -0.3, 1e-12);
  }
  EXPECT_EQ(result.limit[0], -1);
  EXPECT_EQ(result.limit[1], -1);
  EXPECT_EQ(evaluator.limit_names()[result.limit[2]], "stroke leg1.crank max");
  EXPECT_EQ(evaluator.limit_names()[result.limit[3]], "stroke leg1.crank min");
  EXPECT_EQ(evaluator.limit_names()[result.limit[4]].substr(0, 10), "reach leg1");
}

TEST(Batch, ThreadsAndNeighboursChangeNothing) {
  const Machine machine = catalog_machine("hexapod-6ups");
  const Evaluator evaluator(machine);
  PoseBatch batch = poses_of(machine, 9001, 0.2, 0.4);
  batch.x[17] = batch.y[17] = 0;  // among the doubtful ones
  for (auto& angle : batch.angles) angle[17] = 0;
  BatchResult one, two, alone;
  {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    evaluator.evaluate(batch, one);
  }
  evaluator.evaluate(batch, two);
  EXPECT_EQ(one.limit, two.limit);
  EXPECT_EQ(one.inverse_condition, two.inverse_condition);
  EXPECT_EQ(one.transmission, two.transmission);
  for (std::size_t i : {0u, 5u, 17u, 9000u}) {
    PoseBatch single;
    single.wanted = kEverything;
    single.x = {batch.x[i]};
    single.y = {batch.y[i]};
    single.z = {batch.z[i]};
    for (int k = 0; k < 3; ++k) single.angles[k] = {batch.angles[k][i]};
    evaluator.evaluate(single, alone);
    EXPECT_EQ(alone.inverse_condition[0], one.inverse_condition[i]);
    EXPECT_EQ(alone.frobenius[0], one.frobenius[i]);
  }
}

TEST(Batch, WhatIsNotWantedIsEmptyAndNothingIsAskedOfNoPoses) {
  const Evaluator evaluator(catalog_machine("table1-6"));
  PoseBatch batch;
  BatchResult result;
  batch.wanted = kEverything;
  evaluator.evaluate(batch, result);
  EXPECT_TRUE(result.limit.empty());
  EXPECT_TRUE(result.drives.empty());
  ForwardResult forward;
  evaluator.forward({}, forward);
  EXPECT_TRUE(forward.residual.empty());
  batch.x = batch.y = batch.z = {0};
  batch.wanted = Wanted::frobenius;
  evaluator.evaluate(batch, result);
  EXPECT_EQ(result.frobenius.size(), 1u);
  EXPECT_TRUE(result.inverse_condition.empty());
  EXPECT_TRUE(result.drives.empty());
}

TEST(Batch, ColumnsOfWrongLengthAndUnknownInstructionSetsAreRefused) {
  const Evaluator evaluator(catalog_machine("hexapod-6ups"));
  PoseBatch batch;
  batch.x = batch.y = batch.z = {0, 0};
  batch.angles[1] = {0};
  BatchResult result;
  EXPECT_THROW(evaluator.evaluate(batch, result), std::invalid_argument);
  batch.angles[1].clear();
  batch.quaternion[0] = {1, 1};
  EXPECT_THROW(evaluator.evaluate(batch, result), std::invalid_argument);
  try {
    (void)batch::kernel_named("v9");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("scalar"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace polyglide
