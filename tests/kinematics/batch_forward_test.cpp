#include <gtest/gtest.h>

#include "kinematics/batch_kernels.hpp"
#include "leg_machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

TEST(BatchForward, FindsThePosesThatInverseCameFrom) {
  for (const auto& [name, machine] : leg_machines()) {
    if (machine.model.drives.size() < machine.task.axes.size()) continue;
    const Evaluator evaluator(machine);
    const PoseBatch batch = poses_of(machine, 203, 0.05, 0.1);
    BatchResult inverse;
    evaluator.evaluate(batch, inverse);
    const auto& conditions = inverse.inverse_condition;
    if (!(*std::max_element(conditions.begin(), conditions.end()) > 0.05)) continue;  // singular
    for (const batch::Kernel* kernel : batch::available_kernels()) {
      DriveBatch drives{batch.size(), inverse.drives, {}, kernel->name};
      ForwardResult forward;
      evaluator.forward(drives, forward);
      int found = 0;
      for (std::size_t i = 0; i < batch.size(); ++i) {
        if (inverse.limit[i] >= 0 || !(inverse.inverse_condition[i] > 1e-2)) continue;
        ++found;
        ASSERT_LT(forward.residual[i], 1e-12) << name;
        EXPECT_NEAR(forward.pose[0][i], batch.x[i], 1e-9) << name << ' ' << kernel->name;
        EXPECT_NEAR(forward.pose[1][i], batch.y[i], 1e-9) << name << ' ' << kernel->name;
        EXPECT_NEAR(forward.pose[2][i], batch.z[i], 1e-9) << name << ' ' << kernel->name;
        Eigen::Matrix<double, 6, 1> at = Eigen::Matrix<double, 6, 1>::Zero();
        for (int k = 0; k < 3; ++k)
          if (!batch.angles[k].empty()) at[3 + k] = batch.angles[k][i];
        const Eigen::Quaterniond turn(forward.pose[3][i], forward.pose[4][i], forward.pose[5][i],
                                      forward.pose[6][i]);
        EXPECT_LT(turn.angularDistance(pose_of(at).rotation), 1e-8) << name;
      }
      EXPECT_GT(found, 20) << name;
    }
  }
}

TEST(BatchForward, OfAGeneralMachineFollowsItsDrives) {
  const Machine machine = catalog_machine("3-rps");
  const Evaluator evaluator(machine);
  DriveBatch drives{5, {}, {}, {}};
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i < 5; ++i) drives.drives.push_back(0.002 * i * (d + 1) * machine.model.size);
  ForwardResult forward;
  evaluator.forward(drives, forward);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_LT(forward.residual[i], 1e-9);
    Posture posture = home(machine.model);
    Eigen::Vector3d asked(drives.drives[i], drives.drives[5 + i], drives.drives[10 + i]);
    ASSERT_TRUE(solve_forward_from(machine, asked, posture));
    const Pose pose =
        platform_pose(machine.model, posture.bodies[machine.model.mechanism.platform]);
    EXPECT_NEAR(forward.pose[2][i], pose.position.z(), 1e-9);
  }
}

TEST(BatchForward, WithoutASolutionSaysSo) {
  const Evaluator evaluator(prepare(orthoglide(1), task_of({0, 1, 2})));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  DriveBatch drives{2, {9, nan, -9, 0, 9, 0}, {}, {}};
  ForwardResult forward;
  evaluator.forward(drives, forward);
  EXPECT_FALSE(forward.residual[0] < 1e-9);
  EXPECT_FALSE(forward.residual[1] < 1e-9);
  EXPECT_THROW(evaluator.forward({2, {1, 2, 3}, {}, {}}, forward), std::invalid_argument);
}

}  // namespace
}  // namespace polyglide
