#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "kinematics/batch_kernels.hpp"
#include "kinematics/evaluate.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

constexpr unsigned kEverything = Wanted::condition | Wanted::orientation | Wanted::frobenius |
                                 Wanted::smallest | Wanted::transmission | Wanted::stiffness |
                                 Wanted::drives | Wanted::jacobian;

/// Arms of length `arm` on axes tangential to a circle, rods with balls to a platform
/// below: Clavel's Delta, each parallelogram one rod. The rods of leg 1 are two, apart.
Mechanism rotary_delta(double radius = 0.4, double arm = 0.3, double rod = 0.8,
                       const Range& range = {}) {
  Mechanism mechanism;
  mechanism.name = "rotary delta";
  mechanism.bodies = {"base", "platform"};
  mechanism.platform = 1;
  const auto add = [&mechanism](const std::string& name) {
    mechanism.bodies.push_back(name);
    return static_cast<int>(mechanism.bodies.size()) - 1;
  };
  const double down = std::sqrt(rod * rod - (radius + arm - 0.1) * (radius + arm - 0.1));
  for (int leg = 0; leg < 3; ++leg) {
    const double angle = leg * 2 * M_PI / 3;
    const Vector3 out(std::cos(angle), std::sin(angle), 0), along(-out.y(), out.x(), 0);
    const std::string name = "leg" + std::to_string(leg + 1);
    const int crank = add(name + ".arm");
    Joint drive =
        joint_of(name + ".crank", JointType::revolute, 0, crank, radius * out + 0.2 * along, along);
    drive.driven = {0};
    drive.range = {range};
    mechanism.joints.push_back(drive);
    for (double aside : {-0.05, 0.05}) {
      const std::string side = aside < 0 ? "_a" : "_b";
      const int body = add(name + ".rod" + side);
      const Vector3 elbow = (radius + arm) * out + aside * along;
      const Vector3 foot = 0.1 * out + aside * along - down * Vector3::UnitZ();
      mechanism.joints.push_back(
          joint_of(name + ".top" + side, JointType::spherical, crank, body, elbow));
      mechanism.joints.push_back(
          joint_of(name + ".bottom" + side, JointType::spherical, body, 1, foot));
    }
  }
  return mechanism;
}

/// Poses about home in the task coordinates of a machine, with angles where it has some.
PoseBatch poses_of(const Machine& machine, std::size_t count, double reach = 0.08,
                   double turn = 0.2) {
  Uniform random;
  PoseBatch batch;
  batch.wanted = kEverything;
  batch.x.assign(count, 0);
  batch.y = batch.z = batch.x;
  for (int axis : machine.task.axes) {
    std::vector<double>& column = axis == 0   ? batch.x
                                  : axis == 1 ? batch.y
                                  : axis == 2 ? batch.z
                                              : batch.angles[axis - 3];
    column.resize(count);
    const double span = axis < 3 ? reach * machine.model.size : turn;
    for (double& value : column) value = span * random();
  }
  return batch;
}

/// Every leg machine of the catalog, and one with cranks.
const std::vector<std::pair<std::string, Machine>>& leg_machines() {
  static const auto machines = [] {
    std::vector<std::pair<std::string, Machine>> found;
    for (const std::string& name : catalog_names()) {
      const Mechanism mechanism = expand(find_layout(name));
      if (!recognise_legs(compile(mechanism))) continue;
      Machine machine = prepare(mechanism);
      if (machine.task.pure) found.emplace_back(name, std::move(machine));
    }
    found.emplace_back("rotary delta", prepare(rotary_delta(), task_of({0, 1, 2})));
    return found;
  }();
  return machines;
}

void expect_close(const std::vector<double>& a, const std::vector<double>& b, double tolerance,
                  const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i], b[i], tolerance * (1 + std::abs(b[i]))) << what << " at " << i;
  }
}

constexpr double kNoSign = 1e-10;  // 1/κ below which a determinant's sign is rounding

