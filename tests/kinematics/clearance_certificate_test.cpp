#include <gtest/gtest.h>

#include "kinematics/certify.hpp"
#include "late_limits.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

/// Verdicts of small boxes against poses sampled in them.
void expect_honest_certificates(const Machine& machine, double reach, double edge, double tilt) {
  const Evaluator evaluator(machine);
  Uniform random;
  int certified = 0, failed = 0;
  for (int round = 0; round < 60; ++round) {
    const PoseRegion region{Vector3::Constant(edge), reach * random.vector(), tilt, 0};
    const BoxCertificate found = certify_box(machine, region, {}, 20000);
    if (found.verdict == CertifyVerdict::fails && found.limit.starts_with("clearance")) {
      EXPECT_EQ(solve_inverse(machine, *found.at).limit.substr(0, 9), "clearance");
      ++failed;
    }
    if (found.verdict != CertifyVerdict::certified) continue;
    ++certified;
    PoseBatch poses = some_poses(machine, edge / 2, tilt, 300);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses.x[i] += region.centre.x();
      poses.y[i] += region.centre.y();
      poses.z[i] += region.centre.z();
    }
    BatchResult result;
    evaluator.evaluate(poses, result);
    for (std::size_t i = 0; i < poses.size(); ++i) ASSERT_LT(result.limit[i], 0) << round;
  }
  EXPECT_GT(certified, 5);
  EXPECT_GT(failed, 5);
}

TEST(ClearanceCertificates, AreHonestForRodsRailsAndPlates) {
  expect_honest_certificates(with("delta-1", R"({
    "shapes": [{"of": "leg*.rod_*", "diameter": 12, "trim": 20}, {"of": "leg*.guide", "diameter": 60},
               {"of": "platform", "diameter": 26}],
    "limits": [{"name": "apart", "clearance": 20},
               {"name": "plate", "clearance": 0, "between": ["leg", "platform"], "joined": true}]})"),
                             0.12, 0.02, 0);
}

TEST(ClearanceCertificates, AreHonestForTelescopesOfATurnedPlatform) {
  expect_honest_certificates(with("hexapod-6ups", R"({
    "shapes": [{"of": "strut*.strut", "diameter": 40, "trim": 60}],
    "limits": [{"name": "apart", "clearance": 302}]})"),
                             0.2, 0.01, 0.01);
}

TEST(ClearanceCertificates, AreHonestForCranks) {
  expect_honest_certificates(with("delta", R"({
    "shapes": [{"of": "leg*.arm", "diameter": 50}, {"of": "leg*.rod_*", "diameter": 12, "trim": 30},
               {"of": "platform", "diameter": 26}],
    "limits": [{"name": "apart", "clearance": 45},
               {"name": "plate", "clearance": 500, "between": ["leg*.arm", "platform"]}]})"),
                             0.25, 0.02, 0);
}

TEST(ClearanceCertificates, SayWhatTheyCannotEnclose) {
  const Machine machine = with("delta-1", R"({"limits": [
    {"name": "low", "expression": "z", "max": 1000}]})");
  const BoxCertificate found =
      certify_box(machine, {Vector3::Constant(0.01), Vector3::Zero(), 0, 0});
  EXPECT_EQ(found.verdict, CertifyVerdict::undecided);
  EXPECT_EQ(found.reason, "the expression of limit \"low\" cannot be enclosed by intervals");
  EXPECT_EQ(certify_box(machine, {Vector3::Constant(0.01), Vector3::Zero(), 0, 0}, {"low"}).verdict,
            CertifyVerdict::certified);
}

}  // namespace
}  // namespace polyglide
