#include "catalog/spanning_tree.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>

#include "catalog/catalog.hpp"
#include "catalog/elementary_motion.hpp"

namespace polyglide {
namespace {

TEST(SpanningTree, AFourBarIsAChainClosedAtItsLastJoint) {
  const Mechanism mechanism = expand(find_layout("four-bar"));
  const SpanningTree tree = spanning_tree(mechanism);
  ASSERT_EQ(tree.loop_joints, std::vector<int>{3});
  EXPECT_EQ(mechanism.joints[3].name, "d");
  for (int body : tree.body_order) {
    if (body == mechanism.base) continue;
    EXPECT_EQ(parent_body(mechanism, tree, body),
              mechanism.joints[tree.parent_joint[body]].bodies[0]);
  }
}

TEST(SpanningTree, LoopsAreClosedByPassiveBallsWhereThereAreSome) {
  const Mechanism mechanism = expand(find_layout("hexapod-6ups"));
  const SpanningTree tree = spanning_tree(mechanism);
  EXPECT_EQ(tree.loop_joints.size(), 5u);
  for (int joint : tree.loop_joints)
    EXPECT_EQ(mechanism.joints[joint].type, JointType::spherical) << mechanism.joints[joint].name;
}

TEST(SpanningTree, ReachesEveryBodyOfEveryCatalogEntryOnceFromTheBaseOutwards) {
  for (const std::string& name : catalog_names()) {
    SCOPED_TRACE(name);
    const Mechanism mechanism = expand(find_layout(name));
    const SpanningTree tree = spanning_tree(mechanism);
    EXPECT_EQ(tree.body_order.size(), mechanism.bodies.size());
    EXPECT_EQ(tree.loop_joints.size() + mechanism.bodies.size(), mechanism.joints.size() + 1);
    std::vector<bool> reached(mechanism.bodies.size(), false);
    for (int body : tree.body_order) {
      EXPECT_FALSE(reached[body]);
      reached[body] = true;
      const int parent = parent_body(mechanism, tree, body);
      EXPECT_TRUE(body == mechanism.base ? parent == -1 : reached[parent]);
    }
    for (int joint : tree.loop_joints)
      EXPECT_EQ(std::count(tree.parent_joint.begin(), tree.parent_joint.end(), joint), 0);
  }
}

TEST(SpanningTree, TheBaseAloneHasNoJoints) {
  Mechanism mechanism;
  mechanism.bodies = {"base"};
  const SpanningTree tree = spanning_tree(mechanism);
  EXPECT_EQ(tree.body_order, std::vector<int>{0});
  EXPECT_TRUE(tree.loop_joints.empty());
}

TEST(SpanningTree, ABodyOutOfReachIsNamed) {
  Mechanism mechanism;
  mechanism.bodies = {"base", "island"};
  try {
    (void)spanning_tree(mechanism);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("\"island\" is not connected"), std::string::npos);
  }
}

TEST(ElementaryMotions, AreAsManyAndOfTheKindThatTheJointHas) {
  Joint joint;
  joint.axes[0] = Vector3(1, 2, -3).normalized();
  joint.pitch = 0.5;
  for (const std::string& word : joint_words()) {
    SCOPED_TRACE(word);
    joint.type = *joint_type(word);
    const auto motions = elementary_motions(joint);
    ASSERT_EQ(static_cast<int>(motions.size()), freedoms(joint.type));
    for (std::size_t i = 0; i < motions.size(); ++i) {
      EXPECT_EQ(motions[i].translation, is_translation(joint.type, static_cast<int>(i)));
      EXPECT_EQ(motions[i].pitch, joint.type == JointType::helical ? 0.5 : 0);
      EXPECT_NEAR(motions[i].axis.norm(), 1, 1e-15);
    }
  }
}

TEST(ElementaryMotions, OfAPlanarJointAreARightHandedFrame) {
  Joint joint;
  joint.type = JointType::planar;
  for (const Vector3& normal : {Vector3(0, 0, 1), Vector3(-1, 0, 0), Vector3(0.6, 0, -0.8)}) {
    joint.axes[0] = normal;
    const auto motions = elementary_motions(joint);
    EXPECT_TRUE(motions[0].axis.cross(motions[1].axis).isApprox(normal, 1e-15));
    EXPECT_EQ(motions[2].axis, normal);
  }
}

}  // namespace
}  // namespace polyglide
