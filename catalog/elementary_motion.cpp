#include "catalog/elementary_motion.hpp"

#include <Eigen/Geometry>

namespace polyglide {
namespace {

ElementaryMotion turn(const Vector3& axis, double pitch = 0) { return {false, axis, pitch}; }

ElementaryMotion shift(const Vector3& direction) { return {true, direction, 0}; }

/// A unit vector perpendicular to `axis`, the same for the same axis.
Vector3 perpendicular(const Vector3& axis) {
  int smallest = 0;
  axis.cwiseAbs().minCoeff(&smallest);
  return axis.cross(Vector3::Unit(smallest)).normalized();
}

}  // namespace

std::vector<ElementaryMotion> elementary_motions(const Joint& joint) {
  const Vector3& axis = joint.axes[0];
  switch (joint.type) {
    case JointType::revolute:
      return {turn(axis)};
    case JointType::prismatic:
      return {shift(axis)};
    case JointType::helical:
      return {turn(axis, joint.pitch)};
    case JointType::cylindrical:
      return {turn(axis), shift(axis)};
    case JointType::universal:
      return {turn(axis), turn(joint.axes[1])};
    case JointType::spherical:
      return {turn(Vector3::UnitX()), turn(Vector3::UnitY()), turn(Vector3::UnitZ())};
    case JointType::planar: {
      const Vector3 u = perpendicular(axis);
      return {shift(u), shift(axis.cross(u)), turn(axis)};
    }
    case JointType::weld:
      return {};
  }
  return {};
}

}  // namespace polyglide
