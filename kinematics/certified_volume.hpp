#pragma once

#include "kinematics/region.hpp"

namespace polyglide {

/// Proved bounds of the volume (area of planar machines) of the workspace: the connected part
/// around home where every limit holds and, unless singular poses count as well, det J keeps home's
/// sign.
struct CertifiedVolume {
  double lower = 0, upper = 0;  ///< [m³, m²]
  int cells = 0;                ///< examined
  bool reached = false;         ///< upper - lower <= tolerance × upper
};

/// What singular places mean: whether they belong to the workspace, too, and where it ends at one.
struct SingularPlaces {
  bool count = false;
  std::optional<SingularWall> wall;
};

/// By interval arithmetic on an octree. A cell is in, out, or crossed by limits; a limit that
/// crosses is enclosed between two parallel planes (mean value form), whose gap shrinks with the
/// square of the cell, and the volumes cut off by planes are closed forms. Cells with the widest
/// bounds are split until `tolerance` [relative] is met or `budget` cells were examined. Parts are
/// joined for the lower bound only through points proved inside, and separated for the upper
/// bound only by cells proved outside. Without closed form joints are followed from home
/// (ClosureBounds), on a budget that shrinks with what that takes.
/// nullopt where nothing can be proved: limits without enclosure, dozens of joints that hang
/// together, fewer than two translations, home outside or singular (but where singular places
/// count), or a workspace that is not proved to be within the search box. A wall is taken as given.
/// Poses are meant without rounding of the rotation; the slack of 1e-9 m at limits is the
/// evaluator's.
[[nodiscard]] std::optional<CertifiedVolume> certify_volume(const Machine& machine,
                                                            const std::vector<std::string>& ignored,
                                                            const Eigen::Quaterniond& rotation,
                                                            const Bounds& box,
                                                            const SingularPlaces& singular,
                                                            double tolerance, int budget = 600000);

}  // namespace polyglide
