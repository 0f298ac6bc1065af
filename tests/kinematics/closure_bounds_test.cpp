#include "kinematics/closure_bounds.hpp"

#include <gtest/gtest.h>

#include "kinematics/evaluate.hpp"
#include "kinematics/leg_bounds.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

/// u² = 1 + x, said `times` times.
ParametricEnclosure square_root(int times) {
  return [times](const std::vector<Interval>& u, const std::vector<Interval>& x) {
    Enclosure result{std::vector<Interval>(times), IntervalMatrix(times, 2)};
    for (int i = 0; i < times; ++i) {
      result.values[i] = (square(u[0]) - (1.0 + x[0])) * Interval(i + 1.0);
      result.jacobian(i, 0) = 2.0 * u[0] * Interval(i + 1.0);
      result.jacobian(i, 1) = Interval(-1.0) * Interval(i + 1.0);
    }
    return result;
  };
}

TEST(ParametricRoot, EnclosesASquareRootAndItsDerivative) {
  const UpwardRounding rounding;
  for (int times : {1, 2}) {
    const auto centre = root_at(square_root(times), {0.0}, {0.9});
    ASSERT_TRUE(centre);
    EXPECT_LE(centre->root[0].lower(), 1);
    EXPECT_GE(centre->root[0].upper(), 1);
    const auto whole = roots_over(square_root(times), {Interval(-0.2, 0.2)}, *centre);
    ASSERT_TRUE(whole);
    for (double x : {-0.2, -0.1, 0.0, 0.05, 0.2}) {
      const double u = std::sqrt(1 + x), rate = 1 / (2 * u);
      EXPECT_TRUE(whole->roots[0].lower() <= u && u <= whole->roots[0].upper());
      EXPECT_TRUE(whole->rates(0, 0).lower() <= rate && rate <= whole->rates(0, 0).upper());
    }
    EXPECT_LT(whole->roots[0].upper() - whole->roots[0].lower(), 0.4);
    // The other root is not in the box where this one is alone.
    EXPECT_GT(whole->alone[0].lower(), -0.8);
  }
}

TEST(ParametricRoot, ProvesNothingAcrossADoubleRootOrFromAPoorGuess) {
  const UpwardRounding rounding;
  const auto centre = root_at(square_root(1), {-0.9}, {0.3});
  ASSERT_TRUE(centre);
  EXPECT_FALSE(roots_over(square_root(1), {Interval(-1.1, -0.7)}, *centre));
  EXPECT_FALSE(root_at(square_root(1), {-1.5}, {0.3}));
  EXPECT_FALSE(root_at(square_root(1), {0.0}, {1e-12}));
}

TEST(ParametricRoot, IsFollowedAsFarAsItGoes) {
  const UpwardRounding rounding;
  const auto start = root_at(square_root(1), {0.0}, {1.0});
  ASSERT_TRUE(start);
  const FollowedRoot home{*start, true, nullptr};
  const FollowedRoot far = follow_root(square_root(1), {Interval(2.9, 3.1)}, home, 50);
  ASSERT_TRUE(far.in_middle && far.whole);
  EXPECT_NEAR(middle(far.point.root[0]), 2, 1e-9);
  const FollowedRoot beyond = follow_root(square_root(1), {Interval(-1.6, -1.4)}, home, 50);
  EXPECT_FALSE(beyond.in_middle || beyond.whole);
}

struct Sample {
  PoseBox box;
  std::vector<Eigen::Matrix<double, 6, 1>> poses;
};

Sample sample_of(const Machine& machine, Uniform& uniform, double reach, double half) {
  Sample sample;
  Eigen::Matrix<double, 6, 1> centre = Eigen::Matrix<double, 6, 1>::Zero();
  for (int axis : machine.task.axes)
    centre[axis] = (axis < 3 ? machine.model.size : 1.0) * reach * uniform();
  for (int axis = 0; axis < 6; ++axis) sample.box[axis] = Interval(centre[axis]);
  sample.poses.assign(8, centre);
  for (int axis : machine.task.axes) {
    const double side = (axis < 3 ? machine.model.size : 1.0) * half;
    sample.box[axis] = Interval(centre[axis] - side, centre[axis] + side);
    for (auto& pose : sample.poses) pose[axis] += side * uniform();
  }
  return sample;
}

bool spans(const Interval& a, double x, double slack = 1e-8) {
  return a.lower() - slack <= x && x <= a.upper() + slack;
}

