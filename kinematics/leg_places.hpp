#pragma once

#include <optional>

#include "kinematics/legs.hpp"

namespace polyglide {

/// How a point of a leg machine's body follows from pose and drives, in closed form. With P the
/// leg's platform joint now and B its base joint (on carriage, crank or base):
struct LegPlace {
  enum class Kind {
    fixed,     ///< in the base
    platform,  ///< moves with the platform
    carriage,  ///< slides along the leg's guide
    crank,     ///< turns about the leg's axis
    rod,       ///< B + part · (P - B): on the line of a rod
    lower,     ///< B + part · unit(P - B): on the line of a strut's lower half, part [m]
    upper      ///< P + part · unit(P - B): of its upper half, part [m]
  } kind = Kind::fixed;
  Vector3 at = Vector3::Zero();  ///< at home, base frame [m]
  int leg = -1;                  ///< index into LegMachine::legs, but for fixed and platform
  double part = 0;
};

/// nullopt for a point whose place depends on how a rod or strut spins: off its line.
[[nodiscard]] std::optional<LegPlace> leg_place(const Mechanism& mechanism,
                                                const LegMachine& machine, const BodyPoint& point);

/// Whether a body's displacement follows from pose and drives: base, platform, carriage, crank.
[[nodiscard]] bool is_placed(const Mechanism& mechanism, const LegMachine& machine, int body);

/// Whether the places of all that clearances watch do.
[[nodiscard]] bool shapes_are_placed(const Mechanism& mechanism, const LegMachine& machine);

/// Displacement from home of a body that is_placed().
/// @param drives of the machine, from home.
[[nodiscard]] Transform body_displacement(const Mechanism& mechanism, const LegMachine& machine,
                                          int body, const Transform& platform,
                                          const Eigen::VectorXd& drives);

}  // namespace polyglide
