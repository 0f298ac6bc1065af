#pragma once

#include <string>
#include <vector>

#include "kinematics/model.hpp"

namespace polyglide {

/// What a screw is as a line in space.
struct ScrewLine {
  /// The zero screw; one without axis part (translation, couple); one of no pitch (rotation,
  /// force); any other.
  enum class Kind { none, pure_moment, line, screw };
  Kind kind = Kind::none;
  Vector3 axis = Vector3::Zero();   ///< unit, its largest part positive
  Vector3 point = Vector3::Zero();  ///< of the line, nearest to the base origin [m]
  double pitch = 0;                 ///< [m/rad]
};

/// Axis, point and pitch of [axis part; moment about the base origin].
[[nodiscard]] ScrewLine line_of(const Screw& screw);

/// A twist [w; v at the base origin] in words: "rotation about the axis along (…) through (…) mm",
/// "translation along (…)", "screw motion of pitch …". The zero twist is "no motion".
[[nodiscard]] std::string describe_twist(const Screw& twist);

/// A wrench [f; n about the base origin] in words: "force along (…) through (…) mm", "couple
/// about (…)", "wrench of pitch …". The zero wrench is "no wrench".
[[nodiscard]] std::string describe_wrench(const Screw& wrench);

/// A basis of a screw system that reads well: first the screws without an axis part (translations,
/// couples), along base axes where the system holds those; then one screw per remaining axis
/// direction, with as much of its moment part removed as the first ones allow, so that
/// pitches vanish where they can.
/// @param system 6×n of any rank, [axis part; moment part at `point` / size]
/// @return screws with unit axis part (or unit moment part), moments about the base origin [m]
[[nodiscard]] std::vector<Screw> plain_basis(const Eigen::MatrixXd& system, const Vector3& point,
                                             double size);

}  // namespace polyglide
