// Simbody 3.7 does not compile as C++20, nor beside Eigen: this file does without both.
#include "engines/simbody_oracle.hpp"

#include <SimTKsimbody.h>

#include <stdexcept>

namespace polyglide::engines {
namespace {

using namespace SimTK;

Vec3 vec(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

/// A frame at the joint whose `along` axis lies on `axis`.
Transform frame(const PlainJoint& joint, const Vec3& axis, CoordinateAxis along) {
  return {Rotation(UnitVec3(axis), along), vec(joint.at)};
}

/// The same with the frame's x along `other`: coordinates in a plane.
Transform plane_frame(const PlainJoint& joint) {
  return {Rotation(UnitVec3(vec(joint.axis)), ZAxis, vec(joint.other), XAxis), vec(joint.at)};
}

class Builder {
 public:
  explicit Builder(const PlainMechanism& mechanism)
      : mechanism_(mechanism), matter_(system_), placed_(mechanism.bodies) {}

  ConstraintSystem ask() {
    build();
    State state = system_.realizeTopology();
    system_.realize(state, Stage::Velocity);
    ConstraintSystem answer;
    Matrix jacobian;
    matter_.calcG(state, jacobian);
    answer.rows = jacobian.nrow();
    answer.columns = state.getNU();
    for (int r = 0; r < answer.rows; ++r)
      for (int c = 0; c < answer.columns; ++c) answer.jacobian.push_back(jacobian(r, c));
    for (int i = 0; i < state.getNQErr(); ++i) answer.residual.push_back(state.getQErr()[i]);
    answer.row_is_length.assign(answer.rows, false);
    answer.column_is_length.assign(answer.columns, false);
    answer.column_is_driven.assign(answer.columns, false);
    for (const auto& [mobilizer, index] : drives_) {
      const auto& body = matter_.getMobilizedBody(mobilizer);
      answer.column_is_driven[body.getFirstUIndex(state) + index] = true;
    }
    ask_platform(state, answer);
    return answer;
  }

 private:
  void build() {
    placed_[mechanism_.base] = MobilizedBodyIndex(0);
    std::vector<int> queue{mechanism_.base};
    std::vector<bool> used(mechanism_.joints.size(), false);
    for (std::size_t next = 0; next < queue.size(); ++next) {
      for (std::size_t j = 0; j < mechanism_.joints.size(); ++j) {
        const PlainJoint& joint = mechanism_.joints[j];
        const int body = queue[next];
        if (joint.first != body && joint.second != body) continue;
        const int other = joint.first == body ? joint.second : joint.first;
        if (placed_[other].isValid()) continue;
        used[j] = true;
        placed_[other] = hang(placed_[body], joint, other == joint.first);
        queue.push_back(other);
      }
    }
    for (std::size_t j = 0; j < mechanism_.joints.size(); ++j)
      if (!used[j]) close(mechanism_.joints[j]);
  }

  /// A loop: the closing joint leads to an extra body, welded to the body beyond.
  void close(const PlainJoint& joint) {
    const MobilizedBodyIndex cut = hang(placed_[joint.first], joint, false);
    const Transform here(vec(joint.at));
    Constraint::Weld(matter_.updMobilizedBody(cut), here,
                     matter_.updMobilizedBody(placed_[joint.second]), here);
  }

  void drive(const PlainJoint& joint, int freedom, MobilizedBodyIndex mobilizer, int index) {
    for (int driven : joint.driven)
      if (driven == freedom) drives_.emplace_back(mobilizer, index);
  }

  MobilizedBodyIndex pin(MobilizedBodyIndex inner, const PlainJoint& joint, const Vec3& axis) {
    const Transform at = frame(joint, axis, ZAxis);
    return MobilizedBody::Pin(matter_.updMobilizedBody(inner), at, body_, at);
  }

  /// Hangs a body whose frame is the base frame at home. A joint's set of displacements
  /// is the same from either side, except that a universal joint's axes change places.
  MobilizedBodyIndex hang(MobilizedBodyIndex inner, const PlainJoint& joint, bool reversed) {
    MobilizedBody& parent = matter_.updMobilizedBody(inner);
    const Vec3 axis = vec(joint.axis);
    const Transform z = joint.kind == "spherical" || joint.kind == "weld"
                            ? Transform(vec(joint.at))
                            : frame(joint, axis, ZAxis);
    MobilizedBodyIndex outer;
    if (joint.kind == "revolute") {
      outer = pin(inner, joint, axis);
      drive(joint, 0, outer, 0);
    } else if (joint.kind == "prismatic") {
      const Transform x = frame(joint, axis, XAxis);
      outer = MobilizedBody::Slider(parent, x, body_, x);
      drive(joint, 0, outer, 0);
    } else if (joint.kind == "helical") {
      outer = MobilizedBody::Screw(parent, z, body_, z, joint.pitch);
      drive(joint, 0, outer, 0);
    } else if (joint.kind == "cylindrical") {
      outer = MobilizedBody::Cylinder(parent, z, body_, z);
      drive(joint, 0, outer, 0);
      drive(joint, 1, outer, 1);
    } else if (joint.kind == "universal") {
      const Vec3 other = vec(joint.other);
      const MobilizedBodyIndex cross = pin(inner, joint, reversed ? other : axis);
      outer = pin(cross, joint, reversed ? axis : other);
      drive(joint, 0, reversed ? outer : cross, 0);
      drive(joint, 1, reversed ? cross : outer, 0);
    } else if (joint.kind == "spherical") {
      outer = MobilizedBody::Ball(parent, z, body_, z);
      for (int i = 0; i < 3; ++i) drive(joint, i, outer, i);
    } else if (joint.kind == "planar") {
      const Transform plane = plane_frame(joint);
      outer = MobilizedBody::Planar(parent, plane, body_, plane);
      drive(joint, 0, outer, 1);  // Simbody's planar: angle, x, y
      drive(joint, 1, outer, 2);
      drive(joint, 2, outer, 0);
    } else if (joint.kind == "weld") {
      outer = MobilizedBody::Weld(parent, z, body_, z);
    } else {
      throw std::invalid_argument("simbody_at_home: no such joint kind: " + joint.kind);
    }
    return outer;
  }

  void ask_platform(const State& state, ConstraintSystem& answer) const {
    Matrix jacobian;
    matter_.calcFrameJacobian(state, placed_[mechanism_.platform], vec(mechanism_.tool), jacobian);
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < answer.columns; ++c) answer.platform.push_back(jacobian(r, c));
  }

  const PlainMechanism& mechanism_;
  MultibodySystem system_;
  SimbodyMatterSubsystem matter_;
  Body::Rigid body_{MassProperties(1, Vec3(0), Inertia(1))};
  std::vector<MobilizedBodyIndex> placed_;                  ///< per body of the mechanism
  std::vector<std::pair<MobilizedBodyIndex, int>> drives_;  ///< mobilizer and speed within it
};

}  // namespace

ConstraintSystem simbody_at_home(const PlainMechanism& mechanism) {
  return Builder(mechanism).ask();
}

}  // namespace polyglide::engines
