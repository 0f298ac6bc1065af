#pragma once

#include <Eigen/Core>

#include "kinematics/interval.hpp"

namespace polyglide {

// Boxes cut by planes; all need UpwardRounding.

/// A box of places: its middle, and how far it reaches from there to either side [m]. What is said
/// of one holds for boxes that differ from it by rounding, too.
struct Cuboid {
  std::array<double, 3> middle{}, half{};
};

/// "value <= 0 is allowed" on a cuboid, enclosed between two parallel planes: value(middle + d)
/// lies in at + slope·d for every d of the cuboid.
struct PlaneBound {
  Interval at;
  std::array<double, 3> slope{};
};

/// What a limit leaves of a cuboid.
struct PlaneCut {
  Interval part;     ///< that is allowed, of 1; exactly 1 where the limit holds on all of it
  PlaneBound plane;  ///< which cuts, where the part is neither 0 nor 1
  bool holds() const { return part.lower() >= 1; }
  bool fails() const { return part.upper() <= 0; }
};

[[nodiscard]] PlaneCut cut_of(const Cuboid& cuboid, const PlaneBound& plane);

/// Upper bound of the part of the cuboid that some of the cuts does not allow. Planes that are
/// nearly parallel are taken together, else what both take away counts twice.
[[nodiscard]] double part_taken(const Cuboid& cuboid, std::vector<PlaneCut> cuts);

/// Whether a place, as parts -1 to 1 of the half sides, is proved to be allowed.
[[nodiscard]] bool allows(const PlaneBound& plane, const Cuboid& cuboid,
                          const Eigen::Vector3d& place);

}  // namespace polyglide
