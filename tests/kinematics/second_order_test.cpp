// Freedoms that first order allows and finite motion does not, and branches that meet.

#include "kinematics/second_order.hpp"

#include <gtest/gtest.h>

#include "cases.hpp"
#include "kinematics/branches.hpp"
#include "kinematics/manifold.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

/// A planar linkage of revolutes about z; bodies are numbered, 0 is the base.
class Planar {
 public:
  Planar& hinge(int first, int second, double x, double y) {
    Joint joint = fixtures::joint_of("r" + std::to_string(mechanism_.joints.size()),
                                     JointType::revolute, first, second, {x, y, 0});
    if (mechanism_.joints.empty()) joint.driven = {0};
    mechanism_.joints.push_back(joint);
    while (static_cast<int>(mechanism_.bodies.size()) <= std::max(first, second))
      mechanism_.bodies.push_back("b" + std::to_string(mechanism_.bodies.size()));
    return *this;
  }
  [[nodiscard]] Mechanism with_platform(int body) {
    mechanism_.platform = body;
    return mechanism_;
  }

 private:
  Mechanism mechanism_;
};

SecondOrder look(const Mechanism& mechanism) {
  const Model model = compile(mechanism);
  std::mt19937_64 random(1);
  const Posture start = home(model);
  return second_order(model, start, freedoms_at(model, start).kernel, all_freedoms(model), random);
}

Mechanism three_hinges_in_line() {
  return Planar().hinge(0, 1, 0, 0).hinge(1, 2, 0.3, 0).hinge(2, 0, 1, 0).with_platform(1);
}

Mechanism flat_parallelogram() {
  return Planar()
      .hinge(0, 1, 0, 0)
      .hinge(1, 2, 0.4, 0)
      .hinge(2, 3, 1.4, 0)
      .hinge(3, 0, 1, 0)
      .with_platform(2);
}

/// Two Watt linkages face each other, their middles joined by a bar: 2 d (c + c) y³ + u² = 0, so
/// the curve of its postures has a cusp at home (Connelly, Servatius 1994).
Mechanism double_watt() {
  return Planar()
      .hinge(0, 1, -1, 0.25)
      .hinge(1, 2, 0, 0.25)
      .hinge(2, 3, 0, -0.25)
      .hinge(3, 0, 1, -0.25)
      .hinge(0, 4, 3, 0.25)
      .hinge(4, 5, 2, 0.25)
      .hinge(5, 6, 2, -0.25)
      .hinge(6, 0, 1, -0.25)
      .hinge(2, 7, 0, 0)
      .hinge(7, 5, 2, 0)
      .with_platform(7);
}

/// A four-bar whose coupler carries three hinges in line between two of its own points: one more
/// freedom than it has, at every posture.
Mechanism shaky_everywhere() {
  return Planar()
      .hinge(0, 1, 0, 0)
      .hinge(1, 2, 0.1, 0.4)
      .hinge(2, 3, 0.9, 0.6)
      .hinge(3, 0, 1, 0)
      .hinge(2, 4, 0.2, 0.8)
      .hinge(4, 5, 0.4, 0.8)
      .hinge(5, 2, 0.9, 0.8)
      .with_platform(2);
}

TEST(SecondOrder, ThreeHingesInLineCannotMove) {
  const SecondOrder found = look(three_hinges_in_line());
  EXPECT_EQ(found.obstructions, 1);
  EXPECT_TRUE(found.components.empty());
}

TEST(SecondOrder, AFlatParallelogramHasTwoWaysOut) {
  const Mechanism mechanism = flat_parallelogram();
  const SecondOrder found = look(mechanism);
  EXPECT_EQ(found.obstructions, 1);
  EXPECT_EQ(found.components.size(), 2u);
}

TEST(SecondOrder, KnowsTheTwoWaysOfAFlatParallelogram) {
  // Shortening along the line, a ω₁² + ω₂² - a ω₃² = 0 with ω₂ = a (ω₃ - ω₁): ω₃ = ω₁, or
  // ω₃ = -ω₁ (1 + a)/(1 - a).
  const Model model = compile(flat_parallelogram());
  const Eigen::MatrixXd kernel = freedoms_at(model, home(model)).kernel;
  std::vector<double> ratios;
  for (const auto& component : look(flat_parallelogram()).components) {
    const Eigen::VectorXd rates = kernel * component.front();
    ratios.push_back(-rates[3] / rates[0]);
  }
  std::ranges::sort(ratios);
  ASSERT_EQ(ratios.size(), 2u);
  EXPECT_NEAR(ratios[0], -1.4 / 0.6, 1e-9);
  EXPECT_NEAR(ratios[1], 1, 1e-9);
}

