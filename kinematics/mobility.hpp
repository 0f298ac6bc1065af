#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kinematics/limb_wrenches.hpp"
#include "kinematics/model.hpp"
#include "kinematics/task.hpp"

namespace polyglide {

enum class Verdict { determinate, overdriven, singular_home, uncertain, rigid };

/// "determinate", "overdriven", "singular-home", "uncertain", "rigid".
[[nodiscard]] std::string to_string(Verdict verdict);

/// How one body takes part in a motion.
struct BodyMotion {
  int body = 0;
  Screw twist = Screw::Zero();  ///< [w; v at base origin]
  double speed = 0;             ///< rad/s + (m/s)/size, as part of the fastest body's
};

/// A freedom that is left, as evidence: the instantaneous screw of the platform
/// and a finite motion along it that one can animate.
struct FreedomMode {
  std::string about;               ///< in words: which motion, where, with drives held or free
  Screw twist = Screw::Zero();     ///< of the platform, [w; v at base origin]
  std::vector<BodyMotion> bodies;  ///< those that move, fastest first
  std::vector<std::vector<Transform>> frames;  ///< per frame, displacement of every body
};

/// A motion of the platform at home.
struct PlatformMotion {
  std::string about;
  Screw twist = Screw::Zero();     ///< [w; v at base origin]
  std::vector<BodyMotion> bodies;  ///< those that move, fastest first, idle freedoms at rest
};

/// A freedom that moves no point of the platform.
struct IdleFreedom {
  std::string about;
  std::vector<std::string> bodies;  ///< those that move
  Screw twist = Screw::Zero();      ///< of the fastest of them, [w; v at base origin]
};

/// A constraint that repeats others: an inner wrench that no freedom relieves.
struct RedundantConstraint {
  struct Loop {
    std::string closed_by;         ///< the joint that closes the loop
    Screw wrench = Screw::Zero();  ///< carried around it, [f; n about base origin]
  };
  std::string about;
  std::vector<Loop> loops;
};

/// A coordinate that moves although it cannot be commanded.
struct ParasiticMotion {
  int axis = 0;       ///< 0..5 = X Y Z A B C
  double amount = 0;  ///< largest seen at the generic postures visited [m or rad]
};

/// Terms of the modified Grübler–Kutzbach formula M = d(n − g − 1) + Σf + υ − ζ
/// (Ni, Wang, Miao, Wang 2016, eq. 1), the order d and the virtual constraints υ computed.
struct CountingTerms {
  int order = 0, links = 0, joints = 0, freedoms = 0, virtual_constraints = 0, local = 0;
  int mobility = 0;  ///< M
};

/// How sure a check is and how hard it tries.
struct MobilityOptions {
  std::uint64_t seed = 1;
  int walks = 3;  ///< generic postures on every motion branch
  int steps = 3;  ///< steps of 0.25 rad (of the fastest joint) to each
  int leaps = 8;  ///< tries per component of directions at homes singular beyond second order
  bool evidence = true;  ///< also gather evidence; off for screening
};

/// For deciding thousands of candidates: one generic posture each, no evidence.
[[nodiscard]] MobilityOptions screening_options(std::uint64_t seed);

/// What `check` finds out. Names as in the `check --json` contract.
struct MobilityReport {
  Verdict verdict = Verdict::determinate;
  std::vector<std::string> reasons;

  int home = 0, finite = 0, kutzbach = 0, redundant_constraints = 0, idle = 0;
  int platform_dof = 0, platform_home_dof = 0;
  TaskSpace task;
  std::string pattern;  ///< "3T1R"
  std::string axes;     ///< "XYZA"
  std::string motion;   ///< kind of motion in words: "Schoenflies motion: …", "translation", …

  int drives = 0, locked_mobility = 0, locked_platform = 0, home_locked_platform = 0, surplus = 0;
  double rank_gap = 0;
  double margin = 0;  ///< smallest over largest singular value with the drives held; with evidence
  double noise = 0;   ///< largest relative singular value taken for zero: precision of the drawing
  double residual = 0;   ///< worst loop closure left at a posture reached [rad, or length/size]
  int obstructions = 0;  ///< second-order conditions on the freedoms at home; 0 when all continue

  /// Motion branches found through home, by their dimension and platform pattern.
  struct Branch {
    int dimension = 0;
    std::string pattern;
  };
  std::vector<Branch> branches;
  bool motions_meet = false;  ///< home is a constraint singularity with several ways out, or one
                              ///< beyond second order, where another is not excluded
  std::vector<ParasiticMotion> parasitic;

  // Evidence
  std::vector<FreedomMode> modes;  ///< what makes an uncertain or singular machine so
  std::vector<PlatformMotion> platform_motions;
  std::vector<IdleFreedom> idle_freedoms;
  std::vector<std::string> idle_rods;  ///< bodies that spin without moving the platform
  std::vector<RedundantConstraint> redundant;
  std::vector<LimbWrenches> limbs;
  CountingTerms counting;
};

/// Mobility of any joint graph: rank of the loop-closure Jacobian at home and at
/// generic postures reached along the constraint manifold, the same with drives
/// held, and the verdict. See docs/verdicts.md.
/// Deterministic for a given seed. Cost: about 0.2 ms for a 4-PUU machine when screening, a
/// few ms with evidence.
[[nodiscard]] MobilityReport analyse_mobility(const Model& model,
                                              const MobilityOptions& options = {});

/// The `check --json` document.
[[nodiscard]] nlohmann::ordered_json to_json(const MobilityReport& report,
                                             const Mechanism& mechanism);

}  // namespace polyglide
