#pragma once

#include <optional>
#include <string>
#include <vector>

#include "catalog/elementary_motion.hpp"
#include "catalog/mechanism.hpp"

namespace polyglide {

/// One freedom of a tree joint as tree engines want it: the motion of the outer link
/// against the inner one.
struct EngineMotion {
  int freedom = 0;          ///< index within the mechanism's joint
  ElementaryMotion motion;  ///< its coordinate is the mechanism's, whichever way the joint points
  Range range;              ///< of the coordinate, from home; infinite where there is no limit
  bool driven = false;
};

/// A link of the tree and the joint that it hangs on. All link frames are parallel to the
/// base frame at home.
struct EngineLink {
  int body = -1;                     ///< the mechanism's body; -1 for a cut joint's outer half
  int parent = -1;                   ///< index of the inner link, -1 for the base
  int joint = -1;                    ///< the mechanism's joint, -1 for the base
  Vector3 origin = Vector3::Zero();  ///< of the link's frame at home, base frame: the joint's point
  std::vector<EngineMotion> motions;  ///< from the inner link outwards; none = fixed
};

/// Two links whose points (`rigid`: and orientations) at `at` stay together.
struct EngineClosure {
  std::string name;              ///< of the mechanism's joint
  int first = 0, second = 0;     ///< links
  Vector3 at = Vector3::Zero();  ///< at home, base frame
  bool rigid = false;            ///< all six freedoms, else the three of the point
};

/// A mechanism for engines that know trees and two ways to tie links together. A loop
/// is cut at its closing joint: a ball that is not driven becomes a tie of two points;
/// of any other joint the freedoms stay as those of an extra link, which is tied rigidly
/// to the body beyond. Either way the ties take exactly the freedoms that the loop takes.
struct EngineTree {
  std::vector<EngineLink> links;  ///< from the base outwards; the base first
  std::vector<EngineClosure> closures;
};

/// @throws std::invalid_argument when a body is not connected to the base.
[[nodiscard]] EngineTree engine_tree(const Mechanism& mechanism);

/// How a body is drawn: bars from its own joint to its other joints and the tool.
struct StickFigure {
  std::vector<Vector3> ends;  ///< of the bars, from the link's origin [m]; may be empty
};

/// One figure per link; the base has none.
[[nodiscard]] std::vector<StickFigure> stick_figures(const Mechanism& mechanism,
                                                     const EngineTree& tree);

/// Bar radius that suits the machine: a hundredth of its extent [m], above zero.
[[nodiscard]] double bar_radius(const Mechanism& mechanism);

/// Density of the bars [kg/m³]: aluminium's. Below an extent of 50 mm more, so that moments of
/// inertia (∝ extent⁵) stay above what engines take for zero.
[[nodiscard]] double bar_density(const Mechanism& mechanism);

/// "knee" for the only freedom of a joint, "knee.2" for the second of several.
[[nodiscard]] std::string freedom_name(const Joint& joint, int freedom);

}  // namespace polyglide
