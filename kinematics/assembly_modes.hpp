#pragma once

#include <string>

#include "kinematics/solve.hpp"

namespace polyglide {

/// How sure it is that no assembly mode was missed.
struct Completeness {
  int starts = 0;       ///< Newton runs made
  int hits = 0;         ///< of them ended in a mode
  int rarest_hits = 0;  ///< hits of the mode that was met least often
  double unseen = 1;    ///< Good–Turing: estimated share of hits that modes not yet met would get
  int bound = 0;        ///< most isolated modes such a machine can have; 0 = not known here
  std::string family;   ///< machines that the bound holds for
  bool complete = false;  ///< proved: `bound` different modes are certified
  std::string stopped;    ///< why the search ended, in words
};

struct AssemblyModes {
  std::vector<ForwardSolution> solutions;  ///< sorted as in solve_forward()
  Completeness completeness;
};

struct AssemblySearch {
  std::uint64_t seed = 1;
  int hits = 8;         ///< every mode must have been met so often before the search ends
  int starts = 0;       ///< most Newton runs; 0: 40000 for six legs, 1600 for others
  bool regions = true;  ///< also look for singularity-free paths between modes
};

/// All assembly modes for drive positions from home [m, rad].
/// - Three legs that only translate: both points common to three spheres.
/// - Six legs that place the platform by distances (struts or rods with a ball at one end at
///   least): Newton on the pose from random poses, some µs each; at most 40 modes (Dietmaier 1998).
/// - Any other: Newton on loop closure from random postures, some 0.1 ms each.
/// Every mode comes with a Krawczyk certificate, or without when none was found. Modes that a path
/// of poses joins, along which det J keeps its sign, share a `region` (sampled; six legs only).
/// Same answer for any number of threads. Empty when the machine cannot be assembled.
/// @throws std::invalid_argument when a drive position is not finite or their number is wrong.
[[nodiscard]] AssemblyModes find_assembly_modes(const Machine& machine,
                                                const Eigen::VectorXd& drives,
                                                const AssemblySearch& search = {});

/// Closed form for machines with three legs that only translate: the points common to three
/// spheres, two or none. Empty for other machines.
[[nodiscard]] std::vector<ForwardSolution> three_sphere_modes(const Machine& machine,
                                                              const Eigen::VectorXd& drives);

/// The legs when distances alone place the platform: six of them, each with a ball at one end at
/// least. Empty otherwise.
[[nodiscard]] std::vector<int> distance_legs(const Machine& machine);

}  // namespace polyglide
