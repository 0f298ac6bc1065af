#include "kinematics/shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace polyglide {
namespace {

bool all_inside(const Probe& probe, const std::vector<Points>& parts) {
  return std::all_of(parts.begin(), parts.end(),
                     [&probe](const Points& part) { return probe.all_inside(part); });
}

/// Moves of bottom, top and radius, each with the axis shifted in 8 directions or not.
std::vector<Shape> with_shifts(const std::vector<std::array<double, 3>>& changes) {
  std::vector<Shape> moves;
  for (const auto& change : changes)
    for (int shift = 0; shift < 9; ++shift) {
      Shape move(5);
      move << (shift + 1) % 3 - 1, (shift / 3 + 1) % 3 - 1, change[0], change[1], change[2];
      moves.push_back(move);
    }
  return moves;
}

}  // namespace

Cylinder as_cylinder(const Shape& s) {
  return {2 * s[4], s[3] - s[2], {s[0], s[1], (s[2] + s[3]) / 2}};
}

Box as_box(const Shape& s) { return {s.tail<3>() - s.head<3>(), (s.head<3>() + s.tail<3>()) / 2}; }

Shape as_shape(const Cylinder& c) {
  Shape s(5);
  s << c.center.x(), c.center.y(), c.center.z() - c.height / 2, c.center.z() + c.height / 2,
      c.diameter / 2;
  return s;
}

Shape as_shape(const Box& box) {
  Shape s(6);
  s << box.center - box.size / 2, box.center + box.size / 2;
  return s;
}

Shape axis_point(const Shape& s) {
  Shape point(5);
  point << s[0], s[1], (s[2] + s[3]) / 2, (s[2] + s[3]) / 2, 0;
  return point;
}

Shape middle_of(const Shape& s) {
  Shape middle(6);
  middle << as_box(s).center, as_box(s).center;
  return middle;
}

Sphere as_sphere(const Shape& s) { return {2 * s[3], s.head<3>()}; }

Shape as_shape(const Sphere& sphere) {
  Shape s(4);
  s << sphere.center, sphere.diameter / 2;
  return s;
}

Shape centre_of(const Shape& s) {
  Shape centre(4);
  centre << s.head<3>(), 0;
  return centre;
}

bool is_box(const Shape& s) { return (s.tail<3>() - s.head<3>()).minCoeff() > 0; }

Surface cylinder_surface(const Density& density) {
  std::vector<Eigen::Vector2d> circle;
  for (int a = 0; a < density.angles; ++a) {
    const double angle = 2 * M_PI * a / density.angles;
    circle.emplace_back(std::cos(angle), std::sin(angle));
  }
  return [circle, density](const Shape& s) {
    std::vector<Points> parts(2);
    parts[0].reserve(2 * circle.size());
    parts[1].reserve(circle.size() * static_cast<std::size_t>(density.levels + density.rings + 2));
    const auto ring = [&](Points& part, double radius, double z, std::size_t stride) {
      for (std::size_t a = 0; a < circle.size(); a += stride)
        part.add({s[0] + radius * circle[a].x(), s[1] + radius * circle[a].y(), z});
    };
    for (double z : {s[2], s[3]}) {
      ring(parts[0], s[4], z, 1);
      ring(parts[1], 0, z, circle.size());
      for (int r = 1; r < density.rings; ++r) ring(parts[1], s[4] * r / density.rings, z, 2);
    }
    for (int l = 1; l < density.levels; ++l)
      ring(parts[1], s[4], s[2] + (s[3] - s[2]) * l / density.levels, 1);
    return parts;
  };
}

Surface box_surface(const Density& density) {
  return [n = density.parts](const Shape& s) {
    std::vector<Points> parts(2);
    parts[0].reserve(static_cast<std::size_t>(12 * n));
    parts[1].reserve(static_cast<std::size_t>(6 * n * n));
    for (int k = 0; k <= n; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
          const int outer = (i == 0 || i == n) + (j == 0 || j == n) + (k == 0 || k == n);
          if (outer == 0) continue;
          const Vector3 share = Vector3(i, j, k) / n;
          const Vector3 size = s.tail<3>() - s.head<3>();
          parts[outer >= 2 ? 0 : 1].add(s.head<3>() + share.cwiseProduct(size));
        }
    return parts;
  };
}

