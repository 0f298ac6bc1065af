#pragma once

#include <string>
#include <vector>

#include "kinematics/model.hpp"

namespace polyglide {

/// What one limb does at home to the body it carries.
struct LimbWrenches {
  std::string name;                 ///< `limb_names` of its joints
  std::vector<std::string> joints;  ///< in the order of the file
  int from = 0, to = 0;             ///< bodies it joins: base and platform, or those of a stage
  int connectivity = 0;             ///< freedoms it leaves `to` against `from`
  std::vector<Screw> constraints;   ///< [f; n about the base origin] it always bears
  std::vector<Screw> actuations;    ///< those it bears besides when its drives are held
};

/// What joints' names begin with before their last dot, each once: "leg1" of leg1.base and
/// leg1.strut, "leg1–leg2–hinge" of leg1.base, leg2.base and hinge.
[[nodiscard]] std::string limb_names(const std::vector<std::string>& joints);

/// The limbs of a mechanism. Where a body other than base and platform alone joins two parts of it
/// (hybrids), each part is a stage with limbs of its own. Within a stage a limb is what
/// holds its last body to its first when both are taken as fixed points of the joint graph:
/// joints that share any other body belong to one limb, whatever loops lie inside.
/// A limb's constraint wrenches are reciprocal to all twists it leaves the platform.
/// Cost: about 30 µs a limb.
/// Source: Huang, Li, Ding 2013, Theory of parallel mechanisms, constraint-synthesis method.
[[nodiscard]] std::vector<LimbWrenches> limb_wrenches(const Mechanism& mechanism);

}  // namespace polyglide
