#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "kinematics/largest_disc.hpp"
#include "kinematics/shapes.hpp"

namespace polyglide {

/// Finds shapes that lie wholly inside a region.
///
/// For every interval of grid layers the layers are intersected, and the largest
/// disc (distance transform) and the maximal rectangles (histogram) of the
/// intersection found. The best of all is then improved by pattern search over
/// exact poses on its surface, and shrunk until a dense set of them is inside. A
/// hole smaller than a grid step inside a shape is not seen.
/// Spheres start from the largest balls of the grid (distance transform), and the best is kept.
/// Machines without closed form keep the shape that the grid shows, shrunk until a rough
/// test of its surface passes. A machine
/// without three translations, or an empty region, has no shapes.
class Inscriber {
 public:
  /// @param probe, region must outlive this.
  Inscriber(const Probe& probe, const Region& region);

  /// Largest volume; zero when there is none.
  [[nodiscard]] Cylinder largest_cylinder() const;
  [[nodiscard]] Box largest_box() const;
  [[nodiscard]] Sphere largest_sphere() const;

  /// The tallest cylinder for a round series of diameters, up to the widest that fits.
  [[nodiscard]] std::vector<Cylinder> tallest_cylinders() const;

  /// A place where a given shape fits, nullopt when none is found.
  [[nodiscard]] std::optional<Cylinder> place(double diameter, double height) const;
  [[nodiscard]] std::optional<Box> place(const Vector3& size) const;

 private:
  /// Layers low..high of the grid, the nodes inside in all of them, and the largest disc there.
  struct Interval {
    int low = 0, high = 0;
    std::vector<char> mask;
    GridDisc disc;
  };
  using CylinderGain = std::function<double(double radius, double height)>;
  using BoxGain = std::function<double(const Vector3& size)>;

  void add_intervals();
  [[nodiscard]] const Interval* best_interval(const CylinderGain& gain) const;
  [[nodiscard]] Cylinder grid_cylinder(const Interval& interval) const;
  [[nodiscard]] Shape polish(const GridBall& ball) const;
  [[nodiscard]] Cylinder tallest(double diameter, double enough) const;
  [[nodiscard]] std::optional<Box> best_box(const BoxGain& gain, double enough) const;
  [[nodiscard]] std::optional<Box> best_rectangle(const BoxGain& gain) const;

  const Probe& probe_;
  NodeGrid grid_;  ///< the region's, thinned: it only gives starting places
  std::vector<char> inside_;
  std::vector<Interval> intervals_;
};

}  // namespace polyglide
