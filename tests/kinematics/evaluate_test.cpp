#include "kinematics/evaluate.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

PoseBatch single(const Vector3& at,
                 const Eigen::Quaterniond& rotation = Eigen::Quaterniond::Identity()) {
  return {{at.x()}, {at.y()}, {at.z()}, rotation};
}

/// Name of the limit met at a place, "" when it is reachable.
std::string limit_at(const Evaluator& evaluator, const Vector3& at,
                     const Eigen::Quaterniond& rotation = Eigen::Quaterniond::Identity()) {
  BatchResult result;
  evaluator.evaluate(single(at, rotation), result);
  return result.limit[0] < 0 ? "" : evaluator.limit_names()[result.limit[0]];
}

double inverse_condition_at(const Evaluator& evaluator, const Vector3& at) {
  BatchResult result;
  evaluator.evaluate(single(at), result);
  return result.inverse_condition[0];
}

TEST(Evaluate, TheOrthoglideIsIsotropicAtHome) {
  const Evaluator evaluator(prepare(orthoglide(1), task_of({0, 1, 2})));
  EXPECT_TRUE(evaluator.closed_form());
  EXPECT_NEAR(1 / inverse_condition_at(evaluator, Vector3::Zero()),
              truth()["orthoglide_home_condition"]["value"].get<double>(), 1e-9);
}

TEST(Evaluate, OnTheDiagonalOfTheOrthoglideAmplificationIsHalfToTwoInItsCube) {
  // On x = y = z = t the singular values are 1 - 2a and 1 + a (double), a = t/sqrt(L² - 2t²).
  const Evaluator evaluator(prepare(orthoglide(1), task_of({0, 1, 2})));
  for (double t : {-0.4, -0.2, 0.05, 0.15, 0.23}) {
    const double a = t / std::sqrt(1 - 2 * t * t);
    const double first = std::abs(1 - 2 * a), second = std::abs(1 + a);
    EXPECT_NEAR(inverse_condition_at(evaluator, Vector3::Constant(t)),
                std::min(first, second) / std::max(first, second), 1e-7)
        << t;
  }
}

TEST(Evaluate, OnItsAxisALinearDeltaHasTheKnownSingularValues) {
  // sqrt 3 and sqrt(3/2) tan β (double), sin β = e/L: isotropic at e/L = sqrt(2/3).
  for (double e : {0.1, 0.25, 0.5, 0.7, std::sqrt(2.0 / 3), 0.9}) {
    const Evaluator evaluator(prepare(linear_delta(e, 1, 5, 1), task_of({0, 1, 2})));
    const double beta = std::asin(e), ratio = std::tan(beta) / std::sqrt(2);
    EXPECT_NEAR(inverse_condition_at(evaluator, Vector3::Zero()), std::min(ratio, 1 / ratio), 1e-7)
        << e;
  }
}

TEST(Evaluate, APlanarStrutMachineWithTangentLegsIsIsotropic) {
  // Three leg lines tangent to a circle of radius d, 120° apart: JᵀJ = diag(3/2, 3/2, 3d²).
  const double d = 0.37;
  std::vector<std::pair<Vector3, Vector3>> limbs;
  for (int leg = 0; leg < 3; ++leg) {
    const double angle = leg * 2 * M_PI / 3;
    const Vector3 touch(d * std::cos(angle), d * std::sin(angle), 0);
    const Vector3 along(-std::sin(angle), std::cos(angle), 0);
    limbs.push_back({touch - 1.3 * along, touch});
  }
  Machine machine = prepare(strutted(limbs), task_of({0, 1, 5}));
  machine.task.characteristic_length = std::sqrt(2) * d;
  EXPECT_NEAR(inverse_condition_at(Evaluator(machine), Vector3::Zero()),
              1 / truth()["planar_3RPR_isotropic"]["value"].get<double>(), 1e-7);
}

/// Volume of reachable places in a box by a fine grid of cell centres.
double reachable_volume(const Evaluator& evaluator, const Vector3& lower, const Vector3& upper,
                        int n) {
  PoseBatch batch;
  for (int i = 0; i < n * n * n; ++i) {
    const Vector3 share = Vector3(i % n + 0.5, i / n % n + 0.5, i / n / n + 0.5) / n;
    const Vector3 at = lower + share.cwiseProduct(upper - lower);
    batch.x.push_back(at.x());
    batch.y.push_back(at.y());
    batch.z.push_back(at.z());
  }
  BatchResult result;
  evaluator.evaluate(batch, result);
  const auto inside = std::count(result.limit.begin(), result.limit.end(), -1);
  return (upper - lower).prod() * static_cast<double>(inside) / static_cast<double>(batch.size());
}

