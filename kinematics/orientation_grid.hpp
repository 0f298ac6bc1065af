#pragma once

#include <string>
#include <vector>

#include "kinematics/orientation_set.hpp"
#include "kinematics/region.hpp"

namespace polyglide {

/// A rotation as azimuth, tilt, torsion [rad]; see turned().
struct Tilted {
  double azimuth = 0, tilt = 0, torsion = 0;
};

/// Asks a probe about rotations at one place; at most 2^17 at a time.
class Turner {
 public:
  Turner(const Probe& probe, const Vector3& at) : probe_(probe), at_(at) {}
  /// Per rotation: -1 inside, else the index of the limit.
  [[nodiscard]] std::vector<int> ask(const std::vector<Tilted>& rotations) const;
  /// Where each rotation's tilt ends between `free`, inside, and `stopped`, not: by bisection to
  /// 1e-6 rad; moves both, and gives the limits met.
  [[nodiscard]] std::vector<int> bisect(const std::vector<Tilted>& lines, std::vector<double>& free,
                                        std::vector<double>& stopped) const;
  /// The first end of tilting from 0 in steps: the tilts, and the limits (-1: none up to `most`).
  /// A line stopped at 0 has tilt 0.
  [[nodiscard]] std::vector<int> first_ends(const std::vector<Tilted>& lines, double step,
                                            double most, std::vector<double>& tilts) const;
  [[nodiscard]] const Probe& probe() const { return probe_; }

 private:
  const Probe& probe_;
  Vector3 at_;
};

/// Interval of tilts on a line of the grid, with the limits that end it (-1: none).
struct TiltInterval {
  double from = 0, to = 0;
  int from_limit = -1, to_limit = -1;
};

/// Grid of azimuth × tilt × torsion round home's orientation. Tilts lie in the middle of
/// their steps, so that going on past no tilt leads to the opposite azimuth.
class OrientationGrid {
 public:
  /// @param azimuths even; @param torsions 1, or even: then the torsion is periodic
  OrientationGrid(int azimuths, int tilts, int torsions, double most);

  /// Marks the nodes inside that are connected with home's orientation, level by level; asks
  /// only about those and their neighbours.
  void flood(const Turner& turner);

  /// The intervals inside of one line, ended by bisection, for all azimuths of all torsions
  /// (torsion slowest).
  [[nodiscard]] std::vector<std::vector<TiltInterval>> intervals(const Turner& turner) const;

  [[nodiscard]] Tilted line(std::size_t number) const;  ///< tilt 0
  [[nodiscard]] std::size_t lines() const;
  [[nodiscard]] int azimuths() const { return azimuths_; }
  [[nodiscard]] int torsions() const { return torsions_; }
  [[nodiscard]] double step() const { return step_; }

 private:
  enum State : char { unknown, in, out };
  [[nodiscard]] std::size_t node(int azimuth, int tilt, int torsion) const;
  [[nodiscard]] double tilt_of(int tilt) const { return (tilt + 0.5) * step_; }
  [[nodiscard]] std::vector<std::size_t> neighbours(std::size_t node) const;

  int azimuths_, tilts_, torsions_;
  double most_, step_;
  std::vector<char> state_;
  std::vector<int> limit_;
};

}  // namespace polyglide
