#include "kinematics/shape_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace polyglide {
namespace {

constexpr double kWithin[] = {0.75, 0.5, 0.25};  // sizes of the copies asked within

/// A shape grown by a length to every side; negative lengths shrink it.
using Grow = std::function<Shape(double by)>;

std::vector<ShapeEvidence::Touch> touches_of(const Probe& probe, const std::vector<Points>& parts) {
  std::vector<ShapeEvidence::Touch> touches;
  for (const Points& points : parts) {
    const Probe::Answers answers = probe.ask(points, false);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool beyond = probe.beyond_reach(points[i]);
      if (answers.inside(i) && !beyond) continue;
      const std::string& limit = probe.names()[beyond ? probe.search_box() : answers.limit[i]];
      if (std::none_of(touches.begin(), touches.end(),
                       [&](const auto& touch) { return touch.limit == limit; }))
        touches.push_back({limit, points[i]});
    }
  }
  return touches;
}

/// @param half half the least extent of the shape [m]
ShapeEvidence gather(const Probe& probe, const Surface& surface, double half, double spacing,
                     const Grow& grow) {
  ShapeEvidence evidence;
  if (!(half > 0)) return evidence;
  evidence.spacing = spacing;
  const auto ask = [&](double by) {
    for (const Points& points : surface(grow(by))) {
      const Probe::Answers answers = probe.ask(points, false);
      evidence.places += points.size();
      for (std::size_t i = 0; i < points.size(); ++i) evidence.outside += !answers.inside(i);
    }
  };
  ask(0);
  for (double size : kWithin) ask((size - 1) * half);
  for (double by = half / 4096; by <= half && evidence.touches.empty(); by *= 2)
    evidence.touches = touches_of(probe, surface(grow(by)));
  return evidence;
}

const Density& density_for(const Probe& probe) {
  return probe.evaluator().closed_form() ? kFinest : kRough;
}

}  // namespace

ShapeEvidence evidence_for(const Probe& probe, const Cylinder& cylinder) {
  const Density& density = density_for(probe);
  const double radius = cylinder.diameter / 2;
  const double spacing = std::max({2 * M_PI * radius / density.angles,
                                   cylinder.height / density.levels, radius / density.rings});
  return gather(probe, cylinder_surface(density), std::min(radius, cylinder.height / 2), spacing,
                [&](double by) {
                  return as_shape(Cylinder{cylinder.diameter + 2 * by, cylinder.height + 2 * by,
                                           cylinder.center});
                });
}

ShapeEvidence evidence_for(const Probe& probe, const Box& box) {
  const Density& density = density_for(probe);
  return gather(probe, box_surface(density), box.size.minCoeff() / 2,
                box.size.maxCoeff() / density.parts, [&](double by) {
                  return as_shape(Box{box.size + Vector3::Constant(2 * by), box.center});
                });
}

ShapeEvidence evidence_for(const Probe& probe, const Sphere& sphere) {
  const Density& density = density_for(probe);
  // A place of the spiral stands for an even share of the area.
  const double spacing = sphere.diameter * std::sqrt(M_PI / density.places);
  return gather(probe, sphere_surface(density), sphere.diameter / 2, spacing, [&](double by) {
    return as_shape(Sphere{sphere.diameter + 2 * by, sphere.center});
  });
}

}  // namespace polyglide
