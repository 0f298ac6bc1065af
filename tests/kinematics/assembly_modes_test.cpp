#include "kinematics/assembly_modes.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <chrono>

#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;
using nlohmann::json;

json cases() { return read_json(POLYGLIDE_SOURCE_DIR "/tests/truth/forward_kinematics.json"); }

Vector3 vector_of(const json& v) {
  return {v.at(0).get<double>(), v.at(1).get<double>(), v.size() > 2 ? v.at(2).get<double>() : 0};
}

Transform transform_of(const json& solution) {
  Transform place = Transform::Identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) place.linear()(i, j) = solution.at("R").at(i).at(j).get<double>();
  place.translation() = vector_of(solution.at("t"));
  return place;
}

/// A platform on struts, at home in its first solution, and the drives to the lengths of the file.
struct Case {
  Machine machine;
  Eigen::VectorXd drives;
};

Case strut_case(const json& data) {
  const Transform first = transform_of(data.at("solutions").at(0));
  std::vector<std::pair<Vector3, Vector3>> limbs;
  Eigen::VectorXd drives(static_cast<Eigen::Index>(data.at("base").size()));
  for (std::size_t i = 0; i < data.at("base").size(); ++i) {
    const Vector3 foot = vector_of(data.at("base")[i]);
    const Vector3 head = first * vector_of(data.at("platform")[i]);
    limbs.emplace_back(foot, head);
    drives[static_cast<Eigen::Index>(i)] =
        data.at("leg_lengths")[i].get<double>() - (head - foot).norm();
  }
  Mechanism mechanism = strutted(limbs);
  mechanism.tool = first.translation();
  return {prepare(mechanism, task_of({0, 1, 2, 3, 4, 5})), drives};
}

/// Every solution of the file is among those found.
void expect_all_found(const AssemblyModes& dut, const json& data) {
  const Transform home = transform_of(data.at("solutions").at(0));
  for (const json& solution : data.at("solutions")) {
    const Transform at = transform_of(solution) * home.inverse();
    const Vector3 shift = transform_of(solution).translation() - home.translation();
    const bool found =
        std::any_of(dut.solutions.begin(), dut.solutions.end(), [&](const ForwardSolution& mode) {
          return (mode.pose.position - shift).norm() < 1e-4 &&
                 mode.pose.rotation.angularDistance(Eigen::Quaterniond(at.linear())) < 1e-4;
        });
    EXPECT_TRUE(found) << "t = " << transform_of(solution).translation().transpose();
  }
}

void expect_all_certified(const AssemblyModes& dut) {
  for (const ForwardSolution& mode : dut.solutions) {
    EXPECT_TRUE(mode.certified) << mode.pose.position.transpose();
    EXPECT_GT(mode.radius, 0);
    EXPECT_LT(mode.residual, 1e-7);
  }
}

class SixStruts : public testing::TestWithParam<std::string> {};

TEST_P(SixStruts, HaveAllModesOfTheTruthCertified) {
  const json data = cases().at(GetParam());
  const Case problem = strut_case(data);
  const auto start = std::chrono::steady_clock::now();
  const AssemblyModes dut = find_assembly_modes(problem.machine, problem.drives);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_EQ(dut.solutions.size(), data.at("count_real").get<std::size_t>());
  expect_all_found(dut, data);
  expect_all_certified(dut);
  RecordProperty("seconds", std::to_string(seconds));
  std::printf("%s: %zu modes, %d starts, rarest %d, unseen %.2g, %.3f s\n", GetParam().c_str(),
              dut.solutions.size(), dut.completeness.starts, dut.completeness.rarest_hits,
              dut.completeness.unseen, seconds);
}
INSTANTIATE_TEST_SUITE_P(Truth, SixStruts, testing::Values("dietmaier_40", "platform_3_2_1"),
                         [](const auto& one) { return one.param; });

TEST(AssemblyModes, FortyCertifiedModesAreAllThereCanBe) {
  const Case problem = strut_case(cases().at("dietmaier_40"));
  for (std::uint64_t seed : {1, 2, 3, 4}) {
    AssemblySearch search;
    search.seed = seed;
    search.regions = false;
    const AssemblyModes dut = find_assembly_modes(problem.machine, problem.drives, search);
    EXPECT_EQ(dut.solutions.size(), 40u);
    EXPECT_TRUE(dut.completeness.complete);
    EXPECT_EQ(dut.completeness.bound, 40);
  }
}