// Limbs alone, plates that join limbs, and platforms of which some coordinates follow.
TEST(ClosureBounds, HoldWhatTheGeneralSolverFinds) {
  Uniform uniform;
  for (const char* name : {"3-cpu", "3-crr", "3-rpc", "3-rrc", "tripteron", "quadrupteron",
                           "3-prps", "minimanipulator", "dynapod", "3-rps", "h4", "par4"}) {
    const Machine machine = catalog_machine(name);
    const Evaluator evaluator(machine, {"stroke", "range", "cone"});
    int proved = 0;
    for (int trial = 0; trial < 4; ++trial) {
      const UpwardRounding rounding;
      const auto dut = ClosureBounds::make(machine, {}, Eigen::Quaterniond::Identity());
      ASSERT_TRUE(dut) << name;
      const Sample sample = sample_of(machine, uniform, 0.03, trial % 2 ? 0.002 : 0.01);
      const auto branch = dut->follow(sample.box, nullptr);
      BoxLimits::Mask all;
      for (std::size_t i = 0; i < dut->size(); ++i) all.set(i);
      std::vector<LimitBound> whole, centre;
      dut->enclose(sample.box, all, whole, branch);
      dut->enclose(middle_of(sample.box), all, centre, branch);
      if (whole[0].value.upper() > 0) continue;
      ++proved;
      const IntervalMatrix jacobian = dut->jacobian(sample.box, branch);
      for (const auto& pose : sample.poses) {
        Posture posture = home(machine.model);
        ASSERT_TRUE(solve_inverse_general(machine, pose_of(pose), posture).reachable);
        const Eigen::VectorXd drives = drive_positions(machine.model, posture);
        for (std::size_t d = 0; d < machine.model.drives.size(); ++d) {
          const Freedom& freedom = machine.model.freedoms[machine.model.drives[d]];
          const Joint& joint = machine.model.mechanism.joints[freedom.joint];
          const std::string stroke = "stroke " + joint.name + " max";
          const bool alone = std::ranges::count(joint.driven, freedom.index) ==
                             static_cast<std::ptrdiff_t>(joint.driven.size());
          for (std::size_t i = 0; alone && i < dut->size(); ++i) {
            if (dut->name(i) != stroke) continue;
            const double value = drives[d] - joint.range[freedom.index].max;
            EXPECT_TRUE(spans(whole[i].value, value)) << name << " " << stroke;
            Interval mean = centre[i].value;
            for (int axis : machine.task.axes)
              mean += whole[i].gradient[axis] * (pose[axis] - middle(sample.box[axis]));
            EXPECT_TRUE(spans(mean, value)) << name << " " << stroke;
          }
        }
        const auto expected = task_jacobian(machine, posture);
        ASSERT_TRUE(expected);
        for (int i = 0; i < jacobian.rows(); ++i)
          for (int j = 0; j < jacobian.cols(); ++j)
            EXPECT_TRUE(spans(jacobian(i, j), (*expected)(i, j), 1e-6)) << name;
      }
    }
    EXPECT_GT(proved, 0) << name;
  }
}

TEST(ClosureBounds, AgreeWithClosedFormsOfLegs) {
  Uniform uniform;
  for (const char* name : {"hexapod-6ups", "eclipse"}) {
    const Machine machine = catalog_machine(name);
    const UpwardRounding rounding;
    const auto legs = LegBounds::make(machine, {}, Eigen::Quaterniond::Identity(), true);
    if (!legs) continue;
    const auto dut = ClosureBounds::make(machine, {}, Eigen::Quaterniond::Identity());
    ASSERT_TRUE(dut) << name;
    for (int trial = 0; trial < 4; ++trial) {
      const Sample sample = sample_of(machine, uniform, 0.05, 0.005);
      const auto branch = dut->follow(sample.box, nullptr);
      BoxLimits::Mask all;
      for (std::size_t i = 0; i < BoxLimits::kMost; ++i) all.set(i);
      std::vector<LimitBound> loops, closed;
      dut->enclose(middle_of(sample.box), all, loops, branch);
      legs->enclose(middle_of(sample.box), all, closed);
      int compared = 0;
      for (std::size_t i = 0; i < dut->size(); ++i)
        for (std::size_t j = 0; j < legs->size(); ++j) {
          if (dut->name(i) != legs->name(j) || dut->name(i).find("stroke") != 0) continue;
          EXPECT_TRUE(spans(loops[i].value, middle(closed[j].value))) << dut->name(i);
          ++compared;
        }
      EXPECT_EQ(compared, 12);
    }
  }
}

TEST(ClosureBounds, BoxesThatAreTooLargeOrOutOfReachSayNothingFalse) {
  const UpwardRounding rounding;
  const Machine machine = catalog_machine("tripteron");
  const auto dut = ClosureBounds::make(machine, {}, Eigen::Quaterniond::Identity());
  ASSERT_TRUE(dut);
  PoseBox box;
  box.fill(Interval(0.0));
  for (int k = 0; k < 3; ++k) box[k] = Interval(-1, 1);
  BoxLimits::Mask all;
  for (std::size_t i = 0; i < dut->size(); ++i) all.set(i);
  std::vector<LimitBound> bounds;
  dut->enclose(box, all, bounds, dut->follow(box, nullptr));
  for (std::size_t i = 0; i < dut->size(); ++i) EXPECT_TRUE(zero_in(bounds[i].value));
  // Every rail ends long before.
  for (int k = 0; k < 3; ++k) box[k] = Interval(0.99, 1);
  dut->enclose(box, all, bounds, dut->follow(box, nullptr));
  EXPECT_TRUE(std::ranges::any_of(bounds, [](const auto& each) { return each.value.lower() > 0; }));
}

TEST(ClosureBounds, ThereAreNoneForLimitsWithoutEnclosure) {
  Mechanism mechanism = catalog_machine("3-cpu").model.mechanism;
  mechanism.expressions.push_back({"bent", "x*y", {0, 1}});
  const Machine machine = prepare(mechanism, task_of({0, 1, 2}));
  const UpwardRounding rounding;
  EXPECT_FALSE(ClosureBounds::make(machine, {}, Eigen::Quaterniond::Identity()));
  EXPECT_TRUE(ClosureBounds::make(machine, {"bent"}, Eigen::Quaterniond::Identity()));
}

}  // namespace
}  // namespace polyglide
