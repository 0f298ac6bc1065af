#include "kinematics/krawczyk_root.hpp"

// Platforms placed by distances.
namespace polyglide {
namespace {

/// Where the crank carries its rod's joint. Any point of the axis will do as its centre.
IntervalVector on_crank(const Leg& leg, double drive) {
  IntervalVector centre, crank;
  for (int i = 0; i < 3; ++i) {
    centre[i] = leg.centre[i];
    crank[i] = Interval(leg.base_point[i]) - centre[i];
  }
  IntervalVector result = turned(rotation_about(unit_axis(leg.direction), Interval(drive)), crank);
  for (int i = 0; i < 3; ++i) result[i] += centre[i];
  return result;
}

/// |R p + t - centre|² = radius², p from the tool.
struct Distance {
  IntervalVector arm, centre;
  Interval radius;
};

Distance distance_of(const Machine& machine, const Leg& leg, double drive) {
  const Vector3& tool = machine.model.mechanism.tool;
  const IntervalVector p = vector_of(leg.platform_point), b = vector_of(leg.base_point);
  Distance result;
  IntervalVector place = b;
  if (leg.kind == Leg::Kind::crank_rod) place = on_crank(leg, drive);
  for (int i = 0; i < 3; ++i) {
    result.arm[i] = p[i] - tool[i];
    if (leg.kind == Leg::Kind::guide_rod) place[i] += Interval(drive) * leg.direction[i];
    result.centre[i] = place[i] - tool[i];
  }
  // Lengths are those of the file's points, not of their rounded distance.
  result.radius = root(squared_norm({p[0] - b[0], p[1] - b[1], p[2] - b[2]}));
  if (leg.kind == Leg::Kind::strut) result.radius += drive;
  return result;
}

}  // namespace

ModeCertificate certify_pose(const Machine& machine, const std::vector<int>& legs,
                             const Eigen::VectorXd& drives, const Pose& pose,
                             bool translations_only) {
  const int n = translations_only ? 3 : 6;
  if (static_cast<int>(legs.size()) != n || !pose.position.allFinite()) return {};
  const UpwardRounding rounding;
  const double size = machine.model.size;
  std::vector<Distance> distances;
  for (int index : legs) {
    const Leg& leg = machine.legs->legs[index];
    distances.push_back(distance_of(machine, leg, drives[leg.drive]));
  }
  const IntervalRotation at = rotation_of(pose.rotation);
  const auto enclose = [&](const std::vector<Interval>& box) {
    Enclosure result{std::vector<Interval>(n), IntervalMatrix(n, n)};
    std::array<IntervalVector, 3> axes;
    IntervalRotation turn = at;
    if (n == 6) {
      const TurnByAngles by = turn_by({box[3], box[4], box[5]});
      turn = product(by.rotation, at);
      axes = by.axes;
    }
    for (int i = 0; i < n; ++i) {
      const IntervalVector arm = turned(turn, distances[i].arm);
      IntervalVector gap;
      for (int k = 0; k < 3; ++k)
        gap[k] = arm[k] + (pose.position[k] + box[k] * size) - distances[i].centre[k];
      result.values[i] = (squared_norm(gap) - square(distances[i].radius)) / (size * size);
      for (int k = 0; k < n; ++k)
        result.jacobian(i, k) =
            k < 3 ? 2.0 * gap[k] / size : 2.0 * dot(gap, cross(axes[k - 3], arm)) / (size * size);
    }
    return result;
  };
  return prove_root(n, enclose);
}

}  // namespace polyglide