TEST(AssemblyModes, ABudgetTooSmallSaysSo) {
  const Case problem = strut_case(cases().at("dietmaier_40"));
  AssemblySearch search;
  search.starts = 60;
  const AssemblyModes dut = find_assembly_modes(problem.machine, problem.drives, search);
  EXPECT_LT(dut.solutions.size(), 40u);
  EXPECT_FALSE(dut.completeness.complete);
  EXPECT_GT(dut.completeness.unseen, 0.02);
  EXPECT_NE(dut.completeness.stopped.find("budget of 60"), std::string::npos);
}

TEST(AssemblyModes, AreTheSameForAnyNumberOfThreads) {
  const Case problem = strut_case(cases().at("platform_3_2_1"));
  const AssemblyModes two = find_assembly_modes(problem.machine, problem.drives);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const AssemblyModes alone = find_assembly_modes(problem.machine, problem.drives);
  ASSERT_EQ(two.solutions.size(), alone.solutions.size());
  for (std::size_t i = 0; i < two.solutions.size(); ++i) {
    EXPECT_EQ(two.solutions[i].pose.position, alone.solutions[i].pose.position);
    EXPECT_EQ(two.solutions[i].region, alone.solutions[i].region);
  }
}

// Struts on hinges with tangential axes and balls at the platform.
Case three_rps(const json& data) {
  const double h1 = data.at("base_radius").get<double>();
  const json &first = data.at("solutions_f").at(0), &azimuth = data.at("azimuth_deg");
  Mechanism mechanism;
  mechanism.name = "3-rps";
  mechanism.bodies = {"base", "platform"};
  mechanism.platform = 1;
  Eigen::VectorXd drives = Eigen::VectorXd::Zero(3);
  Vector3 tool = Vector3::Zero();
  for (int i = 0; i < 3; ++i) {
    const double angle = azimuth[i].get<double>() * M_PI / 180, f = first[i].get<double>();
    const double length = data.at("leg_lengths")[i].get<double>();
    const Vector3 out(std::cos(angle), std::sin(angle), 0);
    const Vector3 tangent = Vector3::UnitZ().cross(out);
    const Vector3 along = -std::cos(f) * out + std::sin(f) * Vector3::UnitZ();
    const std::string leg = "leg" + std::to_string(i + 1);
    const int lower = static_cast<int>(mechanism.bodies.size());
    mechanism.bodies.insert(mechanism.bodies.end(), {leg + ".lower", leg + ".upper"});
    mechanism.joints.push_back(
        joint_of(leg + ".base", JointType::revolute, 0, lower, h1 * out, tangent));
    Joint slide = joint_of(leg + ".strut", JointType::prismatic, lower, lower + 1, h1 * out, along);
    slide.driven = {0};
    mechanism.joints.push_back(slide);
    const Vector3 ball = h1 * out + length * along;
    mechanism.joints.push_back(
        joint_of(leg + ".platform", JointType::spherical, lower + 1, 1, ball));
    tool += ball / 3;
  }
  mechanism.tool = tool;
  return {prepare(mechanism), drives};
}

TEST(AssemblyModes, ThreeRpsHasSixteen) {
  const json data = cases().at("3RPS_symmetric");
  const Case problem = three_rps(data);
  const auto start = std::chrono::steady_clock::now();
  const AssemblyModes dut = find_assembly_modes(problem.machine, problem.drives);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("3-rps: %zu modes, %d starts, rarest %d, unseen %.2g, %.3f s\n", dut.solutions.size(),
              dut.completeness.starts, dut.completeness.rarest_hits, dut.completeness.unseen,
              seconds);
  EXPECT_EQ(dut.solutions.size(), data.at("count_real").get<std::size_t>());
  expect_all_certified(dut);
}

