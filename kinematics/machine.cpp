#include <algorithm>

#include "kinematics/mobility.hpp"
#include "kinematics/motion.hpp"
#include "kinematics/planar.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {
namespace {

/// Planar machines of two freedoms, such as five-bars, are commanded by where the tool is, if that
/// takes both; how the platform turns follows. Others keep their axes.
TaskSpace by_tool_position(const Model& model, const TaskSpace& task) {
  constexpr double kAlong = 1e-9, kIndependent = 1e-3;
  const auto normal = plane_of_motion(model.mechanism);
  if (!normal || task.axes.size() != 2 || task.rotations != 1) return task;
  TaskSpace tool = task;
  tool.axes.clear();
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs((*normal)[axis]) < kAlong) tool.axes.push_back(axis);
  if (tool.axes.size() != 2) return task;
  const Eigen::MatrixXd rates =
      freedoms_at(model, home(model)).platform.bottomRows<3>()(tool.axes, Eigen::all);
  const Eigen::VectorXd values = singular_values(rates);
  if (!(values.size() == 2 && values[1] > kIndependent * values[0])) return task;
  tool.translations = 2;
  tool.rotations = 0;
  tool.rotation_axis.setZero();
  tool.pure = false;
  return tool;
}

/// Where the platform's motion at home is as rich as elsewhere but some of the axes chosen at a
/// generic posture stand still there (the coupler of a four-bar whose crank and rocker are parallel
/// does not turn), such axes cannot command what happens about home: others are chosen, which span
/// the largest part of the motion at home, rotations counting as the way at the characteristic
/// length.
TaskSpace by_motion_at_home(const Model& model, const TaskSpace& task) {
  constexpr double kStandsStill = 1e-6;
  const Freedoms freedoms = freedoms_at(model, home(model));
  const auto count = static_cast<Eigen::Index>(task.axes.size());
  if (count == 0 || freedoms.platform_rank.rank != count) return task;
  Eigen::MatrixXd twists(6, freedoms.platform.cols());
  twists << freedoms.platform.bottomRows<3>() * model.size,
      freedoms.platform.topRows<3>() * characteristic_length(model);
  const Eigen::MatrixXd motion = svd_of(twists).u.leftCols(count);
  if (singular_values(motion(task.axes, Eigen::all))[count - 1] > kStandsStill) return task;
  TaskSpace other = task;
  other.axes = independent_rows(motion, count);
  other.translations =
      static_cast<int>(std::ranges::count_if(other.axes, [](int axis) { return axis < 3; }));
  other.rotations = static_cast<int>(count) - other.translations;
  other.rotation_axis.setZero();
  other.pure = false;
  return other;
}

}  // namespace

Machine prepare(const Mechanism& mechanism) {
  MobilityOptions options;
  options.walks = 2;
  options.evidence = false;
  const Model model = compile(mechanism);
  const TaskSpace task = by_motion_at_home(model, analyse_mobility(model, options).task);
  return prepare(mechanism, by_tool_position(model, task));
}

Machine prepare(const Mechanism& mechanism, const TaskSpace& task) {
  Machine machine;
  machine.model = compile(mechanism);
  machine.task = task;
  machine.task.characteristic_length = characteristic_length(machine.model);
  machine.legs = recognise_legs(machine.model);
  return machine;
}

}  // namespace polyglide
