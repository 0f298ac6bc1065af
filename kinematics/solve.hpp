#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinematics/legs.hpp"
#include "kinematics/task.hpp"

namespace polyglide {

/// A machine ready for inverse and forward kinematics: the compiled model, its
/// task space and, where its legs have closed forms, those.
struct Machine {
  Model model;
  TaskSpace task;
  std::optional<LegMachine> legs;
};

/// Compiles a mechanism and finds its task space (a short mobility analysis). Planar machines of
/// two freedoms whose tool has both its coordinates free, such as five-bars, are commanded by
/// these; machines of which some axes stand still at home, such as four-bars with parallel cranks,
/// by others.
[[nodiscard]] Machine prepare(const Mechanism& mechanism);

/// The same for a mechanism whose task space is known, as when only dimensions
/// were turned: skips the mobility analysis. Cost: tens of µs.
[[nodiscard]] Machine prepare(const Mechanism& mechanism, const TaskSpace& task);

/// A platform pose: displacement from home about the base frame.
struct Pose {
  Vector3 position = Vector3::Zero();  ///< of the tool point, displacement from home [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// Pose of six task coordinates [x y z | a b c], metres and radians;
/// rotation = Rz(c)·Ry(b)·Rx(a) about the fixed base axes.
[[nodiscard]] Pose pose_of(const Eigen::Matrix<double, 6, 1>& coordinates);

/// The task coordinates of a pose; |b| <= pi/2.
[[nodiscard]] Eigen::Matrix<double, 6, 1> coordinates_of(const Pose& pose);

/// Displacement of the platform body: tool at tool_home + position.
[[nodiscard]] Transform platform_transform(const Model& model, const Pose& pose);
[[nodiscard]] Pose platform_pose(const Model& model, const Transform& platform);

/// Result of inverse kinematics. Not reachable is a value, not an exception.
struct InverseResult {
  bool reachable = false;
  std::string limit;  ///< why not: "stroke leg1.guide max", "rod leg2.rod cannot reach", …; "" when
                      ///< reachable
  Eigen::VectorXd drives;          ///< from home, order of Model::drives [m, rad]
  Pose pose;                       ///< the full pose taken, parasitic parts included
  double residual = 0;             ///< closure error [m, rad], scaled
  std::optional<Posture> posture;  ///< of the whole mechanism; not where the way was closed form
};

/// Drives for a pose. Only the machine's independent task coordinates are
/// imposed; the others follow from the mechanism and come back in `pose`.
/// Closed form for leg machines whose task space is pure, else Newton on loop
/// closure, continued from home in steps so that the assembly mode is home's.
/// Limits of the mechanism apply unless named in `ignored`.
[[nodiscard]] InverseResult solve_inverse(const Machine& machine, const Pose& pose,
                                          const std::vector<std::string>& ignored = {});

/// The general way, whatever the machine: the reference for every fast path.
/// @param posture in: start (home or a nearby posture); out: the solution.
[[nodiscard]] InverseResult solve_inverse_general(const Machine& machine, const Pose& pose,
                                                  Posture& posture);

struct ForwardSolution {
  Pose pose;
  double residual = 0;  ///< largest closure error [m or rad, scaled by size]
  bool closed_form = false;
  bool home_mode = false;  ///< connected with home by continuation of the drives
  bool certified = false;  ///< proved: a root is in the box of `radius` around it, and only one
  double radius = 0;       ///< [rad, or length/size]; 0 unless certified
  int region = -1;  ///< modes of one region are joined without a singularity; -1: not looked for
  bool connected_to_home = false;  ///< home_mode, or joined with home's pose without a singularity
  std::optional<Posture> posture;  ///< where it was found on the whole mechanism
};

/// Platform poses for drive positions from home. `all` asks for every assembly
/// mode: closed form (two roots) for translational three-leg machines, else
/// Newton from many seeded starts. Empty when it cannot be assembled. Sorted:
/// home mode first, then by pose.
[[nodiscard]] std::vector<ForwardSolution> solve_forward(const Machine& machine,
                                                         const Eigen::VectorXd& drives, bool all,
                                                         std::uint64_t seed = 1);

/// The solution on home's own mode, drives followed from home; nullopt when they cannot be.
[[nodiscard]] std::optional<ForwardSolution> follow_from_home(const Machine& machine,
                                                              const Eigen::VectorXd& drives);

/// Follows the drives from a posture; false when the machine cannot be assembled there.
[[nodiscard]] bool solve_forward_from(const Machine& machine, const Eigen::VectorXd& drives,
                                      Posture& posture);

/// Task Jacobian at a posture: drive rates = J · task rates, m×n for m drives
/// and n task axes; rotational columns divided by the characteristic length, so
/// entries are dimensionless for linear drives. General: from the kernel of loop closure.
/// nullopt at a posture where the platform rates do not fix the drives.
[[nodiscard]] std::optional<Eigen::MatrixXd> task_jacobian(const Machine& machine,
                                                           const Posture& posture);

/// The same rates by the legs of a leg machine, m×6, before axes are chosen: drive rates in SI per
/// rate of the tool point X Y Z [m/s] and of the rotation A B C [rad/s]. With r the rod from its
/// joint on carriage or crank, whose motion per drive is b, to its joint at a from the tool: the
/// row is [r, a × r]/(r·b), a strut's b its unit vector.
/// @param drives from home; the legs have their lengths with them at this pose, on either root.
/// nullopt without legs, or where a rod is across the motion of its carriage.
[[nodiscard]] std::optional<Eigen::MatrixXd> leg_rows(const Machine& machine, const Pose& pose,
                                                      const Eigen::VectorXd& drives);

/// 2-norm condition number, infinity when singular, of any m×n Jacobian.
[[nodiscard]] double condition_number(const Eigen::MatrixXd& jacobian);

/// The drives and pose of a posture.
[[nodiscard]] Eigen::VectorXd drive_positions(const Model& model, const Posture& posture);

}  // namespace polyglide
