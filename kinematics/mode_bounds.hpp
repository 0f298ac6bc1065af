#pragma once

#include <string>

#include "kinematics/solve.hpp"

namespace polyglide {

/// The most isolated assembly modes that machines of one family can have.
struct ModeBound {
  int count = 0;       ///< 0: no family was recognised
  std::string family;  ///< in words
};

/// By the machine's build: platforms on six distances 40 (Raghavan 1993; Dietmaier 1998), 16 where
/// platform joints meet in three pairs (Innocenti & Parenti-Castelli 1990), 8 where they meet as
/// 3-2-1; platforms whose three balls move on circles 16 (3-RPS), 12 where the axes of the circles
/// are parallel (Lazard & Merlet 1994); three distances in a plane 6 (Hunt 1983; Gosselin, Sefrioui
/// & Richard 1992); three arms about one point 8 (Gosselin, Sefrioui & Richard 1994); two circles
/// in a plane (five-bars, four-bars) 2; three limbs that each hold the platform to a plane 1
/// (Tripteron). Modes are poses of the platform: limbs that reach one in several ways count once.
[[nodiscard]] ModeBound most_modes(const Machine& machine);

}  // namespace polyglide