Case planar_three_rpr(const json& data) {
  const json& at = data.at("solutions_x_y_phi").at(0);
  const Vector3 corner(at[0].get<double>(), at[1].get<double>(), 0);
  const double phi = at[2].get<double>();
  const double d12 = data.at("d12").get<double>(), d13 = data.at("d13").get<double>(),
               d23 = data.at("d23").get<double>();
  const double x3 = (d12 * d12 + d13 * d13 - d23 * d23) / (2 * d12);
  const std::vector<Vector3> points{Vector3::Zero(), Vector3(d12, 0, 0),
                                    Vector3(x3, std::sqrt(d13 * d13 - x3 * x3), 0)};
  Mechanism mechanism;
  mechanism.name = "3-rpr";
  mechanism.bodies = {"base", "platform"};
  mechanism.platform = 1;
  mechanism.tool = corner;
  Eigen::VectorXd drives(3);
  for (int i = 0; i < 3; ++i) {
    const Vector3 foot = vector_of(data.at("base")[i]);
    const Vector3 head =
        corner + Eigen::AngleAxisd(phi, Vector3::UnitZ()) * points[static_cast<std::size_t>(i)];
    const std::string leg = "leg" + std::to_string(i + 1);
    const int lower = static_cast<int>(mechanism.bodies.size());
    mechanism.bodies.insert(mechanism.bodies.end(), {leg + ".lower", leg + ".upper"});
    mechanism.joints.push_back(joint_of(leg + ".base", JointType::revolute, 0, lower, foot));
    Joint slide = joint_of(leg + ".strut", JointType::prismatic, lower, lower + 1, foot,
                           (head - foot).normalized());
    slide.driven = {0};
    mechanism.joints.push_back(slide);
    mechanism.joints.push_back(
        joint_of(leg + ".platform", JointType::revolute, lower + 1, 1, head));
    drives[i] = data.at("rho")[i].get<double>() - (head - foot).norm();
  }
  return {prepare(mechanism), drives};
}

TEST(AssemblyModes, PlanarThreeRprHasSix) {
  const json data = cases().at("planar_3RPR_innocenti_merlet");
  const Case problem = planar_three_rpr(data);
  const auto start = std::chrono::steady_clock::now();
  const AssemblyModes dut = find_assembly_modes(problem.machine, problem.drives);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("3-rpr: %zu modes, %d starts, rarest %d, unseen %.2g, %.3f s\n", dut.solutions.size(),
              dut.completeness.starts, dut.completeness.rarest_hits, dut.completeness.unseen,
              seconds);
  EXPECT_EQ(dut.solutions.size(), data.at("count_real").get<std::size_t>());
  expect_all_certified(dut);
  const json& all = data.at("solutions_x_y_phi");
  for (const json& one : all) {
    const Vector3 shift = Vector3(one[0].get<double>(), one[1].get<double>(), 0) -
                          Vector3(all[0][0].get<double>(), all[0][1].get<double>(), 0);
    EXPECT_TRUE(std::any_of(dut.solutions.begin(), dut.solutions.end(), [&](const auto& mode) {
      return (mode.pose.position - shift).norm() < 1e-5;
    })) << shift.transpose();
  }
}

// Three legs of two hinges about axes through one point; solutions R of
// (Rot(u_i, θ_i) w_i)·(R v_i) = 0.
TEST(AssemblyModes, AgileEyeHasEight) {
  const json data = cases().at("agile_eye_theta_0_0_0");
  Mechanism mechanism;
  mechanism.name = "agile-eye";
  mechanism.bodies = {"base", "platform"};
  mechanism.platform = 1;
  mechanism.tool = Vector3(0, 0, 1);
  Transform first = Transform::Identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      first.linear()(i, j) = data.at("solutions_R").at(0).at(i).at(j).get<double>();
  first.linear() = first.linear().array().round().matrix();  // exact: -1, 0 or 1
  for (int i = 0; i < 3; ++i) {
    const std::string leg = "leg" + std::to_string(i + 1);
    const int link = static_cast<int>(mechanism.bodies.size());
    mechanism.bodies.insert(mechanism.bodies.end(), {leg + ".crank", leg + ".link"});
    Joint drive = joint_of(leg + ".drive", JointType::revolute, 0, link, Vector3::Zero(),
                           vector_of(data.at("u")[i]));
    drive.driven = {0};
    mechanism.joints.push_back(drive);
    mechanism.joints.push_back(joint_of(leg + ".elbow", JointType::revolute, link, link + 1,
                                        Vector3::Zero(), vector_of(data.at("w_ref")[i])));
    mechanism.joints.push_back(joint_of(leg + ".end", JointType::revolute, link + 1, 1,
                                        Vector3::Zero(), first * vector_of(data.at("v_ref")[i])));
  }
  const Machine machine = prepare(mechanism);
  const AssemblyModes dut = find_assembly_modes(machine, Eigen::VectorXd::Zero(3));
  std::printf("agile eye: %zu modes, %d starts, rarest %d\n", dut.solutions.size(),
              dut.completeness.starts, dut.completeness.rarest_hits);
  int certified = 0, matched = 0;
  for (const json& one : data.at("solutions_R")) {
    Eigen::Matrix3d rotation;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) rotation(i, j) = one.at(i).at(j).get<double>();
    const Eigen::Quaterniond turn(Eigen::Matrix3d(rotation * first.linear().transpose()));
    for (const ForwardSolution& mode : dut.solutions) {
      if (mode.pose.rotation.angularDistance(turn) > 1e-5) continue;
      ++matched;
      certified += mode.certified;
    }
  }
  EXPECT_EQ(matched, 8);
  EXPECT_GE(certified, 4);
}

