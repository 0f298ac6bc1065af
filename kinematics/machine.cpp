#include "kinematics/mobility.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {

Machine prepare(const Mechanism& mechanism) {
  Machine machine;
  machine.model = compile(mechanism);
  MobilityOptions options;
  options.walks = 2;
  options.evidence = false;
  machine.task = analyse_mobility(machine.model, options).task;
  machine.legs = recognise_legs(machine.model);
  return machine;
}

}  // namespace polyglide
