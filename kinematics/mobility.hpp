#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kinematics/model.hpp"
#include "kinematics/task.hpp"

namespace polyglide {

enum class Verdict { determinate, overdriven, singular_home, uncertain, rigid };

/// "determinate", "overdriven", "singular-home", "uncertain", "rigid".
[[nodiscard]] std::string to_string(Verdict verdict);

/// A freedom that is left, as evidence: the instantaneous screw of the platform
/// and a finite motion along it that one can animate.
struct FreedomMode {
  std::string about;            ///< in words: which motion, where, with drives held or free
  Screw twist = Screw::Zero();  ///< of the platform, [w; v at base origin]
  std::vector<std::vector<Transform>>
      frames;  ///< per frame, displacement of every body; may be one frame
};

/// How sure a check is and how hard it tries.
struct MobilityOptions {
  std::uint64_t seed = 1;
  int walks =
      3;  ///< independent walks from a regular home (four times as many from a singular one)
  double step = 0.12;    ///< length of one step along the manifold, in scaled coordinates [rad]
  int steps = 4;         ///< steps per walk
  bool evidence = true;  ///< also compute modes (frames); off for screening
};

/// What `check` finds out. Names as in the `check --json` contract.
struct MobilityReport {
  Verdict verdict = Verdict::determinate;
  std::vector<std::string> reasons;

  int home = 0, finite = 0, kutzbach = 0, redundant_constraints = 0, idle = 0;
  int platform_dof = 0, platform_home_dof = 0;
  TaskSpace task;
  std::string pattern;  ///< "3T1R"
  std::string axes;     ///< "XYZA"

  int drives = 0, locked_mobility = 0, locked_platform = 0, home_locked_platform = 0, surplus = 0;
  double rank_gap = 0, margin = 0;

  /// Motion branches found through home, by their dimension and platform pattern.
  struct Branch {
    int dimension = 0;
    std::string pattern;
  };
  std::vector<Branch> branches;
  std::vector<std::string> idle_rods;  ///< bodies that spin without moving the platform
  std::vector<FreedomMode> modes;      ///< what makes an uncertain or singular machine so
};

/// Mobility of any joint graph: rank of the loop-closure Jacobian at home and at
/// generic postures reached along the constraint manifold, the same with drives
/// held, and the verdict. See docs/verdicts.md.
/// Deterministic for a given seed. Cost: a few hundred µs to a few ms.
[[nodiscard]] MobilityReport analyse_mobility(const Model& model,
                                              const MobilityOptions& options = {});

/// The `check --json` document.
[[nodiscard]] nlohmann::ordered_json to_json(const MobilityReport& report,
                                             const Mechanism& mechanism);

}  // namespace polyglide
