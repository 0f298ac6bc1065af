#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinematics/model.hpp"

namespace polyglide {

/// One rod of constant length between a driven carriage or crank and the platform, or a
/// driven strut between base and platform. Base frame at home, SI.
struct Leg {
  enum class Kind { guide_rod, strut, crank_rod } kind = Kind::guide_rod;
  int drive = 0;       ///< index into Model::drives
  Vector3 base_point;  ///< the rod's joint on carriage or crank at home, or strut's [m]
  Vector3 direction;   ///< unit: guide (guide_rod), axis (crank_rod), line (strut)
  Vector3 centre = Vector3::Zero();  ///< of the circle of base_point about the axis (crank_rod) [m]
  Vector3 platform_point;            ///< platform joint at home [m]
  double length = 0;                 ///< rod length, or strut length at home [m]
  double side = 1;                   ///< which of the two roots home is on: ±1
  Range stroke;                      ///< of the drive, from home [m, rad]
  int base_joint = 0, platform_joint = 0;  ///< indices of the end joints, for cones
};

/// A machine all of whose limbs are guide + rods, crank + rods or struts: its inverse
/// kinematics is closed form. Several legs may share a drive (parallelogram,
/// rod pairs): `primary[d]` is the leg that gives drive d.
struct LegMachine {
  std::vector<Leg> legs;
  std::vector<int> primary;
};

/// Whether some drive turns an arm.
[[nodiscard]] bool has_cranks(const LegMachine& machine);

/// Recognises such a machine; nullopt for any other (then the general solver
/// is used). Makes a machine general: a limb without drive, a drive without limb,
/// any other joint kind, a range on a passive joint, a half-space limit on a rod or strut,
/// a shape beside the line of a rod or strut, or a mesh on one, that a clearance watches.
[[nodiscard]] std::optional<LegMachine> recognise_legs(const Model& model);

/// Index of a leg whose carriage is `body`, -1 when it is none's.
[[nodiscard]] int carriage_leg(const Mechanism& mechanism, const LegMachine& machine, int body);

/// The axis of a joint's cone, pointed along the rod: the file may give it either way.
[[nodiscard]] Vector3 axis_along_rod(const Joint& joint, const Leg& leg);

/// Whether a leg asks the same of their carriage as `first` wherever the platform is at
/// `rotation` (displacement from home): their rods are parallels. If not, what both ask is an
/// equation.
[[nodiscard]] bool is_parallel(const Leg& leg, const Leg& first,
                               const Eigen::Quaterniond& rotation);

/// A point that a half-space limit keeps on one side of a plane. Refers to the mechanism.
struct WatchedPoint {
  const HalfSpaceLimit& limit;
  const HalfSpaceLimit::Plane& plane;
  const Vector3& point;
  bool on_platform;
  const Leg* carriage;  ///< a leg whose carriage it is on; null on platform and base
};

/// All that are not ignored, in the order of the file.
[[nodiscard]] std::vector<WatchedPoint> watched_points(const Mechanism& mechanism,
                                                       const LegMachine& machine,
                                                       const std::vector<std::string>& ignored);

/// The body at the platform end of a leg: the rod, or the strut's upper part.
[[nodiscard]] int leg_body(const Mechanism& mechanism, const Leg& leg);

}  // namespace polyglide