Surface sphere_surface(const Density& density) {
  std::vector<Vector3> directions;
  const double turn = M_PI * (3 - std::sqrt(5.0));
  for (int i = 0; i < density.places; ++i) {
    const double z = 1 - (2 * i + 1.0) / density.places, radius = std::sqrt(1 - z * z);
    directions.emplace_back(radius * std::cos(turn * i), radius * std::sin(turn * i), z);
  }
  return [directions](const Shape& s) {
    std::vector<Points> parts(2);  // a few all round find most failures
    for (std::size_t i = 0; i < directions.size(); ++i)
      parts[i % 8 == 0 ? 0 : 1].add(s.head<3>() + s[3] * directions[i]);
    return parts;
  };
}

std::function<bool(const Shape&)> cylinder_fits(const Probe& probe, const Density& density) {
  return [&probe, surface = cylinder_surface(density)](const Shape& s) {
    return s[3] >= s[2] && s[4] > 0 && all_inside(probe, surface(s));
  };
}

std::function<bool(const Shape&)> box_fits(const Probe& probe, const Density& density) {
  return [&probe, surface = box_surface(density)](const Shape& s) {
    return is_box(s) && all_inside(probe, surface(s));
  };
}

std::function<bool(const Shape&)> sphere_fits(const Probe& probe, const Density& density) {
  return [&probe, surface = sphere_surface(density)](const Shape& s) {
    return s[3] > 0 && all_inside(probe, surface(s));
  };
}

std::vector<Shape> height_moves() {
  return with_shifts(
      {{0, 1, 0}, {-1, 0, 0}, {-1, 1, 0}, {0, 0.2, 0}, {-0.2, 0, 0}, {1, 3, 0}, {-3, -1, 0}});
}

/// Growth, and trades of height for width.
std::vector<Shape> volume_moves() {
  return with_shifts({{0, 0, 1},
                      {0, 1, 0},
                      {-1, 0, 0},
                      {0, 0, 0.2},
                      {0, 0.2, 0},
                      {-0.2, 0, 0},
                      {0, 1, 1},
                      {-1, 0, 1},
                      {0, -1, 1},
                      {1, 0, 1},
                      {0, -3, 1},
                      {3, 0, 1},
                      {0, 2, -1},
                      {-2, 0, -1},
                      {0, 5, -1},
                      {-5, 0, -1}});
}

std::vector<Shape> box_moves() {
  std::vector<Shape> moves;
  const auto face = [](int f) {
    Shape move = Shape::Zero(6);
    move[f] = f < 3 ? -1 : 1;
    return move;
  };
  for (int f = 0; f < 6; ++f) moves.push_back(face(f));
  for (int axis = 0; axis < 3; ++axis) moves.push_back(face(axis) + face(axis + 3));
  for (int f = 0; f < 6; ++f)
    for (int other = 0; other < 6; ++other)
      if (other != f)
        for (double trade : {0.5, 1.0, 3.0}) moves.push_back(face(f) - trade * face(other));
  for (int axis = 0; axis < 3; ++axis)
    for (int other = 0; other < 3; ++other)
      if (other != axis)
        for (double trade : {0.5, 1.0, 2.0})
          moves.push_back(face(axis) + face(axis + 3) - trade * (face(other) + face(other + 3)));
  return moves;
}

std::vector<Shape> sphere_moves() {
  std::vector<Shape> moves;
  for (double growth : {1.0, 0.1})
    for (int shift = 0; shift < 27; ++shift) {
      Shape move(4);
      move << (shift + 1) % 3 - 1, (shift / 3 + 1) % 3 - 1, (shift / 9 + 1) % 3 - 1, growth;
      moves.push_back(move);
    }
  return moves;
}

}  // namespace polyglide
