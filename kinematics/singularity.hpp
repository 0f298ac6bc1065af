#pragma once

#include <string>
#include <vector>

#include "kinematics/solve.hpp"

namespace polyglide {

/// Something a platform gains or loses at a singular posture.
struct SingularScrew {
  std::string about;  ///< in words
  Screw screw =
      Screw::Zero();  ///< gained: twist [w; v]; lost: wrench [f; n]; about the base origin
};

/// Which singularities a posture has. Terms: Gosselin, Angeles 1990 (types I and II); Zlatanov,
/// Fenton, Benhabib 1998; Zlatanov, Bonev, Gosselin 2002 (constraint singularities).
struct Singularity {
  bool direct = false;   ///< type II, redundant output: with drives held the platform moves
  bool inverse = false;  ///< type I, impossible output: some platform motion is lost, drives move
                         ///< while it rests
  bool constraint = false;  ///< the mechanism as a whole has more freedoms than elsewhere

  std::vector<SingularScrew> gained;  ///< platform motions that the drives do not hold
  std::vector<SingularScrew> lost;    ///< wrenches borne here without any drive, not elsewhere

  double direct_margin = 0;   ///< smallest over largest drive rate per mechanism motion, 0..1
  double inverse_margin = 0;  ///< smallest over largest task rate per mechanism motion, 0..1

  [[nodiscard]] bool regular() const { return !direct && !inverse && !constraint; }
};

/// Classifies a posture from the kernel of its loop-closure Jacobian.
///
/// Every motion of the mechanism is a kernel vector; its drive rates and task rates are two small
/// matrices D and T. Beyond the machine's idle freedoms: D without full rank is direct,
/// T without full rank inverse, a kernel larger than that of the machine's motion a constraint
/// singularity. Rotational rates count at the characteristic length.
/// @param mobility finite mobility of the machine, as check finds it
/// @param singular a margin below it counts as zero
/// Cost: about 0.1 ms.
[[nodiscard]] Singularity singularity_at(const Machine& machine, const Posture& posture,
                                         int mobility, double singular = 1e-6);

/// The smaller of both margins.
[[nodiscard]] double smaller_margin(const Machine& machine, const Posture& posture);

/// "regular", or the kinds in words: "direct (type II)", "inverse (type I)", "constraint".
[[nodiscard]] std::string singularity_name(const Singularity& singularity);

/// A singular pose met on a way, and where.
struct SingularCrossing {
  double at = 0;  ///< part of the way, 0..1
  Pose pose;
  Singularity singularity;
};

/// What lies on the straight way (in task coordinates) between two poses.
struct PathSingularities {
  bool reached = false;  ///< the whole way can be followed; else it ends at `end`
  double end = 1;        ///< part of the way that was followed
  double smallest_margin = 1, smallest_at = 0;  ///< closest to singular, and where
  std::vector<SingularCrossing> crossings;
  Singularity
      at_end;  ///< where the way cannot be followed further: usually inverse, a leg stretched
};

/// Follows the way from home's branch and reports where the sign of the Jacobian's determinant
/// changes, or where a margin falls to zero and rises again without.
/// @param samples postures looked at; changes of sign between them are bisected to 1e-9 of the way,
/// other zeros found to some 1e-6; what is nearer together than 0.1/samples counts as one
[[nodiscard]] PathSingularities singularities_on_path(const Machine& machine, const Pose& from,
                                                      const Pose& to, int samples = 100);

/// The nearest singular pose found.
struct NearestSingularity {
  bool found = false;   ///< false: none within the search radius
  double distance = 0;  ///< [m]: displacement and rotation × characteristic length, root of squares
  Pose pose;
  Singularity singularity;
  int directions = 0;  ///< in which it was looked for
};

/// Looks outwards from a pose in `directions` directions of the task space, limits left aside,
/// until the determinant changes sign or the way ends, and walks downhill from the nearest.
/// An upper bound of the true distance, close to it for smooth singular surfaces.
/// @param radius how far to look [m]; 0: the machine's size
[[nodiscard]] NearestSingularity nearest_singularity(const Machine& machine, const Pose& pose,
                                                     double radius = 0, int directions = 64,
                                                     std::uint64_t seed = 1);

}  // namespace polyglide