/// One Jacobian of a batch.
Eigen::MatrixXd jacobian_at(const BatchResult& result, const Machine& machine, std::size_t i) {
  const auto rows = static_cast<Eigen::Index>(machine.model.drives.size());
  const auto columns = static_cast<Eigen::Index>(machine.task.axes.size());
  Eigen::MatrixXd jacobian(rows, columns);
  for (Eigen::Index r = 0; r < rows; ++r)
    for (Eigen::Index c = 0; c < columns; ++c)
      jacobian(r, c) =
          result.jacobian[static_cast<std::size_t>(r * columns + c) * result.limit.size() + i];
  return jacobian;
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

TEST(Batch, IndicesFollowFromTheJacobian) {
  for (const auto& [name, machine] : leg_machines()) {
    const Evaluator evaluator(machine);
    const PoseBatch batch = poses_of(machine, 200);
    BatchResult result;
    evaluator.evaluate(batch, result);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (result.limit[i] >= 0) continue;
      const Eigen::MatrixXd j = jacobian_at(result, machine, i);
      if (j.rows() < j.cols()) {  // drives too few: a motion is left
        EXPECT_EQ(result.inverse_condition[i] + result.frobenius[i] + result.smallest[i], 0);
        continue;
      }
      const Eigen::VectorXd s = Eigen::JacobiSVD<Eigen::MatrixXd>(j).singularValues();
      const double least = s[s.size() - 1], greatest = s[0];
      ASSERT_NEAR(result.inverse_condition[i], least / greatest, 1e-9) << name << '\n' << j;
      if (least / greatest < kNoSign)
        continue;  // singular everywhere: nothing but rounding is left
      // table1-4 is all but singular: no way keeps more than 1e-14 of the greatest.
      EXPECT_NEAR(result.smallest[i], least, 1e-9 * least + 1e-14 * greatest) << name;
      EXPECT_NEAR(result.softest[i], least * least, 2e-9 * least * least + 1e-14 * greatest * least)
          << name;
      EXPECT_NEAR(result.stiffest[i] / (greatest * greatest), 1, 1e-9) << name;
      const double n = static_cast<double>(j.cols());
      EXPECT_NEAR(result.frobenius[i], n / (s.norm() * s.cwiseInverse().norm()), 1e-9) << name;
      EXPECT_GE(result.frobenius[i], result.inverse_condition[i] - 1e-12) << name;
      if (j.rows() == j.cols()) {
        EXPECT_EQ(result.orientation[i], j.determinant() > 0 ? 1 : -1) << name;
      }
    }
  }
}

TEST(Batch, OnTheAxisOfALinearDeltaTheRepeatedSingularValuesAreRight) {
  // sqrt 3 and sqrt(3/2) tan β (double), sin β = e/L.
  for (double e : {0.1, 0.25, 0.5, std::sqrt(2.0 / 3), 0.9}) {
    const Evaluator evaluator(prepare(linear_delta(e, 1, 5, 1), task_of({0, 1, 2})));
    PoseBatch batch;
    for (int i = 0; i < 21; ++i) batch.z.push_back(0.01 * i);
    batch.x.assign(21, 0);
    batch.y.assign(21, 0);
    BatchResult result;
    evaluator.evaluate(batch, result);
    const double ratio = std::tan(std::asin(e)) / std::sqrt(2);
    for (double inverse : result.inverse_condition)
      EXPECT_NEAR(inverse, std::min(ratio, 1 / ratio), 1e-12) << e;
  }
}

TEST(Batch, ASymmetricHexapodHasTheSingularValuesOfTheDecomposition) {
  const Machine machine = catalog_machine("hexapod-6ups");
  const Evaluator evaluator(machine);
  PoseBatch batch;
  batch.wanted = kEverything;
  for (int i = 0; i < 9; ++i) batch.z.push_back(0.01 * (i - 4));
  batch.x.assign(9, 0);
  batch.y.assign(9, 0);
  BatchResult result;
  evaluator.evaluate(batch, result);
  for (std::size_t i = 0; i < 9; ++i) {
    ASSERT_EQ(result.limit[i], -1);
    const Eigen::VectorXd s =
        Eigen::JacobiSVD<Eigen::MatrixXd>(jacobian_at(result, machine, i)).singularValues();
    EXPECT_NEAR(result.inverse_condition[i], s[5] / s[0], 1e-9);
  }
}

TEST(Batch, TransmissionOfAnOrthoglideAtHomeIsPerfectAndFallsOffAlongTheDiagonal) {
  // At (t, t, t) rod i makes cos = sqrt(1 - 2t²) with its guide.
  const Evaluator evaluator(prepare(orthoglide(1), task_of({0, 1, 2})));
  PoseBatch batch;
  batch.x = {0, 0.1, 0.2};
  batch.y = batch.z = batch.x;
  batch.wanted = Wanted::transmission;
  BatchResult result;
  evaluator.evaluate(batch, result);
  EXPECT_NEAR(result.transmission[0], 1, 1e-12);
  for (int i = 1; i < 3; ++i) {
    const double t = batch.x[i], in = std::sqrt(1 - 2 * t * t);
    // Out: rows of J are (1, a, a), a = -t/in; the velocity is a column of its inverse.
    const double a = -t / in;
    Eigen::Matrix3d j = Eigen::Matrix3d::Constant(a);
    j.diagonal().setOnes();
    const double out = 1 / (j.row(0).norm() * j.inverse().col(0).norm());
    EXPECT_NEAR(result.transmission[i], std::min(in, out), 1e-12);
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

TEST(Batch, ForwardFindsThePosesThatInverseCameFrom) {
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

TEST(Batch, ForwardOfAGeneralMachineFollowsItsDrives) {
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

TEST(Batch, ForwardWithoutASolutionSaysSo) {
  const Evaluator evaluator(prepare(orthoglide(1), task_of({0, 1, 2})));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  DriveBatch drives{2, {9, nan, -9, 0, 9, 0}, {}, {}};
  ForwardResult forward;
  evaluator.forward(drives, forward);
  EXPECT_FALSE(forward.residual[0] < 1e-9);
  EXPECT_FALSE(forward.residual[1] < 1e-9);
  EXPECT_THROW(evaluator.forward({2, {1, 2, 3}, {}, {}}, forward), std::invalid_argument);
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
