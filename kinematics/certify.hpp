#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "kinematics/solve.hpp"

namespace polyglide {

/// A box of poses to be proved good: positions [m] from home, and tilts to either side about every
/// rotation that the machine can command.
struct PoseRegion {
  Vector3 size = Vector3::Zero();    ///< edge lengths; zero is one place
  Vector3 centre = Vector3::Zero();  ///< displacement from home
  double tilt = 0;                   ///< [rad] 0 to π/2
  double condition = 0;              ///< κ must stay at or below this; 0: only be regular
};

enum class CertifyVerdict { certified, fails, undecided };

/// What could be proved, and how far it got.
struct BoxCertificate {
  CertifyVerdict verdict = CertifyVerdict::undecided;
  std::string reason;  ///< one sentence
  std::string limit;   ///< fails: what stops it, as Evaluator names it, "singularity", "condition"
  std::optional<Pose> at;      ///< fails: where; undecided: middle of the widest open box
  double proved = 0;           ///< share of the box, by volume, that is proved good
  double worst_condition = 0;  ///< upper bound of κ over what is proved; 0 when nothing is
  int boxes = 0;               ///< examined
  double seconds = 0;
};

/// Proves by interval subdivision that a whole box of poses obeys every limit that is not ignored,
/// holds no singularity (the same sign of det J as at home, and every J in every box regular), and
/// keeps κ at or below a bound. Limits take the smaller of natural and mean value
/// enclosures; singular values are bounded by Weyl's theorem about the middle of a box.
/// fails: a pose that breaks a limit was found and checked by intervals. undecided: a limit without
/// enclosure, joints that could not be followed from home, the box touches a limit, or the budget was
/// spent; the reason says which.
/// @param budget most boxes to be examined; some µs each.
/// @throws std::invalid_argument for sizes, tilts or bounds that are negative or not finite.
[[nodiscard]] BoxCertificate certify_box(const Machine& machine, const PoseRegion& region,
                                         const std::vector<std::string>& ignored = {},
                                         int budget = 400000);

/// The `workspace --certify --json` document.
[[nodiscard]] nlohmann::ordered_json to_json(const BoxCertificate& certificate);

}  // namespace polyglide
