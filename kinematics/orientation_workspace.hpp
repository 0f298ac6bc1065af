#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kinematics/orientation_set.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {

struct OrientationOptions {
  std::vector<std::string> ignored;  ///< limits that do not count
  Vector3 at = Vector3::Zero();      ///< where the tool stays: displacement from home [m]
  /// Told `done` of about `total` poses now and then.
  std::function<void(double done, double total)> progress;
};

/// How far the platform turns before something stops it.
struct TurnEnd {
  double angle = 0;   ///< [rad]
  std::string limit;  ///< what stops it, "singularity" among them; "" where nothing does
};

/// Tilts in one direction, seen from above.
struct TiltDirection {
  double azimuth = 0;      ///< [rad] from base x towards y
  TurnEnd end;             ///< tilting from home's orientation without torsion
  double any_torsion = 0;  ///< [rad] greatest tilt of the workspace this way, whatever the torsion
};

/// Orientation workspace at one place of the tool: the rotations connected with home's orientation
/// that no limit stops and no singularity separates from it. Angles as `turned` takes them.
struct OrientationWorkspace {
  std::vector<int> rotations;  ///< commanded: 3, 4, 5 = A, B, C
  bool reachable = false;      ///< home's orientation at this place; else nothing below is set
  std::string limit;           ///< what stops home's orientation, when it is not reachable

  TurnEnd least, most;  ///< one rotation: its ends; three: those of the torsion without tilt
  std::vector<TiltDirection> directions;  ///< two or three rotations
  TiltDirection worst;  ///< the direction in which tilting ends first: this tilt is had in all
  double greatest = 0;  ///< [rad] the greatest tilt in any direction
  /// Of the directions that the vertical of the platform reaches [sr]; A and B, or three rotations.
  double solid_angle = 0;
  double share = 0;        ///< of all rotations (three), of the sphere (A and B), of a turn (one)
  double share_error = 0;  ///< of the share: its change when half the lines are left out
  std::map<std::string, double> limits_hit;  ///< share of the ends of lines that each limit makes
  double step = 0;                           ///< [rad] of tilt between neighbouring samples
  std::size_t poses = 0;
  double seconds = 0;
};

/// Flood fill from home's orientation over a grid of tilt azimuth × tilt × torsion, whose lines of
/// tilt are then ended by bisection to 1e-6 rad and integrated with the measure of rotations,
/// sin(tilt). A wall thinner than a step is not seen, unless det J changes sign there. One
/// rotation: followed both ways from home in steps until something stops it, at most half a turn.
/// Cost: some 1e6 poses with closed form and three rotations, else at most 2e4.
/// @throws std::invalid_argument for a machine without rotations or a place that is not finite
[[nodiscard]] OrientationWorkspace orientation_workspace(const Machine& machine,
                                                         const OrientationOptions& options = {});

/// The `workspace --orientations-at --json` document.
[[nodiscard]] nlohmann::ordered_json to_json(const OrientationWorkspace& workspace);

}  // namespace polyglide
