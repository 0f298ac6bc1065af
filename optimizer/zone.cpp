#include "optimizer/zone.hpp"

#include <cmath>
#include <numbers>

namespace polyglide {
namespace {

constexpr double kPi = std::numbers::pi;

/// i-th of n places from -1 to 1; the middle when there is one.
double place(int i, int n) { return n > 1 ? -1 + 2.0 * i / (n - 1) : 0; }

/// Unit square [-1, 1]² onto the unit disc, rings of squares onto circles.
Eigen::Vector2d on_disc(double u, double v) {
  if (u == 0 && v == 0) return Eigen::Vector2d::Zero();
  const bool u_leads = std::abs(u) > std::abs(v);
  const double radius = u_leads ? u : v;
  const double angle = u_leads ? kPi / 4 * (v / u) : kPi / 2 - kPi / 4 * (u / v);
  return radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

Eigen::Matrix3d zone_frame(const Vector3& axis) {
  const bool level = std::abs(axis.z()) < 1e-6 && axis.norm() > 0.5;
  const double heading = level ? std::atan2(axis.y(), axis.x()) : 0;
  return Eigen::AngleAxisd(heading, Vector3::UnitZ()).toRotationMatrix();
}

}  // namespace

double volume(const Zone& zone) {
  return zone.size.prod() * (zone.shape == Zone::Shape::cylinder ? kPi / 4 : 1);
}

double lever(const Zone& zone) { return (zone.size.x() + zone.size.y()) / 4; }

std::vector<Vector3> zone_positions(const Zone& zone, const Vector3& axis, int across, int up) {
  const Eigen::Matrix3d frame = zone_frame(axis);
  std::vector<Vector3> positions;
  positions.reserve(static_cast<std::size_t>(across) * across * up);
  for (int k = 0; k < up; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i) {
        Eigen::Vector2d plan(place(i, across), place(j, across));
        if (zone.shape == Zone::Shape::cylinder) plan = on_disc(plan.x(), plan.y());
        const Vector3 share(plan.x(), plan.y(), place(k, up));
        positions.push_back(frame * share.cwiseProduct(zone.size / 2));
      }
  return positions;
}

std::vector<Eigen::Quaterniond> zone_turns(const Zone& zone, const TaskSpace& task, int steps) {
  std::vector<Eigen::Quaterniond> turns{Eigen::Quaterniond::Identity()};
  if (zone.tilt <= 0) return turns;
  std::vector<Vector3> axes{task.rotation_axis};
  if (task.rotations > 1) axes = {Vector3::UnitX(), Vector3::UnitY()};
  for (const Vector3& axis : axes)
    for (int step = 1; step <= steps; ++step)
      for (const int side : {-1, 1})
        turns.emplace_back(Eigen::AngleAxisd(side * zone.tilt * step / steps, axis));
  return turns;
}

}  // namespace polyglide
