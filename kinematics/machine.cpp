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

}  // namespace

Machine prepare(const Mechanism& mechanism) {
  MobilityOptions options;
  options.walks = 2;
  options.evidence = false;
  const Model model = compile(mechanism);
  return prepare(mechanism, by_tool_position(model, analyse_mobility(model, options).task));
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