TEST(SecondOrder, OfFiveHingesInLineIsACone) {
  // Shortening along the line: Σ (x_{i+1} - x_i) θ_i² = 0 over the links, θ_i their angles.
  const std::vector<double> x{0, 0.3, 1.1, 0.8, 0.2};
  Planar chain;
  for (int i = 0; i < 5; ++i) chain.hinge(i, (i + 1) % 5, x[i], 0);
  const Mechanism mechanism = chain.with_platform(2);
  const Model model = compile(mechanism);
  const Eigen::MatrixXd kernel = freedoms_at(model, home(model)).kernel;
  const SecondOrder found = look(mechanism);
  ASSERT_EQ(found.components.size(), 1u);
  Eigen::MatrixXd members(kernel.cols(), found.components[0].size());
  for (Eigen::Index m = 0; m < members.cols(); ++m) {
    members.col(m) = found.components[0][m];
    const Eigen::VectorXd rates = kernel * members.col(m);
    double angle = 0, shortening = 0;
    for (int i = 0; i < 4; ++i) {
      angle += rates[i];
      shortening += (x[i + 1] - x[i]) * angle * angle;
    }
    EXPECT_NEAR(shortening, 0, 1e-12);
  }
  EXPECT_EQ(rank_of(members).rank, 3);
}

TEST(SecondOrder, WithoutConditionsSpansAllFreedoms) {
  Planar chain;
  for (int i = 0; i < 12; ++i) chain.hinge(i, i + 1, i, i % 2);
  const SecondOrder found = look(chain.with_platform(12));
  ASSERT_EQ(found.components.size(), 1u);
  Eigen::MatrixXd members(12, found.components[0].size());
  for (Eigen::Index m = 0; m < members.cols(); ++m) members.col(m) = found.components[0][m];
  EXPECT_EQ(rank_of(members).rank, 12);
}

TEST(SecondOrder, SetsNoConditionAtARegularPosture) {
  const Mechanism mechanism = Planar()
                                  .hinge(0, 1, 0, 0)
                                  .hinge(1, 2, 0.1, 0.4)
                                  .hinge(2, 3, 0.9, 0.6)
                                  .hinge(3, 0, 1, 0)
                                  .with_platform(2);
  EXPECT_EQ(look(mechanism).obstructions, 0);
}

TEST(SecondOrder, OfAnImmobileMechanismIsEmpty) {
  const Mechanism triangle =
      Planar().hinge(0, 1, 0, 0).hinge(1, 2, 0.5, 0.5).hinge(2, 0, 1, 0).with_platform(1);
  const SecondOrder found = look(triangle);
  EXPECT_EQ(found.obstructions, 0);
  EXPECT_TRUE(found.components.empty());
}

TEST(Branches, ShakyIsRigid) {
  const MobilityReport report = check(three_hinges_in_line());
  EXPECT_EQ(report.verdict, Verdict::rigid);
  EXPECT_EQ(report.home, 1);
  EXPECT_EQ(report.finite, 0);
}

TEST(Branches, MeetInAFlatParallelogram) {
  const MobilityReport report = check(flat_parallelogram());
  EXPECT_EQ(report.verdict, Verdict::uncertain);
  ASSERT_EQ(report.branches.size(), 2u);
  EXPECT_EQ(report.branches[0].dimension, 1);
  EXPECT_EQ(report.branches[1].dimension, 1);
}

TEST(Branches, ACuspIsOneBranchThatMoves) {
  const MobilityReport report = check(double_watt());
  EXPECT_EQ(report.home, 2);
  EXPECT_EQ(report.finite, 1);
  EXPECT_GE(report.platform_dof, 1);
  EXPECT_EQ(report.verdict, Verdict::singular_home) << report.reasons.front();
}

TEST(Branches, AFreedomThatNeverContinuesIsNotCounted) {
  const MobilityReport report = check(shaky_everywhere());
  EXPECT_EQ(report.home, 2);
  EXPECT_EQ(report.finite, 1);
  EXPECT_EQ(report.surplus, 0);
}

TEST(Branches, WalksGoTheSameWayForTheSameSeed) {
  const Model model = compile(flat_parallelogram());
  const Posture start = home(model);
  const Eigen::MatrixXd kernel = freedoms_at(model, start).kernel;
  std::mt19937_64 a(3), b(3);
  const Departure first = leave(model, start, kernel, false, {}, a);
  const Departure second = leave(model, start, kernel, false, {}, b);
  ASSERT_EQ(first.branches.size(), second.branches.size());
  for (std::size_t i = 0; i < first.branches.size(); ++i)
    EXPECT_EQ(first.branches[i].far.front().posture.q, second.branches[i].far.front().posture.q);
}

}  // namespace
}  // namespace polyglide
