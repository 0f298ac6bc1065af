#pragma once

#include <string>
#include <vector>

#include "kinematics/shapes.hpp"

namespace polyglide {

/// Why a shape that was found inside a region is believed to be inside, and to be no larger.
struct ShapeEvidence {
  std::size_t places = 0;   ///< asked, on the surface and within
  double spacing = 0;       ///< [m] of neighbouring places on the surface, at most about this
  std::size_t outside = 0;  ///< of the places asked; more than none: a hole within the shape
  /// A limit that stops the shape from growing, and where.
  struct Touch {
    std::string limit;
    Vector3 at = Vector3::Zero();
  };
  std::vector<Touch> touches;
};

/// Asks densely on the surface of a shape and on smaller copies of it within, and grows it evenly
/// until limits stop it: by the smallest part of its size at which one does, from 1/4096 on,
/// all that stop it there. Empty for shapes without extent.
[[nodiscard]] ShapeEvidence evidence_for(const Probe& probe, const Cylinder& cylinder);
[[nodiscard]] ShapeEvidence evidence_for(const Probe& probe, const Box& box);
[[nodiscard]] ShapeEvidence evidence_for(const Probe& probe, const Sphere& sphere);

}  // namespace polyglide
