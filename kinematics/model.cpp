#include "kinematics/model.hpp"

#include <algorithm>

#include "catalog/elementary_motion.hpp"
#include "catalog/spanning_tree.hpp"
#include "kinematics/mesh_tree.hpp"

namespace polyglide {
namespace {

/// Unit twist about or along an axis through `point`.
Screw screw_of(const ElementaryMotion& motion, const Vector3& point) {
  Screw screw;
  if (motion.translation)
    screw << Vector3::Zero(), motion.axis;
  else
    screw << motion.axis, point.cross(motion.axis) + motion.pitch * motion.axis;
  return screw;
}

/// exp(q·screw): rotation about, and advance along, the screw's axis.
Transform exponential(const Screw& screw, double q) {
  Transform motion = Transform::Identity();
  const Vector3 w = screw.head<3>(), v = screw.tail<3>();
  if (w.isZero()) {
    motion.translation() = q * v;
    return motion;
  }
  // |w| = 1: v = point × w + pitch w, so point = w × v is the axis point nearest to the origin.
  const Vector3 point = w.cross(v);
  motion.linear() = Eigen::AngleAxisd(q, w).toRotationMatrix();
  motion.translation() = point - motion.linear() * point + q * w.dot(v) * w;
  return motion;
}

Transform rotation_about(const Eigen::Quaterniond& rotation, const Vector3& centre) {
  Transform motion = Transform::Identity();
  motion.linear() = rotation.toRotationMatrix();
  motion.translation() = centre - motion.linear() * centre;
  return motion;
}

/// Displacement of bodies[1] against bodies[0], in home coordinates.
Transform joint_motion(const Model& model, const Posture& posture, int joint) {
  const Joint& data = model.mechanism.joints[joint];
  if (data.type == JointType::spherical) return rotation_about(posture.balls[joint], data.at);
  const int first = model.first_freedom[joint], count = freedoms(data.type);
  if (count == 0) return Transform::Identity();
  Transform motion = exponential(model.freedoms[first].screw, posture.q[first]);
  for (int f = first + 1; f < first + count; ++f)
    motion = motion * exponential(model.freedoms[f].screw, posture.q[f]);
  return motion;
}

Screw transformed(const Transform& motion, const Screw& screw) {
  Screw result;
  result.head<3>() = motion.linear() * screw.head<3>();
  result.tail<3>() =
      motion.linear() * screw.tail<3>() + motion.translation().cross(result.head<3>());
  return result;
}

void place_bodies(const Model& model, Posture& posture) {
  for (int body : model.body_order) {
    const int joint = model.parent_joint[body];
    if (joint < 0) continue;
    const auto [first, second] = model.mechanism.joints[joint].bodies;
    const Transform motion = joint_motion(model, posture, joint);
    posture.bodies[body] =
        body == second ? posture.bodies[first] * motion : posture.bodies[second] * motion.inverse();
  }
}

/// Joints from the base to a body along the tree.
std::vector<LoopStep> path_to(const Model& model, int body) {
  std::vector<LoopStep> path;
  while (model.parent_joint[body] >= 0) {
    const int joint = model.parent_joint[body];
    const auto [first, second] = model.mechanism.joints[joint].bodies;
    path.push_back({joint, body == second ? 1 : -1});
    body = body == second ? first : second;
  }
  std::reverse(path.begin(), path.end());
  return path;
}

/// Once around: out to one body of the joint, through it, and back from the other. What
/// both ways share is left out.
std::vector<LoopStep> loop_of(const Model& model, int closing) {
  const auto [first, second] = model.mechanism.joints[closing].bodies;
  const std::vector<LoopStep> out = path_to(model, first), back = path_to(model, second);
  std::size_t shared = 0;
  while (shared < std::min(out.size(), back.size()) && out[shared].joint == back[shared].joint)
    ++shared;
  std::vector<LoopStep> loop(out.begin() + static_cast<std::ptrdiff_t>(shared), out.end());
  loop.push_back({closing, 1});
  for (std::size_t i = back.size(); i > shared; --i)
    loop.push_back({back[i - 1].joint, -back[i - 1].sign});
  return loop;
}

/// Notes the spanning tree and every body's path through it.
void build_tree(Model& model) {
  const Mechanism& mechanism = model.mechanism;
  SpanningTree tree = spanning_tree(mechanism);
  model.path = Eigen::MatrixXi::Zero(static_cast<Eigen::Index>(mechanism.bodies.size()),
                                     static_cast<Eigen::Index>(mechanism.joints.size()));
  for (int body : tree.body_order) {
    const int joint = tree.parent_joint[body];
    if (joint < 0) continue;
    model.path.row(body) = model.path.row(parent_body(mechanism, tree, body));
    model.path(body, joint) = body == mechanism.joints[joint].bodies[1] ? 1 : -1;
  }
  model.parent_joint = std::move(tree.parent_joint);
  model.body_order = std::move(tree.body_order);
  model.loop_joints = std::move(tree.loop_joints);
  model.platform_path = path_to(model, mechanism.platform);
  for (int joint : model.loop_joints) model.loops.push_back(loop_of(model, joint));
}

/// The centre and spread of the joint points. A prismatic joint's point is only
/// for drawing and must not influence a rank decision.
void measure(Model& model) {
  std::vector<Vector3> points;
  for (const Joint& joint : model.mechanism.joints)
    if (joint.type != JointType::prismatic && joint.type != JointType::weld)
      points.push_back(joint.at);
  if (points.empty()) points.push_back(model.mechanism.tool);
  model.centre.setZero();
  for (const Vector3& point : points) model.centre += point;
  model.centre /= static_cast<double>(points.size());
  double square = 0;
  for (const Vector3& point : points) square += (point - model.centre).squaredNorm();
  model.size = std::sqrt(square / static_cast<double>(points.size()));
  // Joints that meet in one point (spherical linkages) meet there as well as the drawing holds.
  double reach = model.mechanism.tool.norm();
  for (const Vector3& point : points) reach = std::max(reach, point.norm());
  constexpr double kDrawn = 1e-7;
  if (model.size > kDrawn * reach) return;
  model.size = (model.mechanism.tool - model.centre).norm();
  if (!(model.size > kDrawn * reach)) model.size = reach > 0 ? reach : 1;
}

}  // namespace

Model compile(const Mechanism& mechanism) {
  Model model;
  model.mechanism = mechanism;
  for (int j = 0; j < static_cast<int>(mechanism.joints.size()); ++j) {
    model.first_freedom.push_back(static_cast<int>(model.freedoms.size()));
    const Joint& joint = mechanism.joints[j];
    for (const ElementaryMotion& motion : elementary_motions(joint))
      model.freedoms.push_back({j, static_cast<int>(model.freedoms.size()) - model.first_freedom[j],
                                screw_of(motion, joint.at), motion.translation});
    for (int driven : joint.driven) model.drives.push_back(model.first_freedom.back() + driven);
  }
  for (const BodyShape& shape : mechanism.shapes)
    model.meshes.push_back(shape.mesh ? std::make_shared<const MeshTree>(*shape.mesh) : nullptr);
  build_tree(model);
  measure(model);
  return model;
}

Posture home(const Model& model) {
  Posture posture;
  posture.q = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.freedoms.size()));
  posture.balls.assign(model.mechanism.joints.size(), Eigen::Quaterniond::Identity());
  posture.bodies.assign(model.mechanism.bodies.size(), Transform::Identity());
  return posture;
}

