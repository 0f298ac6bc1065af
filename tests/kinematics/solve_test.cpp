#include "kinematics/solve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "cases.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

using Coordinates = Eigen::Matrix<double, 6, 1>;

/// A posture reached by moving every drive by up to `reach` [m or rad/size].
std::optional<Posture> random_reached(const Machine& machine, std::mt19937_64& random,
                                      double reach) {
  Eigen::VectorXd drives(static_cast<Eigen::Index>(machine.model.drives.size()));
  for (Eigen::Index d = 0; d < drives.size(); ++d)
    drives[d] =
        uniform(random, -reach, reach) *
        (machine.model.freedoms[machine.model.drives[d]].translational ? machine.model.size : 1);
  Posture posture = home(machine.model);
  if (!solve_forward_from(machine, drives, posture)) return std::nullopt;
  return posture;
}

Pose pose_at(const Machine& machine, const Posture& posture) {
  return platform_pose(machine.model, posture.bodies[machine.model.mechanism.platform]);
}

// --- Laws for every determinate catalog entry ---

std::vector<std::string> determinate_entries() {
  std::vector<std::string> names;
  for (const std::string& name : catalog_names())
    if (analyse_mobility(compile(expand(find_layout(name))), {.walks = 2, .evidence = false})
            .verdict == Verdict::determinate)
      names.push_back(name);
  return names;
}

class CatalogMachine : public testing::TestWithParam<std::string> {
 protected:
  Machine dut = prepare(expand(find_layout(GetParam())));
};

TEST_P(CatalogMachine, InverseUndoesForward) {
  std::mt19937_64 random(11);
  int tried = 0;
  for (int sample = 0; sample < 100 && tried < 12; ++sample) {
    const auto posture = random_reached(dut, random, 0.02);
    if (!posture) continue;
    ++tried;
    const Pose pose = pose_at(dut, *posture);
    const InverseResult back =
        solve_inverse(dut, pose, {"stroke", "range", "cone", "table", "triangle"});
    ASSERT_TRUE(back.reachable) << back.limit;
    if ((back.drives - drive_positions(dut.model, *posture)).norm() < 1e-8 * (1 + dut.model.size))
      continue;
    // A machine with parasitic motion (a coupler's angle, say) may take the same task
    // coordinates in two ways; then the other way must have them exactly.
    ASSERT_FALSE(dut.task.pure);
    EXPECT_LT((coordinates_of(back.pose) - coordinates_of(pose))(dut.task.axes).norm(), 1e-9);
  }
  EXPECT_GE(tried, 10);
}

TEST_P(CatalogMachine, FastPathEqualsTheGeneralSolver) {
  if (!dut.legs || !dut.task.pure)
    GTEST_SKIP() << "no closed form: the general solver is the only path";
  std::mt19937_64 random(12);
  for (int sample = 0; sample < 10; ++sample) {
    const auto reached = random_reached(dut, random, 0.08);
    if (!reached) continue;
    const Pose pose = pose_at(dut, *reached);
    Posture posture = home(dut.model);
    const InverseResult general = solve_inverse_general(dut, pose, posture);
    const InverseResult fast =
        solve_inverse(dut, pose, {"stroke", "range", "cone", "table", "triangle"});
    ASSERT_TRUE(general.reachable && fast.reachable);
    EXPECT_LT((general.drives - fast.drives).norm(), 1e-8 * (1 + dut.model.size));
  }
}

