#pragma once

#include "kinematics/krawczyk_root.hpp"
#include "kinematics/model.hpp"

namespace polyglide {

// Products of exponentials of screws; all need UpwardRounding.

/// One factor: the exponential of a screw times a coordinate, or a fixed rotation about a point.
struct ScrewFactor {
  int variable = -1;  ///< -1: fixed
  bool translational = false;
  int sign = 1;
  IntervalVector axis;     ///< unit; of a turn, or the direction of a shift
  Vector3 point;           ///< on the axis of a turn, at home [m]
  Interval pitch{0.0};     ///< advance per radian [m]
  double coordinate = 0;   ///< where the variable is zero
  IntervalRotation fixed;  ///< fixed factor: the rotation
};
using ScrewChain = std::vector<ScrewFactor>;

/// What a variable does to a point that the whole chain carries.
struct CarriedScrew {
  int variable;
  bool translational;
  IntervalVector w, v;  ///< angular velocity, and velocity of the point, per rad or m
};

/// What becomes of a body and a point of it.
struct Carried {
  IntervalRotation rotation;
  IntervalVector shift;  ///< of the point [m]
  std::vector<CarriedScrew> screws;
};

/// The motion of bodies[1] of a joint against bodies[0] with a posture's coordinates as zero; the
/// variables are the indices of the freedoms.
[[nodiscard]] ScrewChain joint_chain(const Model& model, int joint, const Posture& posture);

/// The way back.
[[nodiscard]] ScrewChain inverse(ScrewChain chain);

/// The joints one after the other.
[[nodiscard]] ScrewChain chain_of(const Model& model, const std::vector<LoopStep>& steps,
                                  const Posture& posture);

/// The product on a box of variables, translations per `size`, applied to a point. Places are
/// summed up from joint to joint, so that what is far from the base's origin is no less sharp.
void carry(const ScrewChain& chain, const Vector3& point, const std::vector<Interval>& box,
           double size, Carried& result);

/// Two ways that lead to the same place when a loop is closed. Where they are cut matters only for
/// how sharp enclosures on wide boxes are: best in the middle.
struct ScrewLoop {
  ScrewChain out, back;
  Vector3 point = Vector3::Zero();  ///< of the body where they meet, at home [m]
};

/// A loop's closure, six rows from `row`: the vector of the skew part of the rotation that is left,
/// zero with a rotation only for none or half a turn, and the shift of the point over the size,
/// with derivatives by `columns`.
/// @param columns per variable: its column of the Jacobian, or -1.
void enclose_loop(const ScrewLoop& loop, const std::vector<Interval>& box, double size,
                  const std::vector<int>& columns, int row, Enclosure& result);

}  // namespace polyglide
