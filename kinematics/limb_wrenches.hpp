#pragma once

#include <string>
#include <vector>

#include "kinematics/model.hpp"

namespace polyglide {

/// What one limb does to the platform at home.
struct LimbWrenches {
  std::string name;                 ///< what its joints' names begin with, else its first joint
  std::vector<std::string> joints;  ///< in the order of the file
  int connectivity = 0;             ///< freedoms it leaves the platform
  std::vector<Screw> constraints;   ///< [f; n about the base origin] it always bears
  std::vector<Screw> actuations;    ///< those it bears besides when its drives are held
};

/// The limbs of a mechanism, what holds the platform to the base when both are
/// taken as fixed points of the joint graph: joints that share a body other than these two
/// belong to one limb, whatever loops or further limbs lie inside.
/// A limb's constraint wrenches are reciprocal to all twists it leaves the platform.
/// Cost: about 30 µs a limb.
/// Source: Huang, Li, Ding 2013, Theory of parallel mechanisms, constraint-synthesis method.
[[nodiscard]] std::vector<LimbWrenches> limb_wrenches(const Mechanism& mechanism);

}  // namespace polyglide