void advance(const Model& model, Posture& posture, const Eigen::VectorXd& increments) {
  for (std::size_t j = 0; j < model.mechanism.joints.size(); ++j) {
    const Joint& joint = model.mechanism.joints[j];
    const int first = model.first_freedom[j];
    if (joint.type == JointType::spherical) {
      const Vector3 turn =
          posture.bodies[joint.bodies[0]].linear().transpose() * increments.segment<3>(first);
      const double angle = turn.norm();
      if (angle > 0)
        posture.balls[j] =
            (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * posture.balls[j])
                .normalized();
    } else {
      const int count = freedoms(joint.type);
      posture.q.segment(first, count) += increments.segment(first, count);
    }
  }
  place_bodies(model, posture);
}

Eigen::MatrixXd freedom_screws(const Model& model, const Posture& posture) {
  Eigen::MatrixXd screws(6, model.freedoms.size());
  for (std::size_t j = 0; j < model.mechanism.joints.size(); ++j) {
    const Joint& joint = model.mechanism.joints[j];
    const int first = model.first_freedom[j];
    const Transform& carrier = posture.bodies[joint.bodies[0]];
    if (joint.type == JointType::spherical) {
      const Vector3 centre = carrier * joint.at;
      for (int i = 0; i < 3; ++i)
        screws.col(first + i) = screw_of({false, Vector3::Unit(i), 0}, centre);
      continue;
    }
    Transform motion = carrier;
    const int count = freedoms(joint.type);
    for (int i = 0; i < count; ++i) {
      const Screw& screw = model.freedoms[first + i].screw;
      screws.col(first + i) = transformed(motion, screw);
      if (i + 1 < count) motion = motion * exponential(screw, posture.q[first + i]);
    }
  }
  return screws;
}

