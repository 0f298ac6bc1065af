#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <vector>

#include "catalog/mechanism.hpp"

namespace polyglide {

using Transform = Eigen::Isometry3d;
using Screw = Eigen::Matrix<double, 6, 1>;  ///< twist [w; v], v at the base origin

/// One freedom of one joint, as a screw at home.
struct Freedom {
  int joint = 0;
  int index = 0;  ///< within the joint
  Screw screw;    ///< unit twist at home [rad/s; m/s], base frame, about the base origin
  bool translational = false;  ///< pure translation: coordinate in metres
};

/// One joint on the way around a loop.
struct LoopStep {
  int joint = 0;
  int sign = 1;  ///< +1: passed from bodies[0] to bodies[1], -1: the other way
};

class MeshTree;

/// A mechanism prepared for computing: tree, loops, freedoms. Immutable after
/// compile(); share it between threads. Posture data live in Posture.
struct Model {
  Mechanism mechanism;
  double size = 1;                   ///< characteristic length [m]: half the spread of joint points
  Vector3 centre = Vector3::Zero();  ///< moments are taken about this point [m]
  std::vector<Freedom> freedoms;     ///< joint by joint, in the order of the file
  std::vector<int> first_freedom;    ///< per joint, index of its first freedom
  std::vector<int> drives;           ///< freedom indices, in the order of the file
  std::vector<int> parent_joint;     ///< per body: tree joint towards the base, -1 for the base
  std::vector<int> body_order;       ///< bodies from the base outwards
  Eigen::MatrixXi path;  ///< bodies × joints: +1/-1 when the joint lies on the body's tree path
  std::vector<LoopStep> platform_path;  ///< joints from the base to the platform along the tree
  std::vector<int> loop_joints;         ///< joints not in the tree: one loop each
  std::vector<std::vector<LoopStep>> loops;  ///< per loop joint: the joints met once around
  std::vector<std::shared_ptr<const MeshTree>> meshes;  ///< per shape; null for what is no mesh
};

/// Where everything is: joint coordinates from home, and the displacement of
/// every body from home about the base frame (identity at home).
struct Posture {
  Eigen::VectorXd q;  ///< one per freedom [m, rad]; spherical: unused (see balls)
  std::vector<Eigen::Quaterniond> balls;  ///< per joint: relative rotation of a spherical joint
  std::vector<Transform> bodies;          ///< displacement from home, per body
};

/// Prepares a mechanism for computing.
/// @throws std::invalid_argument when a body is not connected to the base.
/// @throws InputError for meshes where polyglide was built without FCL.
[[nodiscard]] Model compile(const Mechanism& mechanism);

/// The assembled posture in which the mechanism is described.
[[nodiscard]] Posture home(const Model& model);

/// Moves the posture by increments of all freedoms (a spherical joint's three
/// are rotations about base x, y, z) and updates the bodies through the tree.
void advance(const Model& model, Posture& posture, const Eigen::VectorXd& increments);

/// Screw of every freedom at the posture: twist of bodies[1] against bodies[0]
/// of its joint per unit rate, [w; v at the base origin], 6×F.
[[nodiscard]] Eigen::MatrixXd freedom_screws(const Model& model, const Posture& posture);

/// Twist of body `body` per unit rate of every freedom: 6×F, columns zero for
/// freedoms not on its tree path. [w; v at the base origin], base frame.
[[nodiscard]] Eigen::MatrixXd body_jacobian(const Model& model, const Posture& posture, int body);

/// The screws [w; v/size] at the centre, translations per `size`: what loop
/// closure is measured in.
[[nodiscard]] Eigen::MatrixXd scaled_screws(const Model& model, const Eigen::MatrixXd& screws);

/// Loop-closure Jacobian, 6L×F, scaled: rows [w; v/size] taken at the centre,
/// columns of translations per `size`. Kernel = instantaneous mobility.
[[nodiscard]] Eigen::MatrixXd closure_jacobian(const Model& model, const Posture& posture);

/// The same from freedom_screws() already at hand.
[[nodiscard]] Eigen::MatrixXd closure_jacobian(const Model& model, const Eigen::MatrixXd& screws);
[[nodiscard]] Eigen::MatrixXd body_jacobian(const Model& model, const Eigen::MatrixXd& screws,
                                            int body);

/// Closure error of every loop, scaled as the Jacobian's rows: [rotation vector;
/// displacement/size]. Zero when assembled.
[[nodiscard]] Eigen::VectorXd closure_residual(const Model& model, const Posture& posture);

/// Column scale of closure_jacobian: size for translations, 1 rad for rotations.
/// real increment = scaled increment × this.
[[nodiscard]] Eigen::VectorXd freedom_scale(const Model& model);

}  // namespace polyglide