TEST(Evaluate, WithoutStrokesTheOrthoglideReachesTheSolidOfThreeCylinders) {
  const Evaluator evaluator(prepare(orthoglide(1), task_of({0, 1, 2})));
  EXPECT_NEAR(reachable_volume(evaluator, Vector3::Constant(-1.05), Vector3::Constant(1.05), 121),
              truth()["orthoglide_reach_volume"]["value"].get<double>(), 0.01);
}

TEST(Evaluate, ACongruentHexapodReachesASphericalShell) {
  std::vector<std::pair<Vector3, Vector3>> limbs;
  for (int leg = 0; leg < 6; ++leg) {
    const Vector3 foot(std::cos(leg * 1.1), std::sin(leg * 1.1), 0);
    limbs.push_back({foot, foot + Vector3(0, 0, 1.25)});
  }
  const Evaluator evaluator(prepare(strutted(limbs, {-0.25, 0.25}), task_of({0, 1, 2, 3, 4, 5})));
  const Vector3 centre(0, 0, -1.25);
  EXPECT_NEAR(reachable_volume(evaluator, centre - Vector3::Constant(1.55),
                               centre + Vector3::Constant(1.55), 121),
              truth()["gough_congruent_const_orientation"]["value"].get<double>(), 0.03);
  EXPECT_EQ(inverse_condition_at(evaluator, Vector3::Zero()), 0);  // parallel legs
}

TEST(Evaluate, ClosedFormAgreesWithLoopClosureOnEveryLegMachine) {
  Uniform random;
  for (const char* name : {"delta-1", "tripod-70", "hexapod-6ups", "table1-1", "table1-6"}) {
    const Machine machine = catalog_machine(name);
    const Evaluator evaluator(machine);
    ASSERT_TRUE(evaluator.closed_form()) << name;
    int compared = 0;
    for (int i = 0; i < 12; ++i) {
      Eigen::Matrix<double, 6, 1> at = Eigen::Matrix<double, 6, 1>::Zero();
      for (int axis : machine.task.axes) at[axis] = (axis < 3 ? 0.05 : 0.1) * random();
      const Pose pose = pose_of(at);
      Eigen::VectorXd drives;
      if (evaluator.inverse(pose, drives) >= 0) continue;
      Posture posture = home(machine.model);
      const InverseResult general = solve_inverse_general(machine, pose, posture);
      ASSERT_TRUE(general.reachable) << name;
      EXPECT_LT((general.drives - drives).cwiseAbs().maxCoeff(), 1e-8) << name;

      BatchResult result;
      evaluator.evaluate(single(pose.position, pose.rotation), result);
      const auto jacobian = task_jacobian(machine, posture);
      ASSERT_TRUE(jacobian) << name;
      EXPECT_NEAR(result.inverse_condition[0], 1 / condition_number(*jacobian), 1e-6) << name;
      const double det = jacobian->determinant();
      EXPECT_EQ(result.orientation[0], det > 0 ? 1 : -1) << name;
      ++compared;
    }
    EXPECT_GE(compared, 6) << name;
  }
}

TEST(Evaluate, GeneralMachinesAnswerTheSameQuestions) {
  const Evaluator evaluator(catalog_machine("3-rps"));
  EXPECT_FALSE(evaluator.closed_form());
  EXPECT_EQ(limit_at(evaluator, Vector3::Zero()), "");
  EXPECT_GT(inverse_condition_at(evaluator, Vector3::Zero()), 0.01);
  EXPECT_NE(limit_at(evaluator, Vector3(0, 0, 5)), "");
}

