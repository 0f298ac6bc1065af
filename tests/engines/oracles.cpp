#include "engines/oracles.hpp"

#include <gtest/gtest.h>

#include "catalog/elementary_motion.hpp"
#include "catalog/engine_tree.hpp"
#include "catalog/write_mjcf.hpp"
#include "engines/mujoco_oracle.hpp"
#include "engines/simbody_oracle.hpp"
#include "engines/uniform.hpp"
#include "engines/urdf_loops.hpp"
#include "kinematics/manifold.hpp"
#include "kinematics/rank.hpp"

namespace polyglide::engines {
namespace {

std::array<double, 3> plain(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

/// In units of the machine's size, about its centre: without dimensions for Simbody.
PlainMechanism plain(const Model& model) {
  const Mechanism& mechanism = model.mechanism;
  const auto scaled = [&](const Vector3& point) {
    return plain((point - model.centre) / model.size);
  };
  PlainMechanism result{static_cast<int>(mechanism.bodies.size()),
                        mechanism.base,
                        mechanism.platform,
                        scaled(mechanism.tool),
                        {}};
  for (const Joint& joint : mechanism.joints) {
    PlainJoint copy;
    copy.kind = to_string(joint.type);
    copy.first = joint.bodies[0];
    copy.second = joint.bodies[1];
    copy.at = scaled(joint.at);
    copy.axis = plain(joint.axes[0]);
    copy.other =
        plain(joint.type == JointType::planar ? elementary_motions(joint)[0].axis : joint.axes[1]);
    copy.pitch = joint.pitch / model.size;
    copy.driven = joint.driven;
    result.joints.push_back(copy);
  }
  return result;
}

/// Sets MuJoCo's joints as ours stand; loops closed by `connect` have no coordinates.
void pose(MujocoModel& mujoco, const Model& model, const Posture& posture) {
  for (const EngineLink& link : engine_tree(model.mechanism).links) {
    if (link.joint < 0) continue;
    const Joint& joint = model.mechanism.joints[link.joint];
    const int first = model.first_freedom[link.joint];
    if (joint.type == JointType::spherical) {
      Eigen::Quaterniond turn = posture.balls[link.joint];
      if (link.body == joint.bodies[0]) turn = turn.conjugate();
      mujoco.set(joint.name, {turn.w(), turn.x(), turn.y(), turn.z()});
      continue;
    }
    for (const EngineMotion& motion : link.motions) {
      const double q = posture.q[first + motion.freedom];
      mujoco.set(freedom_name(joint, motion.freedom), {q});
      if (motion.motion.pitch != 0) mujoco.set(joint.name + ".advance", {q * motion.motion.pitch});
    }
  }
}

}  // namespace

bool walk(const Model& model, Posture& posture) {
  const std::vector<int> active = all_freedoms(model);
  Uniform uniform(7);
  Eigen::VectorXd direction(static_cast<Eigen::Index>(active.size()));
  for (double& entry : direction) entry = uniform();
  for (int step = 0; step < 4; ++step) {
    const Eigen::VectorXd along = tangent(model, posture, active, direction);
    if (along.isZero() || !step_along(model, posture, active, along, 0.1).closed) break;
  }
  return displacement(model, home(model), posture) > 0.01;
}

Counts mujoco_counts(const Model& model) {
  MujocoModel mujoco(to_mjcf(model.mechanism));
  const ConstraintSystem system = mujoco.constraints();
  EXPECT_EQ(system.rows, mujoco.expected_rows()) << "an equality is not active";
  return counts_of(system, model.size);
}

Counts urdf_counts(const Model& model) {
  const Mechanism& mechanism = model.mechanism;
  return counts_of(UrdfLoops(to_urdf(mechanism)).system(mechanism.bodies[mechanism.platform]),
                   model.size);
}

Counts simbody_counts(const Model& model) { return counts_of(simbody_at_home(plain(model)), 1); }

void expect_closed_and_equal(const Counts& found, const Counts& ours) {
  EXPECT_LT(found.residual, 1e-9);
  EXPECT_EQ(found, ours);
}

Counts mujoco_counts_at(const Model& model, const Posture& posture) {
  MujocoModel mujoco(to_mjcf(model.mechanism));
  pose(mujoco, model, posture);
  return counts_of(mujoco.constraints(), model.size);
}

Counts expect_agreement_at(const Model& model, const Posture& posture) {
  const Counts found = mujoco_counts_at(model, posture);
  EXPECT_LT(found.residual, 1e-9);
  const Eigen::MatrixXd jacobian = closure_jacobian(model, posture);
  EXPECT_EQ(found.mobility, kernel_of(jacobian).basis.cols());
  EXPECT_EQ(found.held_mobility,
            kernel_of(columns(jacobian, passive_freedoms(model))).basis.cols());
  return found;
}

}  // namespace polyglide::engines
