#pragma once

#include <optional>
#include <string>
#include <vector>

#include "optimizer/tune.hpp"
#include "synthesis/enumerate.hpp"

namespace polyglide {

/// A candidate that can do what is asked, ready to be measured.
struct Eligible {
  const Candidate* candidate = nullptr;
  Layout layout;
  TaskSpace task;
};

/// Candidates with the same kinematics, so that one is tuned for all: they differ in
/// joints that move alike, such as a rod's universal and spherical ends exchanged.
struct Family {
  const Candidate* lead =
      nullptr;  ///< a known layout where there is one, else the first of the space
  std::vector<const Candidate*> members;
  Layout layout;  ///< of the lead
  TaskSpace task;
  Design look;                 ///< dimensions of the file
  std::optional<Tuned> tuned;  ///< only the most promising are

  [[nodiscard]] std::string known_as() const { return lead->known_as; }
};

/// All that inverse kinematics and limits depend on, as text: legs, cones, limits of
/// the file, tool and task space, at the dimensions of the file and at another set; equal
/// for twins. Machines without closed-form legs have none ("").
[[nodiscard]] std::string kinematic_signature(const Eligible& eligible);

/// Puts twins together, in the order of the space.
[[nodiscard]] std::vector<Family> group_twins(std::vector<Eligible> eligible);

}  // namespace polyglide
