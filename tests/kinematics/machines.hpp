#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catalog/catalog.hpp"
#include "catalog/json_file.hpp"
#include "kinematics/solve.hpp"

// Small machines built by hand, so that the tests of this floor do not lean on the catalog's data
// alone.
namespace polyglide::fixtures {

inline Joint joint_of(const std::string& name, JointType type, int first, int second,
                      const Vector3& at, const Vector3& axis = Vector3::UnitZ()) {
  Joint joint;
  joint.name = name;
  joint.type = type;
  joint.bodies = {first, second};
  joint.at = at;
  joint.axes[0] = axis;
  return joint;
}

struct Limb {
  Vector3 carriage, guide, platform;
  Range stroke;
};

/// Base 0, platform 1, per limb a carriage and a rod with balls at both ends.
inline Mechanism guided(const std::vector<Limb>& limbs, const Vector3& tool = Vector3::Zero()) {
  Mechanism mechanism;
  mechanism.name = "guided";
  mechanism.bodies = {"base", "platform"};
  mechanism.platform = 1;
  mechanism.tool = tool;
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const std::string leg = "leg" + std::to_string(i + 1);
    const int carriage = static_cast<int>(mechanism.bodies.size());
    mechanism.bodies.push_back(leg + ".carriage");
    mechanism.bodies.push_back(leg + ".rod");
    Joint guide = joint_of(leg + ".guide", JointType::prismatic, 0, carriage, limbs[i].carriage,
                           limbs[i].guide.normalized());
    guide.driven = {0};
    guide.range = {limbs[i].stroke};
    mechanism.joints.push_back(guide);
    mechanism.joints.push_back(
        joint_of(leg + ".top", JointType::spherical, carriage, carriage + 1, limbs[i].carriage));
    mechanism.joints.push_back(
        joint_of(leg + ".bottom", JointType::spherical, carriage + 1, 1, limbs[i].platform));
  }
  return mechanism;
}

/// Base 0, platform 1 and per point of it an equal rod with balls at both ends, which reaches
/// `rod` from the base to the point. Nothing is driven.
inline Mechanism table_on_rods(const std::vector<Vector3>& points, const Vector3& rod) {
  Mechanism mechanism;
  mechanism.name = "table on rods";
  mechanism.bodies = {"base", "platform"};
  mechanism.platform = 1;
  for (const Vector3& point : points) {
    const std::string name = "rod" + std::to_string(mechanism.bodies.size() - 1);
    const int body = static_cast<int>(mechanism.bodies.size());
    mechanism.bodies.push_back(name);
    mechanism.joints.push_back(
        joint_of(name + ".base", JointType::spherical, 0, body, point - rod));
    mechanism.joints.push_back(joint_of(name + ".top", JointType::spherical, body, 1, point));
  }
  return mechanism;
}

/// Base 0, platform 1, per limb a driven telescope with balls at both ends.
inline Mechanism strutted(const std::vector<std::pair<Vector3, Vector3>>& limbs,
                          const Range& stroke = {}) {
  Mechanism mechanism;
  mechanism.name = "strutted";
  mechanism.bodies = {"base", "platform"};
  mechanism.platform = 1;
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const std::string leg = "leg" + std::to_string(i + 1);
    const int lower = static_cast<int>(mechanism.bodies.size());
    mechanism.bodies.push_back(leg + ".lower");
    mechanism.bodies.push_back(leg + ".upper");
    const auto& [foot, head] = limbs[i];
    mechanism.joints.push_back(joint_of(leg + ".base", JointType::spherical, 0, lower, foot));
    Joint slide = joint_of(leg + ".strut", JointType::prismatic, lower, lower + 1, foot,
                           (head - foot).normalized());
    slide.driven = {0};
    slide.range = {stroke};
    mechanism.joints.push_back(slide);
    mechanism.joints.push_back(
        joint_of(leg + ".platform", JointType::spherical, lower + 1, 1, head));
  }
  return mechanism;
}

inline TaskSpace task_of(std::vector<int> axes) {
  TaskSpace task;
  for (int axis : axes) ++(axis < 3 ? task.translations : task.rotations);
  task.axes = std::move(axes);
  task.pure = true;
  return task;
}

/// Three perpendicular guides, rods of length `rod` along them at home, J = identity there.
inline Mechanism orthoglide(double rod, const Range& stroke = {}) {
  std::vector<Limb> limbs;
  for (int axis = 0; axis < 3; ++axis)
    limbs.push_back({rod * Vector3::Unit(axis), Vector3::Unit(axis), Vector3::Zero(), stroke});
  return guided(limbs);
}

/// Three vertical guides at radius `e` beyond the platform's, carriages above,
/// strokes from z = 0 to `height`, home at z = `home` on the axis.
inline Mechanism linear_delta(double e, double rod, double height, double home) {
  std::vector<Limb> limbs;
  const double rise = std::sqrt(rod * rod - e * e);
  for (int leg = 0; leg < 3; ++leg) {
    const double angle = M_PI / 2 + leg * 2 * M_PI / 3;
    const Vector3 out(std::cos(angle), std::sin(angle), 0);
    const double carriage = home + rise;
    limbs.push_back({e * out + Vector3(0, 0, carriage),
                     Vector3::UnitZ(),
                     Vector3(0, 0, home),
                     {-carriage, height - carriage}});
  }
  return guided(limbs, Vector3(0, 0, home));
}

/// The tool may be anywhere in a prism: planes normal·p <= offset around an almost
/// Cartesian machine, for which shapes are known exactly.
inline Machine prism(const std::vector<HalfSpaceLimit::Plane>& planes) {
  Mechanism mechanism = orthoglide(50);
  mechanism.limits.push_back({"prism", 1, {Vector3::Zero()}, planes});
  return prepare(mechanism, task_of({0, 1, 2}));
}

/// A prism of 0.4 × 0.4 × 0.2 m³ about (0.1, 0, 0.05) m.
inline Machine block() {
  return prism({{Vector3::UnitX(), 0.3},
                {-Vector3::UnitX(), 0.1},
                {Vector3::UnitY(), 0.2},
                {-Vector3::UnitY(), 0.2},
                {Vector3::UnitZ(), 0.15},
                {-Vector3::UnitZ(), 0.05}});
}

inline Machine catalog_machine(const std::string& name) {
  return prepare(expand(find_layout(name)));
}

inline nlohmann::json truth() {
  return read_json(POLYGLIDE_SOURCE_DIR "/tests/truth/workspace_conditioning_stiffness.json");
}

/// Repeatable uniform numbers in [-1, 1).
class Uniform {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
  }
  Vector3 vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }

 private:
  std::uint64_t state_ = 42;
};

}  // namespace polyglide::fixtures
