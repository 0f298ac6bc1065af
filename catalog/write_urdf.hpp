#pragma once

#include <string>

#include "catalog/mechanism.hpp"

namespace polyglide {

/// A mechanism in URDF, which knows only trees, and the loops beside it.
struct UrdfFiles {
  std::string urdf;
  std::string loops;  ///< YAML in the layout of Gepetto's example-parallel-robots
};

/// The spanning tree as URDF, assembled at home, and the closed loops as YAML.
///
/// A joint of several freedoms becomes a chain of one-freedom joints with light links
/// between (`<joint>.1`, `<joint>.2`); a ball is three revolutes about x, y, z at home and
/// singular when the middle one stands at 90°; a helical joint is a turn and a slide that mimics
/// it. Joint coordinates are zero at home. The YAML holds, per loop, the two frames that
/// coincide (`closed_loop`: links named closedloopN_A and closedloopN_B) and what of them
/// (`type`: 3d the origins, 6d the frames), the driven joints (`name_mot`), and empty
/// `joint_name`, `joint_type`: no joint has to be replaced. Cones and half-space limits are left
/// out; masses are guesses, as in to_mjcf(). Source of the layout: Batto, De Matteis, Mansard,
/// arXiv 2504.04767.
/// @throws std::invalid_argument when a body is not connected to the base.
[[nodiscard]] UrdfFiles to_urdf(const Mechanism& mechanism);

}  // namespace polyglide
