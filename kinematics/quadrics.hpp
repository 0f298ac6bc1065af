#pragma once

#include <optional>
#include <vector>

#include "kinematics/plane_cut.hpp"

namespace polyglide {

// All of it needs UpwardRounding.

/// constant + linear·x of a place x [m].
struct Affine {
  Interval constant;
  IntervalVector linear;
};

/// constant + linear·x + Σ square x², and mixed times yz, zx, xy.
struct Quadric {
  Interval constant;
  IntervalVector linear, square, mixed;
  /// 1: never below its tangent planes; -1: never above; 0: neither is known.
  int bend = 0;
};

[[nodiscard]] Quadric square(const Affine& a);
[[nodiscard]] Quadric operator+(const Quadric& a, const Quadric& b);
[[nodiscard]] Quadric operator-(const Quadric& a, const Quadric& b);
[[nodiscard]] Quadric operator*(const Interval& factor, const Quadric& a);
[[nodiscard]] Quadric as_quadric(const Affine& a);

/// |x + from|².
[[nodiscard]] Quadric squared_distance(const IntervalVector& from);

/// Between two parallel planes whose distance is the most that the squares make on the cuboid.
[[nodiscard]] PlaneBound enclose(const Quadric& quadric, const Cuboid& cuboid);

/// A limit of a machine that does not turn: value <= 0 is allowed, and so is `unless` <= 0.
struct QuadricLimit {
  Quadric value;
  std::optional<Quadric> unless;
};

/// What the limit leaves of a cuboid. Where both faces cross it, the plane is that which leaves
/// more.
[[nodiscard]] PlaneCut cut_of(const Cuboid& cuboid, const QuadricLimit& limit);

/// Appends one, or widens one of `limits` that is the same but for rounding: counted twice, the
/// same face would be taken away twice.
void append(std::vector<QuadricLimit>& limits, const QuadricLimit& limit);

}  // namespace polyglide
