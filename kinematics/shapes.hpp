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

/// Shapes as numbers. A cylinder: x, y, bottom, top, radius. A box: its lower and upper corner.
[[nodiscard]] Shape as_shape(const Cylinder& cylinder);
[[nodiscard]] Shape as_shape(const Box& box);
[[nodiscard]] Cylinder as_cylinder(const Shape& shape);
[[nodiscard]] Box as_box(const Shape& shape);
[[nodiscard]] bool is_box(const Shape& shape);  ///< no edge turned inside out

/// What a cylinder or a box shrinks to.
[[nodiscard]] Shape axis_point(const Shape& cylinder);
[[nodiscard]] Shape middle_of(const Shape& box);

/// How densely a surface is asked about.
struct Density {
  int angles, levels, rings;  ///< of a cylinder
  int parts;                  ///< of each edge of a box
};
inline constexpr Density kCoarse{40, 6, 3, 6}, kDense{120, 16, 6, 20};

/// Tests whether the surface of a cylinder or box lies inside. `probe` must outlive them.
[[nodiscard]] std::function<bool(const Shape&)> cylinder_fits(const Probe& probe,
                                                              const Density& density);
[[nodiscard]] std::function<bool(const Shape&)> box_fits(const Probe& probe,
                                                         const Density& density);

/// Moves for climb(): of a cylinder's height and place; of all of it; of a box's faces.
[[nodiscard]] std::vector<Shape> height_moves();
[[nodiscard]] std::vector<Shape> volume_moves();
[[nodiscard]] std::vector<Shape> box_moves();

}  // namespace polyglide
