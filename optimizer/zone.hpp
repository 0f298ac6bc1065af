#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "catalog/mechanism.hpp"
#include "kinematics/task.hpp"

namespace polyglide {

/// The zone a tool must reach, and how far it must turn there. Positions are
/// displacements of the tool point from home, base frame.
struct Zone {
  enum class Shape { box, cylinder } shape = Shape::box;
  Vector3 size = Vector3::Zero();  ///< [m] edges of the box; (diameter, diameter, height) of the
                                   ///< upright cylinder
  double tilt = 0;                 ///< [rad] rotation asked to either side
  std::optional<Vector3> center;   ///< [m]; nothing: wherever it fits best
};

/// Box volume, or that of the cylinder [m³].
[[nodiscard]] double volume(const Zone& zone);

/// Half the mean plan edge of the zone [m]: the length by which rotations count against
/// translations when machines are compared. One for all of them, because with a length
/// taken from each machine's own platform a small platform would seem to turn as firmly
/// as a large one.
[[nodiscard]] double lever(const Zone& zone);

/// Positions of the zone about its centre [m]: a lattice of across × across × up
/// points that includes the rim. For a cylinder the square lattice is mapped onto the
/// disc, equal areas to equal areas, edge to edge.
///
/// A machine's one rotation axis may stand along any horizontal direction; the zone's
/// first edge is along it, so a machine is judged alike however it is turned.
/// @param axis the rotation axis; one that is not horizontal (or zero) leaves the zone
///        along the base axes.
/// Source of the mapping: Shirley & Chiu, A low distortion map between disk and square (1997).
[[nodiscard]] std::vector<Vector3> zone_positions(const Zone& zone, const Vector3& axis, int across,
                                                  int up);

/// Orientations asked in the zone: untilted, and `steps` equal steps to either side up
/// to the tilt, about the machine's rotation axis, or about base x and y each for a
/// machine that turns about more than one axis. Untilted comes first; it is the only
/// one when no tilt is asked.
[[nodiscard]] std::vector<Eigen::Quaterniond> zone_turns(const Zone& zone, const TaskSpace& task,
                                                         int steps);

}  // namespace polyglide