TEST_P(CatalogMachine, JacobianEqualsItsFiniteDifference) {
  std::mt19937_64 random(13);
  const Model& model = dut.model;
  std::optional<Posture> posture;
  for (int attempt = 0; attempt < 20 && !posture; ++attempt)
    posture = random_reached(dut, random, 0.05);
  ASSERT_TRUE(posture);
  const auto jacobian = task_jacobian(dut, *posture);
  ASSERT_TRUE(jacobian);
  const Eigen::Index axes = static_cast<Eigen::Index>(dut.task.axes.size());
  ASSERT_EQ(jacobian->rows(), axes);  // determinate: as many drives as task axes
  // Task rates per drive by central difference; J times them is the identity.
  const Eigen::VectorXd at = drive_positions(model, *posture);
  Eigen::MatrixXd rates(axes, at.size());
  for (Eigen::Index d = 0; d < at.size(); ++d) {
    const double h = 1e-5 * (model.freedoms[model.drives[d]].translational ? model.size : 1);
    Posture plus = *posture, minus = *posture;
    ASSERT_TRUE(solve_forward_from(dut, at + h * Eigen::VectorXd::Unit(at.size(), d), plus));
    ASSERT_TRUE(solve_forward_from(dut, at - h * Eigen::VectorXd::Unit(at.size(), d), minus));
    const Pose p = pose_at(dut, plus), m = pose_at(dut, minus);
    const Eigen::AngleAxisd turn(p.rotation * m.rotation.conjugate());
    Coordinates difference;
    difference << p.position - m.position,
        turn.angle() * turn.axis() * dut.task.characteristic_length;
    rates.col(d) = difference(dut.task.axes) / (2 * h);
  }
  EXPECT_LT((*jacobian * rates - Eigen::MatrixXd::Identity(axes, axes)).cwiseAbs().maxCoeff(),
            1e-5);
}

