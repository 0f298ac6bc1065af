#pragma once

#include "kinematics/mobility.hpp"
#include "kinematics/motion.hpp"

namespace polyglide {

/// What a mobility analysis has found when its evidence is gathered. Pointers may be null: the
/// mechanism does not move.
struct Findings {
  const Model& model;
  const Posture& home;
  const Freedoms &home_free, &home_locked;
  const Posture* generic;         ///< posture on the main branch
  const Freedoms *free, *locked;  ///< there
};

/// Fills in modes, platform motions, idle freedoms, redundant constraints, limb wrenches and the
/// terms of the counting formula.
void collect_evidence(const Findings& findings, MobilityReport& report);

/// The kind of motion in words: whether rotation axes keep their direction (Schoenflies), whether
/// other coordinates move along (parasitic motion).
[[nodiscard]] std::string describe_motion(const MobilityReport& report);

}  // namespace polyglide
