#include "kinematics/mobility.hpp"
#include "kinematics/motion.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {

Machine prepare(const Mechanism& mechanism) {
  MobilityOptions options;
  options.walks = 2;
  options.evidence = false;
  return prepare(mechanism, analyse_mobility(compile(mechanism), options).task);
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
