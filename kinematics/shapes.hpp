#pragma once

#include "kinematics/pattern_search.hpp"
#include "kinematics/region.hpp"

namespace polyglide {

/// Upright cylinder of tool displacements.
struct Cylinder {
  double diameter = 0, height = 0;  ///< [m], axis vertical
  Vector3 center = Vector3::Zero();
};

/// Box of tool displacements, edges along base x, y, z.
struct Box {
  Vector3 size = Vector3::Zero();  ///< [m]
  Vector3 center = Vector3::Zero();
};

/// Ball of tool displacements.
struct Sphere {
  double diameter = 0;  ///< [m]
  Vector3 center = Vector3::Zero();
};

/// Shapes as numbers. A cylinder: x, y, bottom, top, radius. A box: its lower and upper corner. A
/// sphere: x, y, z, radius.
[[nodiscard]] Shape as_shape(const Cylinder& cylinder);
[[nodiscard]] Shape as_shape(const Box& box);
[[nodiscard]] Shape as_shape(const Sphere& sphere);
[[nodiscard]] Cylinder as_cylinder(const Shape& shape);
[[nodiscard]] Box as_box(const Shape& shape);
[[nodiscard]] Sphere as_sphere(const Shape& shape);
[[nodiscard]] bool is_box(const Shape& shape);  ///< no edge turned inside out

/// What a cylinder, a box or a sphere shrinks to.
[[nodiscard]] Shape axis_point(const Shape& cylinder);
[[nodiscard]] Shape middle_of(const Shape& box);
[[nodiscard]] Shape centre_of(const Shape& sphere);

/// How densely a surface is asked about.
struct Density {
  int angles, levels, rings;  ///< of a cylinder
  int parts;                  ///< of each edge of a box
  int places;                 ///< of a sphere
};
inline constexpr Density kRough{12, 3, 1, 2, 32}, kCoarse{40, 6, 3, 6, 200},
    kDense{120, 16, 6, 20, 2400}, kFinest{480, 64, 24, 80, 40000};

/// Places on the surface of a shape, those that fail first before the rest.
using Surface = std::function<std::vector<Points>(const Shape&)>;
[[nodiscard]] Surface cylinder_surface(const Density& density);
[[nodiscard]] Surface box_surface(const Density& density);
[[nodiscard]] Surface sphere_surface(const Density& density);  ///< a spiral of even spacing

/// Tests whether the surface of a shape lies inside. `probe` must outlive them.
[[nodiscard]] std::function<bool(const Shape&)> cylinder_fits(const Probe& probe,
                                                              const Density& density);
[[nodiscard]] std::function<bool(const Shape&)> box_fits(const Probe& probe,
                                                         const Density& density);
[[nodiscard]] std::function<bool(const Shape&)> sphere_fits(const Probe& probe,
                                                            const Density& density);

/// Moves for climb(): of a cylinder's height and place; of all of it; of a box's faces; of a
/// sphere.
[[nodiscard]] std::vector<Shape> height_moves();
[[nodiscard]] std::vector<Shape> volume_moves();
[[nodiscard]] std::vector<Shape> box_moves();
[[nodiscard]] std::vector<Shape> sphere_moves();

}  // namespace polyglide