TEST(AssemblyModes, ALinearDeltaHasTwo) {
  const json values = cases().at("linear_delta_FK").at("values");
  const double e = values.at("e").get<double>(), rod = values.at("L").get<double>();
  const double rise = std::sqrt(rod * rod - e * e);
  const Machine machine = prepare(linear_delta(e, rod, 10, 0), task_of({0, 1, 2}));
  Eigen::VectorXd drives(3);
  for (int i = 0; i < 3; ++i) drives[i] = values.at("q")[i].get<double>() - rise;
  const AssemblyModes dut = find_assembly_modes(machine, drives);
  ASSERT_EQ(dut.solutions.size(), 2u);
  expect_all_certified(dut);
  EXPECT_TRUE(dut.completeness.complete);
  EXPECT_NE(dut.solutions[0].region, dut.solutions[1].region);
  for (const json& one : values.at("solutions"))
    EXPECT_TRUE(std::any_of(dut.solutions.begin(), dut.solutions.end(), [&](const auto& mode) {
      return (mode.pose.position - vector_of(one)).norm() < 1e-12;
    }));
}

TEST(AssemblyModes, ASingularModeIsNotCertified) {
  // Struts that all lie in the plane of the platform joints leave it free to turn.
  std::vector<std::pair<Vector3, Vector3>> limbs;
  for (int i = 0; i < 6; ++i) {
    const double a = i * M_PI / 3;
    limbs.emplace_back(2 * Vector3(std::cos(a + 0.3), std::sin(a + 0.3), 0),
                       Vector3(std::cos(a), std::sin(a), 0));
  }
  const Machine plane = prepare(strutted(limbs), task_of({0, 1, 2, 3, 4, 5}));
  AssemblySearch search;
  search.starts = 500;
  const AssemblyModes dut = find_assembly_modes(plane, Eigen::VectorXd::Zero(6), search);
  const auto own = std::find_if(dut.solutions.begin(), dut.solutions.end(),
                                [](const ForwardSolution& mode) { return mode.home_mode; });
  ASSERT_NE(own, dut.solutions.end());
  EXPECT_FALSE(own->certified);
  EXPECT_FALSE(dut.completeness.complete);
}

TEST(AssemblyModes, DrivesThatDoNotHoldThePlatformAreNamed) {
  const AssemblyModes dut =
      find_assembly_modes(catalog_machine("table1-2"), Eigen::Vector4d(1e-3, 0, 0, 0));
  EXPECT_NE(dut.completeness.stopped.find("do not hold the platform"), std::string::npos);
  EXPECT_FALSE(dut.completeness.complete);
  for (const ForwardSolution& mode : dut.solutions) EXPECT_FALSE(mode.certified);
}

TEST(AssemblyModes, RefuseDrivesThatAreNoNumbers) {
  const Machine machine = prepare(linear_delta(0.3, 1, 2, 0), task_of({0, 1, 2}));
  EXPECT_THROW(static_cast<void>(find_assembly_modes(machine, Eigen::VectorXd::Zero(2))),
               std::invalid_argument);
  EXPECT_THROW(
      static_cast<void>(find_assembly_modes(machine, Eigen::VectorXd::Constant(3, std::nan("")))),
      std::invalid_argument);
  // Out of reach: none, and that is an answer.
  EXPECT_TRUE(find_assembly_modes(machine, Eigen::Vector3d(0, 9, -9)).solutions.empty());
}

}  // namespace
}  // namespace polyglide