TEST_P(CatalogMachine, HomeIsTheZeroOfDrivesAndPose) {
  const InverseResult inverse = solve_inverse(dut, Pose{});
  EXPECT_TRUE(inverse.reachable) << inverse.limit;
  EXPECT_LT(inverse.drives.norm(), 1e-12 * (1 + dut.model.size));
  const auto forward = solve_forward(
      dut, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(dut.model.drives.size())), false);
  ASSERT_EQ(forward.size(), 1u);
  EXPECT_LT(coordinates_of(forward[0].pose).norm(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Catalog, CatalogMachine, testing::ValuesIn(determinate_entries()),
                         test_name);

// --- Delta 1 (Panov, Gustova, Mazein 2012) ---

class DeltaOne : public testing::Test {
 protected:
  static constexpr double a = 0.256, b = 0.12088, c = 0.070, d = 0.368;
  Machine dut = prepare(expand(find_layout("delta-1")));

  /// Carriage height i for the platform centre, formulas (1) and z_i of the paper.
  static Vector3 carriages(const Vector3& centre) {
    const double s3 = std::sqrt(3.0);
    const Eigen::Matrix<double, 3, 2> guide{{0, 0}, {d / 2, d * s3 / 2}, {d, 0}};
    const Eigen::Matrix<double, 3, 2> joint{{-b / 2 - c / 4, -(b + 2 * c) / (2 * s3) + c * s3 / 4},
                                            {0, (b + 2 * c) / s3 - c * s3 / 2},
                                            {b / 2 + c / 4, -(b + 2 * c) / (2 * s3) + c * s3 / 4}};
    Vector3 z;
    for (int i = 0; i < 3; ++i)
      z[i] = centre.z() +
             std::sqrt(a * a -
                       (guide.row(i) - joint.row(i) - centre.head<2>().transpose()).squaredNorm());
    return z;
  }

  /// The platform centre at home, in the paper's coordinates.
  [[nodiscard]] Vector3 home_centre() const {
    Vector3 centre = Vector3::Zero();
    for (const Leg& leg : dut.legs->legs) centre += leg.platform_point;
    return centre / static_cast<double>(dut.legs->legs.size());
  }
};

TEST_F(DeltaOne, InverseGivesTheCarriageHeightsOfThePaper) {
  ASSERT_TRUE(dut.legs);
  const Vector3 centre = home_centre(), at_home = carriages(centre);
  std::mt19937_64 random(3);
  for (int sample = 0; sample < 50; ++sample) {
    const Vector3 move(uniform(random, -0.08, 0.08), uniform(random, -0.08, 0.08),
                       uniform(random, -0.05, 0.05));
    const InverseResult result =
        solve_inverse(dut, {move}, {"stroke", "triangle", "table", "cone"});
    ASSERT_TRUE(result.reachable) << result.limit;
    EXPECT_LT((result.drives - (carriages(centre + move) - at_home)).norm(), 1e-12);
  }
}

TEST_F(DeltaOne, ForwardGivesBothRootsAndTheLowerOneIsHomes) {
  const Vector3 centre = home_centre(), at_home = carriages(centre);
  const Vector3 move(0.03, -0.02, 0.04);
  const Eigen::VectorXd drives = carriages(centre + move) - at_home;
  const auto solutions = solve_forward(dut, drives, true);
  ASSERT_EQ(solutions.size(), 2u);
  EXPECT_TRUE(solutions[0].home_mode);
  EXPECT_LT((solutions[0].pose.position - move).norm(), 1e-12);
  EXPECT_LT(solutions[0].pose.position.z(),
            solutions[1].pose.position.z());  // "the smaller z0 is meant"
  // Equation (3) holds for the other root too.
  const Vector3 other = centre + solutions[1].pose.position;
  EXPECT_LT((2 * other.z() * Vector3::Ones() - carriages(other) - (drives + at_home)).norm(), 1e-9);
}

TEST_F(DeltaOne, KeepsTheChecksOfThePaper) {
  const double far = 0.125;  // towards a side of the triangle
  const InverseResult result = solve_inverse(dut, {Vector3(0, far, 0.02)}, {"stroke", "cone"});
  EXPECT_FALSE(result.reachable);
  EXPECT_EQ(result.limit, "triangle");
  EXPECT_TRUE(
      solve_inverse(dut, {Vector3(0, far, 0.02)}, {"triangle", "stroke", "cone"}).reachable);
}

TEST_F(DeltaOne, SaysWhichStrokeEndsAndThatItCannotTurn) {
  EXPECT_EQ(solve_inverse(dut, {Vector3(0, 0, 0.4)}).limit.substr(0, 6), "stroke");
  Coordinates turned = Coordinates::Zero();
  turned[5] = 0.1;
  const InverseResult result = solve_inverse(dut, pose_of(turned));
  EXPECT_FALSE(result.reachable);
  EXPECT_NE(result.limit.find("C"), std::string::npos);
}

// --- Formulas (4) and (8) of the four-axis machine, by the general solver ---

TEST(PlanarMachine, GeneralSolverReproducesFormula4) {
  // Three vertical guides (along y) at x_B, rods KF, platform arms FJ at angle β,
  // tool SJ at angle A; every joint turns about z.
  const double rod = 0.5, tool = 0.12, a_home = M_PI / 2, x_b[] = {-0.4, 0.45, 0.35};
  const double arm[] = {0.1, 0.11, 0.14}, beta[] = {M_PI, 0.1, -0.7};
  const auto formula4 = [&](int i, const Vector3& s, double turn) {
    const double x = arm[i] * std::cos(beta[i] + turn) + tool * std::cos(a_home + turn) + s.x();
    const double y = arm[i] * std::sin(beta[i] + turn) + tool * std::sin(a_home + turn) + s.y();
    return std::sqrt(rod * rod - (x_b[i] - x) * (x_b[i] - x)) + y;
  };
  Mechanism mechanism;
  mechanism.bodies = {"base", "platform"};
  mechanism.platform = 1;
  for (int i = 0; i < 3; ++i) {
    const int carriage = static_cast<int>(mechanism.bodies.size());
    mechanism.bodies.insert(mechanism.bodies.end(),
                            {"carriage" + std::to_string(i), "rod" + std::to_string(i)});
    const Vector3 k(x_b[i], formula4(i, Vector3::Zero(), 0), 0);
    const Vector3 f(arm[i] * std::cos(beta[i]) + tool * std::cos(a_home),
                    arm[i] * std::sin(beta[i]) + tool * std::sin(a_home), 0);
    Joint slide, top, bottom;
    slide.name = "slide";
    slide.type = JointType::prismatic;
    slide.bodies = {0, carriage};
    slide.at = top.at = k;
    slide.axes = {Vector3::UnitY(), Vector3::UnitX()};
    slide.driven = {0};
    top.name = "top";
    top.bodies = {carriage, carriage + 1};
    bottom.name = "bottom";
    bottom.bodies = {carriage + 1, 1};
    bottom.at = f;
    mechanism.joints.insert(mechanism.joints.end(), {slide, top, bottom});
  }
  const Machine dut = prepare(mechanism);
  ASSERT_EQ(dut.task.axes, (std::vector<int>{0, 1, 5}));
  for (double turn : {-0.3, 0.0, 0.25}) {
    Coordinates goal;
    goal << 0.05, -0.04, 0, 0, 0, turn;
    Posture posture = home(dut.model);
    const InverseResult result = solve_inverse_general(dut, pose_of(goal), posture);
    ASSERT_TRUE(result.reachable);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(result.drives[i],
                  formula4(i, goal.head<3>(), turn) - formula4(i, Vector3::Zero(), 0), 1e-10);
  }
}

TEST(FourAxisMachine, GeneralSolverReproducesFormula8) {
  // Layout 6 with a tool of length d hanging from J, the platform's centre: the
  // tool lies in a plane parallel to XOZ, J = (x + d cos A, y, z + d sin A).
  const double d = 0.15;
  Mechanism mechanism = expand(find_layout("table1-6"));
  mechanism.tool = Vector3(0, 0, -d);
  const Machine dut = prepare(mechanism);
  ASSERT_TRUE(dut.legs);
  for (double turn : {-0.4, 0.2, 0.5}) {
    Coordinates goal;
    goal << 0.05, -0.08, 0.1, 0, turn, 0;
    Posture posture = home(dut.model);
    const InverseResult result = solve_inverse_general(dut, pose_of(goal), posture);
    ASSERT_TRUE(result.reachable);
    const double a = M_PI / 2 - turn;  // turning about +y leans the tool's top towards +x
    const Vector3 s = mechanism.tool + goal.head<3>();
    const Vector3 j = s + Vector3(d * std::cos(a), 0, d * std::sin(a));
    for (const Leg& leg : dut.legs->legs) {
      // The platform joint from J, turned by the same angle in the plane XOZ; then (4) in space.
      const Vector3& p = leg.platform_point;
      const Vector3 f = j + Vector3(std::cos(turn) * p.x() + std::sin(turn) * p.z(), p.y(),
                                    -std::sin(turn) * p.x() + std::cos(turn) * p.z());
      const double horizontal = (leg.base_point - f).head<2>().squaredNorm();
      const double carriage = f.z() + std::sqrt(leg.length * leg.length - horizontal);
      EXPECT_NEAR(result.drives[leg.drive], carriage - leg.base_point.z(), 1e-10);
    }
  }
}

// --- Limits ---

TEST(Inverse, OfAnUnreachablePoseIsAValueWithTheLimit) {
  const Machine dut = prepare(expand(find_layout("table1-6")));
  const InverseResult result = solve_inverse(dut, {Vector3(5, 0, 0)});
  EXPECT_FALSE(result.reachable);
  EXPECT_FALSE(result.limit.empty());
}

TEST(Forward, OfDrivesThatCannotBeAssembledIsEmpty) {
  const Machine dut = prepare(expand(find_layout("delta-1")));
  EXPECT_TRUE(solve_forward(dut, Eigen::Vector3d(2.0, -2.0, 0), true).empty());
}

}  // namespace
}  // namespace polyglide
