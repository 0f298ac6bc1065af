#include "kinematics/stiffness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "catalog/catalog.hpp"
#include "kinematics/planar.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

/// Indices where the machine is at home.
std::optional<PoseIndices> at_home(const Machine& machine, const Springs& springs = {}) {
  const auto drives =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(machine.model.drives.size())).eval();
  return indices_at(machine, {}, drives, home(machine.model), springs);
}

std::string message_of(const Machine& machine, const Springs& springs) {
  try {
    static_cast<void>(at_home(machine, springs));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

// Textbook: three drives at right angles that move the tool one to one, each with its rods in
// series.
TEST(Stiffness, OfPerpendicularStrutsIsThatOfEach) {
  const Machine machine = prepare(orthoglide(2), task_of({0, 1, 2}));
  const auto dut = at_home(machine, {{1e6, 2e6, 4e6}, 4e6, {}});
  ASSERT_TRUE(dut);
  const Vector3 expected(1 / (1e-6 + 0.25e-6), 1 / (0.5e-6 + 0.25e-6), 1 / (0.25e-6 + 0.25e-6));
  EXPECT_TRUE(dut->stiffness.isApprox(Eigen::MatrixXd(expected.asDiagonal()), 1e-12));
  EXPECT_NEAR(dut->translation->least, expected.minCoeff(), 1e-3);
  EXPECT_NEAR(dut->translation->greatest, expected.maxCoeff(), 1e-3);
  EXPECT_FALSE(dut->rotation);
}

// A force beside the centre of a cubic hexapod turns the platform too, and so moves the tool more:
// K moved to a tool at distance d, then condensed, is what springs in series give.
TEST(Stiffness, OfATranslationLetsThePlatformTurn) {
  const double s = std::sqrt(0.5), r = std::sqrt(1.0 / 6);
  std::vector<std::pair<Vector3, Vector3>> legs;
  const double low = -std::sqrt(1.0 / 12);
  const Vector3 a(0, -2 * r, low), b(s, r, low), c(-s, r, low);
  const Vector3 up1(s, -r, -low), up2(-s, -r, -low), up3(0, 2 * r, -low);
  for (const auto& [foot, head] :
       {std::pair{a, up1}, {a, up2}, {b, up1}, {b, up3}, {c, up2}, {c, up3}})
    legs.emplace_back(foot, head);
  Mechanism mechanism = strutted(legs);
  const auto centred = at_home(prepare(mechanism, task_of({0, 1, 2, 3, 4, 5})));
  ASSERT_TRUE(centred);
  EXPECT_NEAR(centred->translation->least, 2, 1e-9);
  EXPECT_NEAR(centred->rotation->least, 0.5, 1e-9);
  const double d = 0.7;
  mechanism.tool = Vector3(0, 0, d);
  const auto raised = at_home(prepare(mechanism, task_of({0, 1, 2, 3, 4, 5})));
  ASSERT_TRUE(raised);
  EXPECT_NEAR(raised->translation->least, 1 / (1 / 2.0 + d * d / 0.5), 1e-9);
  EXPECT_NEAR(raised->translation->greatest, 2, 1e-9);
}

TEST(Stiffness, RowsOfLegsAreThoseOfTheGeneralEngine) {
  Uniform uniform;
  int seen = 0;
  for (const std::string& name : catalog_names()) {
    const Machine machine = catalog_machine(name);
    if (!knows_rods(machine)) continue;
    Posture posture = home(machine.model);
    Eigen::Matrix<double, 6, 1> at = Eigen::Matrix<double, 6, 1>::Zero();
    for (int axis : machine.task.axes)
      at[axis] = uniform() * (axis < 3 ? 0.03 * machine.model.size : 0.03);
    const InverseResult inverse = solve_inverse_general(machine, pose_of(at), posture);
    if (!inverse.reachable) continue;
    const auto general = task_jacobian(machine, posture);
    const auto dut = indices_at(machine, inverse.pose, inverse.drives, std::nullopt);
    if (!general || !dut) continue;
    ++seen;
    Eigen::MatrixXd expected = *general;
    for (Eigen::Index k = 0; k < expected.cols(); ++k)
      if (machine.task.axes[k] >= 3) expected.col(k) *= machine.task.characteristic_length;
    EXPECT_LT((dut->jacobian - expected).norm(), 1e-6 * expected.norm()) << name;
  }
  EXPECT_GT(seen, 15);
}

TEST(Stiffness, ASingularPostureYields) {
  std::vector<std::pair<Vector3, Vector3>> legs;
  for (int i = 0; i < 6; ++i) {
    const Vector3 foot(std::cos(i * 1.1), std::sin(i * 1.1), 0);
    legs.emplace_back(foot, foot + Vector3::UnitZ());
  }
  const auto dut = at_home(prepare(strutted(legs), task_of({0, 1, 2, 3, 4, 5})));
  ASSERT_TRUE(dut);
  EXPECT_TRUE(std::isinf(dut->condition));
  EXPECT_NEAR(dut->translation->least, 0, 1e-9);
  EXPECT_NEAR(dut->rotation->least, 0, 1e-9);
}

TEST(Stiffness, RefusesSpringsThatDoNotFit) {
  const Machine machine = prepare(orthoglide(1), task_of({0, 1, 2}));
  EXPECT_NE(message_of(machine, {{1, 2}, {}, {}}).find("2 drive stiffnesses given"),
            std::string::npos);
  EXPECT_NE(message_of(machine, {{-1}, {}, {}}).find("must be a positive number"),
            std::string::npos);
  EXPECT_NE(message_of(machine, {{1}, std::nan(""), {}}).find("rod stiffness must be"),
            std::string::npos);
  EXPECT_NE(message_of(machine, {{1}, {}, 0.0}).find("characteristic length"), std::string::npos);
  EXPECT_NE(message_of(catalog_machine("3-rps"), {{1}, 1.0, {}}).find("needs legs of"),
            std::string::npos);
}

TEST(PlanarMachines, HaveLegsOfAClosedForm) {
  for (const char* name : {"3-rpr-planar", "3-rrr-planar", "3-prr-planar"}) {
    const Machine machine = catalog_machine(name);
    EXPECT_TRUE(machine.legs) << name;
    EXPECT_EQ(machine.task.axes, (std::vector<int>{0, 1, 5})) << name;
  }
  EXPECT_TRUE(plane_of_motion(expand(find_layout("five-bar"))));
  EXPECT_FALSE(plane_of_motion(expand(find_layout("3-rps"))));
  EXPECT_FALSE(plane_of_motion({}));
}

TEST(PlanarMachines, OfTwoFreedomsAreCommandedByTheTool) {
  for (const char* name : {"five-bar", "pantograph"})
    EXPECT_EQ(catalog_machine(name).task.axes, (std::vector<int>{0, 1})) << name;
  const InverseResult dut =
      solve_inverse(catalog_machine("five-bar"), {Vector3(0.01, 0.02, 0), {1, 0, 0, 0}});
  ASSERT_TRUE(dut.reachable) << dut.limit;
  EXPECT_LT((dut.pose.position - Vector3(0.01, 0.02, 0)).norm(), 1e-9);
  EXPECT_GT(dut.pose.rotation.angularDistance(Eigen::Quaterniond::Identity()), 1e-3);
}

// Crank and rocker are parallel at home, so the coupler does not turn there, and its rotation
// commands nothing: x = -40 mm · crank angle does.
TEST(Stiffness, OfAFourBarIsOverWhatMovesAtHome) {
  const Machine machine = catalog_machine("four-bar");
  EXPECT_EQ(machine.task.axes, std::vector<int>{0});
  const auto dut = at_home(machine);
  ASSERT_TRUE(dut);
  EXPECT_NEAR(dut->jacobian(0, 0), -1 / 0.04, 1e-9);
  EXPECT_DOUBLE_EQ(dut->condition, 1);
  EXPECT_FALSE(dut->rotation);
}

TEST(Stiffness, IsKnownAtHomeOfEveryMachineThatMoves) {
  for (const std::string& name : catalog_names()) {
    const Machine machine = catalog_machine(name);
    EXPECT_EQ(at_home(machine).has_value(), !machine.task.axes.empty())
        << name << ": " << why_no_indices(machine, home(machine.model));
  }
  EXPECT_EQ(catalog_machine("verne").task.axes, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(catalog_machine("metrom-pentapod").task.translations, 3);
  EXPECT_EQ(catalog_machine("metrom-pentapod").task.rotations, 2);
}

TEST(Stiffness, SaysWhyItIsNotKnown) {
  Machine four_bar = catalog_machine("four-bar");
  four_bar.task = task_of({5});
  EXPECT_FALSE(at_home(four_bar));
  EXPECT_EQ(why_no_indices(four_bar, home(four_bar.model)),
            "C do not command the machine here: it can move while they stand still");
  four_bar.task = task_of({0, 1});
  EXPECT_FALSE(at_home(four_bar));
  EXPECT_NE(why_no_indices(four_bar, home(four_bar.model)).find("only 1 of its 2 freedoms"),
            std::string::npos);
  four_bar.task = {};
  EXPECT_FALSE(at_home(four_bar));
  EXPECT_NE(why_no_indices(four_bar, std::nullopt).find("commands no motion"), std::string::npos);
}

}  // namespace
}  // namespace polyglide
