#pragma once

#include <gtest/gtest.h>

#include "catalog/json_file.hpp"
#include "kinematics/evaluate.hpp"
#include "kinematics/limits.hpp"
#include "machines.hpp"

// Machines with clearances and expressions, and poses to try them at.
namespace polyglide::fixtures {

/// A layout of the catalog with shapes and limits put in.
inline Machine with(const std::string& name, const char* additions) {
  nlohmann::json document = find_layout(name).document;
  const auto added = nlohmann::json::parse(additions);
  for (const char* key : {"shapes", "limits"})
    for (const auto& value : added.value(key, nlohmann::json::array()))
      document[key].push_back(value);
  return prepare(expand(parse_layout(document, "f")));
}

/// Random poses about home; turned where the machine can turn.
inline PoseBatch some_poses(const Machine& machine, double reach, double tilt, int count) {
  Uniform random;
  PoseBatch poses;
  poses.wanted = Wanted::condition | Wanted::drives;
  const auto has = [&](int axis) { return std::ranges::count(machine.task.axes, axis) > 0; };
  for (int i = 0; i < count; ++i) {
    poses.x.push_back(has(0) ? reach * random() : 0);
    poses.y.push_back(has(1) ? reach * random() : 0);
    poses.z.push_back(has(2) ? reach * random() : 0);
    if (machine.task.rotations > 0)
      for (int k = 0; k < 3; ++k) poses.angles[k].push_back(has(3 + k) ? tilt * random() : 0);
  }
  return poses;
}

/// Late limits of the closed form against bodies moved by the general solver.
inline void expect_same_as_general(const Machine& machine, double reach, double tilt) {
  const Evaluator evaluator(machine);
  ASSERT_TRUE(evaluator.closed_form());
  PoseBatch poses = some_poses(machine, reach, tilt, 300);
  const auto late = late_limit_names(machine.model.mechanism);
  int stopped = 0, reached = 0;
  for (const char* instructions : {"scalar", ""}) {
    poses.instructions = instructions;
    BatchResult result;
    evaluator.evaluate(poses, result);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const std::string name = result.limit[i] < 0 ? "" : evaluator.limit_names()[result.limit[i]];
      if (!name.empty() && std::ranges::count(late, name) == 0) continue;
      Posture posture = home(machine.model);
      ASSERT_TRUE(solve_inverse_general(machine, pose_at(poses, i), posture).reachable);
      EXPECT_EQ(broken_limit(machine.model, posture), name) << i;
      EXPECT_EQ(result.inverse_condition[i] == 0, !name.empty());
      ++(name.empty() ? reached : stopped);
    }
  }
  EXPECT_GT(stopped, 20);
  EXPECT_GT(reached, 20);
}

/// An almost Cartesian machine: the tool moves in a cube of 600 mm, a ball of 100 mm on the
/// platform meets a ball of 300 mm in the corner of the cube.
inline Mechanism balls(double clearance) {
  std::vector<HalfSpaceLimit::Plane> cube;
  for (int k = 0; k < 3; ++k)
    for (const double way : {-1.0, 1.0}) cube.push_back({way * Vector3::Unit(k), 0.3});
  Mechanism mechanism = orthoglide(50);
  mechanism.limits.push_back({"cube", 1, {Vector3::Zero()}, cube});
  BodyShape ball;
  ball.name = "platform";
  ball.points = {{1, Vector3::Zero()}};
  ball.radius = 0.05;
  mechanism.shapes.push_back(ball);
  ball.name = "base";
  ball.points = {{0, Vector3::Constant(0.3)}};
  ball.radius = 0.15;
  mechanism.shapes.push_back(ball);
  mechanism.clearances.push_back({"balls", clearance, {}, false, {{0, 1}}});
  return mechanism;
}

}  // namespace polyglide::fixtures
