#pragma once

#include <functional>
#include <optional>

#include "kinematics/interval_rotation.hpp"
#include "kinematics/krawczyk.hpp"

namespace polyglide {

// What proofs of a pose and of a loop closure share; all of it needs UpwardRounding.

/// Values and derivatives of n equations on a box of n unknowns around a point.
struct Enclosure {
  std::vector<Interval> values;
  IntervalMatrix jacobian;
};

/// Krawczyk's operator on boxes that grow from the Newton step: K(X) = -Y f(0) + (I - Y J(X)) X
/// with Y about J(0)⁻¹. Not proved when no box up to a hundredth holds its image.
/// @param enclose gives an Enclosure for a box of n increments.
[[nodiscard]] ModeCertificate prove_root(
    int n, const std::function<Enclosure(const std::vector<Interval>&)>& enclose);

/// Indices of as many columns as are independent; nullopt when the rank is in doubt.
[[nodiscard]] std::optional<std::vector<int>> independent_columns(const Eigen::MatrixXd& matrix);

/// An axis of unit length: what rounding left of it is widened, what is exact stays exact.
[[nodiscard]] IntervalVector unit_axis(const Vector3& axis);

}  // namespace polyglide