Eigen::MatrixXd body_jacobian(const Model& model, const Eigen::MatrixXd& screws, int body) {
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(6, screws.cols());
  for (std::size_t j = 0; j < model.mechanism.joints.size(); ++j) {
    const int sign = model.path(body, static_cast<Eigen::Index>(j));
    const int first = model.first_freedom[j], count = freedoms(model.mechanism.joints[j].type);
    if (sign != 0) jacobian.middleCols(first, count) = sign * screws.middleCols(first, count);
  }
  return jacobian;
}

Eigen::MatrixXd body_jacobian(const Model& model, const Posture& posture, int body) {
  return body_jacobian(model, freedom_screws(model, posture), body);
}

Eigen::VectorXd freedom_scale(const Model& model) {
  Eigen::VectorXd scale(model.freedoms.size());
  for (std::size_t f = 0; f < model.freedoms.size(); ++f)
    scale[f] = model.freedoms[f].translational ? model.size : 1;
  return scale;
}

Eigen::MatrixXd scaled_screws(const Model& model, const Eigen::MatrixXd& screws) {
  Eigen::MatrixXd scaled = screws;
  for (Eigen::Index f = 0; f < scaled.cols(); ++f) {
    const Vector3 w = scaled.col(f).head<3>();
    scaled.col(f).tail<3>() += w.cross(model.centre);
    scaled.col(f).tail<3>() /= model.freedoms[f].translational ? 1 : model.size;
  }
  return scaled;
}

Eigen::MatrixXd closure_jacobian(const Model& model, const Eigen::MatrixXd& screws) {
  const Eigen::MatrixXd scaled = scaled_screws(model, screws);
  Eigen::MatrixXd jacobian =
      Eigen::MatrixXd::Zero(6 * static_cast<Eigen::Index>(model.loops.size()), scaled.cols());
  Eigen::Index row = 0;
  for (const auto& loop : model.loops) {
    for (const auto [joint, sign] : loop) {
      const int first = model.first_freedom[joint];
      const int count = freedoms(model.mechanism.joints[joint].type);
      for (int f = first; f < first + count; ++f)
        jacobian.block<6, 1>(row, f) = sign * scaled.col(f);
    }
    row += 6;
  }
  return jacobian;
}

Eigen::MatrixXd closure_jacobian(const Model& model, const Posture& posture) {
  return closure_jacobian(model, freedom_screws(model, posture));
}

Eigen::VectorXd closure_residual(const Model& model, const Posture& posture) {
  const Eigen::Index loops = static_cast<Eigen::Index>(model.loop_joints.size());
  Eigen::VectorXd residual(6 * loops);
  for (Eigen::Index loop = 0; loop < loops; ++loop) {
    const int closing = model.loop_joints[loop];
    const auto [first, second] = model.mechanism.joints[closing].bodies;
    const Transform gap = posture.bodies[first] * joint_motion(model, posture, closing) *
                          posture.bodies[second].inverse();
    const Eigen::AngleAxisd turn(gap.linear());
    residual.segment<3>(6 * loop) = turn.angle() * turn.axis();
    residual.segment<3>(6 * loop + 3) = (gap * model.centre - model.centre) / model.size;
  }
  return residual;
}

}  // namespace polyglide
