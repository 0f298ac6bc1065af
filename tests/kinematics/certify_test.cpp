#include "kinematics/certify.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "kinematics/evaluate.hpp"
#include "random_machine.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

PoseRegion region_of(const Vector3& size, const Vector3& centre, double tilt = 0,
                     double condition = 0) {
  return {size, centre, tilt, condition};
}

// Orthoglide (Chablat, Wenger 2003): in the cube from -L/√6 to L/√18 the velocity amplification is
// between 1/2 and 2, so κ <= 4; both bounds are attained in the corners.
TEST(CertifyBox, TheOrthoglidesCubeIsAsConditionedAsPublished) {
  const double from = -1 / std::sqrt(6.0), to = 1 / std::sqrt(18.0);
  const Machine machine = prepare(orthoglide(1), task_of({0, 1, 2}));
  const Vector3 centre = Vector3::Constant((from + to) / 2);
  const Vector3 inside = Vector3::Constant(0.98 * (to - from));
  const BoxCertificate good = certify_box(machine, region_of(inside, centre, 0, 4));
  EXPECT_EQ(good.verdict, CertifyVerdict::certified) << good.reason;
  EXPECT_EQ(good.proved, 1);
  EXPECT_LE(good.worst_condition, 4);
  const BoxCertificate bad = certify_box(machine, region_of(inside, centre, 0, 2));
  EXPECT_EQ(bad.verdict, CertifyVerdict::fails);
  EXPECT_EQ(bad.limit, "condition");
  ASSERT_TRUE(bad.at);
  const auto jacobian = [&] {
    Posture posture = home(machine.model);
    const Evaluator evaluator(machine);
    BatchResult result;
    PoseBatch batch;
    batch.x = {bad.at->position.x()};
    batch.y = {bad.at->position.y()};
    batch.z = {bad.at->position.z()};
    evaluator.evaluate(batch, result);
    return result.inverse_condition[0];
  }();
  EXPECT_LT(jacobian, 0.5);
}

TEST(CertifyBox, PrismsAreCertifiedUpToTheirFaces) {
  const Machine machine = block();
  const Vector3 size(0.4, 0.4, 0.2), centre(0.1, 0, 0.05);
  EXPECT_EQ(certify_box(machine, region_of(size, centre)).verdict, CertifyVerdict::certified);
  const BoxCertificate outside =
      certify_box(machine, region_of(size, centre + Vector3(0, 0.001, 0)));
  EXPECT_EQ(outside.verdict, CertifyVerdict::fails);
  EXPECT_EQ(outside.limit, "prism");
  EXPECT_GT(outside.at->position.y(), 0.2);
}

TEST(CertifyBox, WhatIsCertifiedHoldsAtEverySample) {
  Uniform uniform;
  int certified = 0, failed = 0;
  for (const char* name :
       {"delta-1", "tripod-70", "table1-6", "hexapod-6ups", "delta", "4-ruu", "hexa"}) {
    const Machine machine = catalog_machine(name);
    const Evaluator evaluator(machine);
    for (int i = 0; i < 6; ++i) {
      const double tilt = machine.task.rotations > 0 && i % 2 ? 0.05 : 0;
      const PoseRegion region = region_of(Vector3::Constant(0.06) + 0.04 * uniform.vector(),
                                          0.15 * uniform.vector(), tilt);
      const BoxCertificate dut = certify_box(machine, region, {}, 20000);
      certified += dut.verdict == CertifyVerdict::certified;
      failed += dut.verdict == CertifyVerdict::fails;
      Eigen::VectorXd drives;
      if (dut.verdict == CertifyVerdict::fails && dut.limit != "singularity") {
        ASSERT_TRUE(dut.at);
        EXPECT_GE(evaluator.inverse(*dut.at, drives), 0) << name << " " << dut.limit;
      }
      if (dut.verdict != CertifyVerdict::certified) continue;
      for (int sample = 0; sample < 200; ++sample) {
        Eigen::Matrix<double, 6, 1> at = Eigen::Matrix<double, 6, 1>::Zero();
        at.head<3>() = region.centre + region.size.cwiseProduct(uniform.vector()) / 2;
        for (int axis : machine.task.axes)
          if (axis > 2) at[axis] = tilt * uniform();
        EXPECT_LT(evaluator.inverse(pose_of(at), drives), 0) << name;
      }
    }
  }
  EXPECT_GT(certified, 3);
  EXPECT_GT(failed, 3);
}

