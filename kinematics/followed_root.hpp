#pragma once

#include <memory>

#include "kinematics/parametric_root.hpp"

namespace polyglide {

/// The root that belongs to one branch, in a box of parameters.
struct FollowedRoot {
  PointRoot point;  ///< in the middle of the box, or as far on the way there as it was followed
  bool in_middle = false;
  std::shared_ptr<const BoxRoot> whole;  ///< all over the box, or one that holds it; null: unknown
};

/// Follows a root into another box: one within the box in which it is known everywhere, else any
/// box, by a way to its middle that is proved in pieces, so that there is no other branch to end
/// on.
/// @param pieces most of them to be tried. Needs UpwardRounding.
[[nodiscard]] FollowedRoot follow_root(const ParametricEnclosure& equations,
                                       const std::vector<Interval>& box, const FollowedRoot& from,
                                       int pieces);

}  // namespace polyglide