TEST(Evaluate, EveryLimitHasItsNameAndCanBeIgnored) {
  Mechanism mechanism = orthoglide(1, {-0.2, 0.3});
  Joint& top = mechanism.joints[4];  // leg2.top
  top.cone = 0.2;
  top.cone_axis = Vector3::UnitY();  // the rod lies along -y: either sense is meant
  mechanism.limits = {{"roof", 1, {Vector3::Zero()}, {{Vector3::UnitZ(), 0.1}}}};
  const Machine machine = prepare(mechanism, task_of({0, 1, 2}));
  const Evaluator all(machine);
  EXPECT_EQ(limit_at(all, Vector3::Zero()), "");
  EXPECT_EQ(limit_at(all, {0.31, 0, 0}), "stroke leg1.guide max");
  EXPECT_EQ(limit_at(all, {-0.21, 0, 0}), "stroke leg1.guide min");
  EXPECT_EQ(limit_at(all, {0, 2, 0}), "reach leg1.rod");
  EXPECT_EQ(limit_at(all, {0.25, 0, 0}), "cone leg2.top");
  EXPECT_EQ(limit_at(all, {0, 0, 0.15}), "roof");
  EXPECT_EQ(
      limit_at(all, Vector3::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Vector3::UnitX()))),
      "motion");
  EXPECT_EQ(limit_at(Evaluator(machine, {"stroke", "cone"}), {0.31, 0, 0}), "");
  EXPECT_EQ(limit_at(Evaluator(machine, {"stroke leg1.guide max", "cone leg2.top"}), {0.31, 0, 0}),
            "");
  EXPECT_EQ(limit_at(Evaluator(machine, {"roof"}), {0, 0, 0.15}), "");
  EXPECT_EQ(limit_at(Evaluator(machine, {"roof"}), {0.31, 0, 0}), "stroke leg1.guide max");
}

TEST(Evaluate, ALimitOnACarriageFollowsItsDrive) {
  Mechanism mechanism = orthoglide(1);
  mechanism.limits = {{"column", 2, {Vector3::UnitX()}, {{Vector3::UnitX(), 1.25}}}};
  const Evaluator evaluator(prepare(mechanism, task_of({0, 1, 2})));
  EXPECT_EQ(limit_at(evaluator, {0.24, 0, 0}), "");
  EXPECT_EQ(limit_at(evaluator, {0.26, 0, 0}), "column");
}

TEST(Evaluate, RodsThatAskOneCarriageToBeInTwoPlacesCannotReach) {
  // A second rod on carriage 1, parallel only while the platform is not turned.
  Mechanism mechanism = orthoglide(1);
  mechanism.bodies.push_back("leg1.rod_b");
  mechanism.joints.push_back(joint_of("leg1.top_b", JointType::spherical, 2, 8, {1, 0, 0.2}));
  mechanism.joints.push_back(joint_of("leg1.bottom_b", JointType::spherical, 8, 1, {0, 0, 0.2}));
  const Evaluator evaluator(prepare(mechanism, task_of({0, 1, 2, 4})));
  ASSERT_TRUE(evaluator.closed_form());
  EXPECT_EQ(limit_at(evaluator, {0.1, 0, 0}), "");
  EXPECT_EQ(limit_at(evaluator, Vector3::Zero(),
                     Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vector3::UnitY()))),
            "reach leg1.rod_b");
}

TEST(Evaluate, ColumnsOfDifferentLengthAreRefused) {
  const Evaluator evaluator(prepare(orthoglide(1), task_of({0, 1, 2})));
  BatchResult result;
  EXPECT_THROW(evaluator.evaluate({{0, 0}, {0}, {0, 0}, Eigen::Quaterniond::Identity()}, result),
               std::invalid_argument);
  evaluator.evaluate({{}, {}, {}, Eigen::Quaterniond::Identity()}, result);
  EXPECT_TRUE(result.limit.empty());
}

TEST(Evaluate, OneAndTwoThreadsGiveTheSameBits) {
  const Evaluator evaluator(catalog_machine("table1-6"));
  Uniform random;
  PoseBatch batch;
  for (int i = 0; i < 20000; ++i) {
    const Vector3 at = 0.6 * random.vector();
    batch.x.push_back(at.x());
    batch.y.push_back(at.y());
    batch.z.push_back(at.z());
  }
  BatchResult one, two;
  {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    evaluator.evaluate(batch, one);
  }
  evaluator.evaluate(batch, two);
  EXPECT_EQ(one.limit, two.limit);
  EXPECT_EQ(one.inverse_condition, two.inverse_condition);
}

}  // namespace
}  // namespace polyglide