// Angles of cranks jump from π to -π: ends beside the jump, on one side only, or none.
TEST(CertifyBox, CranksThatTurnFarAreJudgedAsTheEvaluatorDoes) {
  std::mt19937_64 random(7);
  Uniform uniform;
  const double none = std::numeric_limits<double>::infinity();
  int certified = 0, failed = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Machine machine = random_machine(random, DriveKind::crank);
    const double end = 2.2 + 0.9 * std::abs(uniform());
    for (Leg& leg : machine.legs->legs)
      leg.stroke = trial % 3 == 0   ? Range{-none, end}
                   : trial % 3 == 1 ? Range{-end, none}
                                    : Range{-0.3 - std::abs(uniform()), 3.1};
    std::vector<std::string> ignored;
    const Evaluator limited(machine);
    for (const std::string& name : limited.limit_names())
      if (name.starts_with("cone") || name == "plane") ignored.push_back(name);
    const Evaluator evaluator(machine, ignored);
    const PoseRegion region =
        region_of(Vector3::Constant(0.02 + 0.01 * uniform()), 0.3 * uniform.vector());
    const BoxCertificate dut = certify_box(machine, region, ignored, 3000);
    Eigen::VectorXd drives;
    if (dut.verdict == CertifyVerdict::fails && dut.limit != "singularity") {
      ++failed;
      EXPECT_GE(evaluator.inverse(*dut.at, drives), 0) << trial << " " << dut.limit;
    }
    if (dut.verdict != CertifyVerdict::certified) continue;
    ++certified;
    for (int sample = 0; sample < 200; ++sample) {
      Pose pose;
      pose.position = region.centre + region.size.cwiseProduct(uniform.vector()) / 2;
      EXPECT_LT(evaluator.inverse(pose, drives), 0) << trial;
    }
  }
  EXPECT_GT(certified, 20);
  EXPECT_GT(failed, 20);
}

TEST(CertifyBox, OutOfReachFailsAndSaysWhere) {
  const BoxCertificate dut =
      certify_box(catalog_machine("delta-1"), region_of(Vector3::Constant(0.01), Vector3(0, 0, 5)));
  EXPECT_EQ(dut.verdict, CertifyVerdict::fails);
  EXPECT_NE(dut.limit.find("stroke"), std::string::npos);
  EXPECT_NEAR(dut.at->position.z(), 5, 0.01);
  EXPECT_EQ(dut.proved, 0);
}

// An orthoglide is singular where the rods are parallel to a plane; beyond it det J has changed
// sign.
TEST(CertifyBox, ABoxAcrossASingularityIsNotCertified) {
  const Machine machine = prepare(orthoglide(1), task_of({0, 1, 2}));
  const BoxCertificate dut =
      certify_box(machine, region_of(Vector3::Constant(0.4), Vector3::Constant(-0.5)), {}, 20000);
  EXPECT_NE(dut.verdict, CertifyVerdict::certified);
  EXPECT_LT(dut.proved, 1);
  const BoxCertificate near =
      certify_box(machine, region_of(Vector3::Constant(0.4), Vector3::Zero()));
  EXPECT_EQ(near.verdict, CertifyVerdict::certified);
}

TEST(CertifyBox, ABudgetThatIsSpentSaysHowFarItGot) {
  const BoxCertificate dut =
      certify_box(catalog_machine("hexapod-6ups"),
                  region_of(Vector3::Constant(0.1), Vector3::Zero(), 0.08), {}, 100);
  EXPECT_EQ(dut.verdict, CertifyVerdict::undecided);
  EXPECT_LE(dut.boxes, 100);
  EXPECT_NE(dut.reason.find("budget"), std::string::npos);
  EXPECT_TRUE(dut.at);
}

TEST(CertifyBox, IsTheSameForAnyNumberOfThreads) {
  const Machine machine = catalog_machine("hexapod-6ups");
  const PoseRegion region = region_of(Vector3::Constant(0.05), Vector3::Zero(), 0.02);
  const BoxCertificate two = certify_box(machine, region);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const BoxCertificate alone = certify_box(machine, region);
  EXPECT_EQ(two.boxes, alone.boxes);
  EXPECT_EQ(two.worst_condition, alone.worst_condition);
}

