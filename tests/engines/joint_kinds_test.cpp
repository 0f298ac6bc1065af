// Joints of every kind in seeded mixtures, sizes and names put before the engines, and proof
// that the engines would notice a mistake.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>

#include "catalog/catalog.hpp"
#include "catalog/write_mjcf.hpp"
#include "catalog/write_urdf.hpp"
#include "engines/mujoco_oracle.hpp"
#include "engines/oracles.hpp"
#include "engines/uniform.hpp"

namespace polyglide::engines {
namespace {

Joint random_joint(Uniform& uniform, int number, int first, int second) {
  Joint joint;
  joint.name = "joint" + std::to_string(number);
  joint.type = *joint_type(joint_words()[uniform.below(8)]);
  joint.bodies = {first, second};
  if (uniform() < 0) std::swap(joint.bodies[0], joint.bodies[1]);
  joint.at = uniform.vector();
  joint.axes = {uniform.vector().normalized(), uniform.vector().normalized()};
  if (joint.type == JointType::helical) joint.pitch = 0.3;
  const int count = freedoms(joint.type);
  if (count > 0 && uniform() < -0.3) joint.driven = {uniform.below(count)};
  return joint;
}

/// Two random loops through one body, of joints of every kind, pointing either way.
Mechanism random_mechanism(std::uint64_t seed) {
  Uniform uniform(seed);
  for (int i = 0; i < 10; ++i) uniform();
  Mechanism mechanism;
  mechanism.name = "random";
  mechanism.tool = uniform.vector();
  const auto chain = [&](int from, int to, int links) {
    for (int i = 0; i <= links; ++i) {
      int next = to;
      if (i < links) {
        next = static_cast<int>(mechanism.bodies.size());
        mechanism.bodies.push_back("body" + std::to_string(next));
      }
      mechanism.joints.push_back(
          random_joint(uniform, static_cast<int>(mechanism.joints.size()) + 1, from, next));
      from = next;
    }
  };
  mechanism.bodies = {"base", "platform"};
  mechanism.platform = 1;
  for (int limb = 0; limb < 3; ++limb) chain(0, 1, 2 + uniform.below(3));
  return mechanism;
}

TEST(JointKinds, AnyMixtureOfThemEitherWayRoundAgrees) {
  std::map<JointType, int> closing;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    const Model model = compile(random_mechanism(seed));
    for (int joint : model.loop_joints) ++closing[model.mechanism.joints[joint].type];
    const Counts ours = counts_of(model);
    expect_closed_and_equal(mujoco_counts(model), ours);
    expect_closed_and_equal(simbody_counts(model), ours);
    expect_closed_and_equal(urdf_counts(model), ours);
    Posture posture = home(model);
    if (walk(model, posture)) (void)expect_agreement_at(model, posture);
  }
  EXPECT_GE(closing.size(), 5u) << "few kinds of joints have closed a loop";
}

TEST(JointKinds, EachClosesALoop) {
  for (const std::string& word : joint_words()) {
    SCOPED_TRACE(word);
    Mechanism mechanism = random_mechanism(3);
    // All drives and one-freedom joints but one, which therefore closes the only loop.
    mechanism.joints.clear();
    mechanism.bodies = {"base", "a", "platform", "b"};
    mechanism.platform = 2;
    Uniform uniform(11);
    for (int i = 0; i < 4; ++i) {
      Joint joint = random_joint(uniform, i + 1, i, (i + 1) % 4);
      joint.type = i == 2 ? *joint_type(word) : JointType::cylindrical;
      joint.driven.clear();
      if (i != 2) joint.driven = {0};
      joint.pitch = 0.2;
      mechanism.joints.push_back(joint);
    }
    const Model model = compile(mechanism);
    ASSERT_EQ(model.loop_joints, std::vector<int>{2});
    const Counts ours = counts_of(model);
    EXPECT_EQ(ours.mobility, std::max(0, freedoms(*joint_type(word))));
    expect_closed_and_equal(mujoco_counts(model), ours);
    expect_closed_and_equal(simbody_counts(model), ours);
    expect_closed_and_equal(urdf_counts(model), ours);
  }
}

// The oracles are not blind: what is open is seen, and so is a constraint that no longer repeats
// another.
TEST(Oracles, AMicroradianOfOneJointOpensALoop) {
  const Model model = compile(expand(find_layout("four-bar")));
  MujocoModel mujoco(to_mjcf(model.mechanism));
  mujoco.set("a", {1e-6});
  const double residual = counts_of(mujoco.constraints(), model.size).residual;
  EXPECT_GT(residual, 1e-7);
  EXPECT_LT(residual, 1e-5);
}

TEST(Oracles, AThousandthOfARadianCostsBennettHisFreedom) {
  Mechanism mechanism = expand(find_layout("bennett"));
  EXPECT_EQ(mujoco_counts(compile(mechanism)).mobility, 1);
  Vector3& axis = mechanism.joints[0].axes[0];
  axis = (axis + 1e-3 * axis.unitOrthogonal()).normalized();
  const Model model = compile(mechanism);
  EXPECT_EQ(mujoco_counts(model).mobility, 0);
  EXPECT_EQ(simbody_counts(model).mobility, 0);
  EXPECT_EQ(urdf_counts(model).mobility, 0);
}

TEST(Exports, CountTheSameInAnySize) {
  for (const double factor : {1e-3, 1e3}) {
    SCOPED_TRACE(factor);
    Mechanism mechanism = expand(find_layout("table1-6"));
    mechanism.tool *= factor;
    for (Joint& joint : mechanism.joints) {
      joint.at *= factor;
      joint.range.clear();
    }
    const Model model = compile(mechanism);
    const Counts ours = counts_of(model);
    expect_closed_and_equal(mujoco_counts(model), ours);
    expect_closed_and_equal(urdf_counts(model), ours);
  }
}

TEST(Exports, LoadWhateverBodiesAndJointsAreCalled) {
  Mechanism mechanism = expand(find_layout("four-bar"));
  mechanism.name = "<\"four\" & 'bar'>";
  mechanism.title = "a -- b -->";
  mechanism.bodies = {"world", "a <&> \"b\"\n", "tool", "d.cut"};
  const Model model = compile(mechanism);
  expect_closed_and_equal(mujoco_counts(model), counts_of(model));
  EXPECT_EQ(MujocoModel(to_urdf(mechanism).urdf).velocities(), 4);
}

}  // namespace
}  // namespace polyglide::engines
