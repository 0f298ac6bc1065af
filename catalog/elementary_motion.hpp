#pragma once

#include <vector>

#include "catalog/mechanism.hpp"

namespace polyglide {

/// One freedom of a joint: a turn about, or a shift along, an axis through the joint's
/// point. Several follow each other, each carried by the ones before it.
struct ElementaryMotion {
  bool translation = false;         ///< coordinate in metres, else radians
  Vector3 axis = Vector3::UnitZ();  ///< unit, base frame at home
  double pitch = 0;                 ///< advance along the axis per radian [m/rad]
};

/// The freedoms of a joint in the order of their indices, as the motion of bodies[1]
/// against bodies[0]. Revolute, prismatic, helical: one. Cylindrical: turn, shift. Universal:
/// turn about axes[0], then axes[1]. Planar: shifts along two perpendicular directions in
/// the plane (a function of the normal alone), then the turn. Spherical: rates about base
/// x, y, z; its finite motion is one rotation, not a sequence. Weld: none.
[[nodiscard]] std::vector<ElementaryMotion> elementary_motions(const Joint& joint);

}  // namespace polyglide