TEST(CertifyBox, RefusesNonsenseAndAdmitsWhatItCannotDo) {
  const Machine machine = catalog_machine("delta-1");
  const auto refused = [&](const PoseRegion& region) {
    EXPECT_THROW(static_cast<void>(certify_box(machine, region)), std::invalid_argument);
  };
  refused(region_of(Vector3(-1, 1, 1), Vector3::Zero()));
  refused(region_of(Vector3(1, 1, std::nan("")), Vector3::Zero()));
  refused(region_of(Vector3::Ones(), Vector3::Zero(), 2));
  refused(region_of(Vector3::Ones(), Vector3::Zero(), 0, 0.5));
  EXPECT_EQ(
      certify_box(catalog_machine("3-rps"), region_of(Vector3::Ones(), Vector3::Zero())).verdict,
      CertifyVerdict::undecided);
  // A box of no size is one pose.
  EXPECT_EQ(certify_box(machine, {}).verdict, CertifyVerdict::certified);
}

// Without closed form. The drives of a 3-CPU are the coordinates of its tool.
TEST(CertifyBox, GoesAsFarAsTheStrokesOfDecoupledMachines) {
  for (const char* name : {"3-cpu", "tripteron"}) {
    const Machine machine = catalog_machine(name);
    const double stroke = name == std::string("3-cpu") ? 0.15 : 0.2;
    const BoxCertificate good = certify_box(machine, region_of(Vector3::Constant(0.1), {0, 0, 0}));
    EXPECT_EQ(good.verdict, CertifyVerdict::certified) << name << ": " << good.reason;
    const BoxCertificate bad =
        certify_box(machine, region_of(Vector3::Constant(0.04), Vector3(stroke, 0, 0)));
    EXPECT_EQ(bad.verdict, CertifyVerdict::fails) << name << ": " << bad.reason;
    EXPECT_EQ(bad.limit, "stroke x.joint1 max") << name;
    ASSERT_TRUE(bad.at);
    EXPECT_GT(bad.at->position.x(), stroke);
    const BoxCertificate near =
        certify_box(machine, region_of(Vector3::Constant(0.02), Vector3(stroke - 0.0101, 0, 0)));
    EXPECT_EQ(near.verdict, CertifyVerdict::certified) << name << ": " << near.reason;
  }
}

TEST(CertifyBox, WithoutClosedFormWhatIsCertifiedHoldsAtEverySample) {
  Uniform uniform;
  for (const char* name : {"3-rpc", "quadrupteron", "minimanipulator", "3-ppsp"}) {
    const Machine machine = catalog_machine(name);
    const Evaluator evaluator(machine);
    const double tilt = machine.task.rotations > 0 ? 0.01 : 0;
    const Vector3 size = Vector3::Constant(0.02 * machine.model.size);
    const BoxCertificate dut = certify_box(machine, region_of(size, Vector3::Zero(), tilt));
    EXPECT_EQ(dut.verdict, CertifyVerdict::certified) << name << ": " << dut.reason;
    for (int sample = 0; sample < 20; ++sample) {
      Eigen::Matrix<double, 6, 1> at = Eigen::Matrix<double, 6, 1>::Zero();
      at.head<3>() = size.cwiseProduct(uniform.vector()) / 2;
      for (int axis : machine.task.axes)
        if (axis > 2) at[axis] = tilt * uniform();
      Eigen::VectorXd drives;
      EXPECT_LT(evaluator.inverse(pose_of(at), drives), 0) << name;
    }
  }
}

TEST(CertifyBox, OutOfTheReachOfLimbsIsNotCertified) {
  const BoxCertificate dut =
      certify_box(catalog_machine("3-crr"), region_of(Vector3::Constant(0.01), Vector3(5, 5, 5)));
  EXPECT_EQ(dut.verdict, CertifyVerdict::fails);
  EXPECT_EQ(dut.limit, "reach");
  EXPECT_NEAR(dut.at->position.z(), 5, 0.01);
}

}  // namespace
}  // namespace polyglide
