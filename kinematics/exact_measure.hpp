#pragma once

#include <functional>
#include <optional>

#include "kinematics/line_limits.hpp"

namespace polyglide {

/// Size of a workspace by quadrature over its own pieces.
struct ExactMeasure {
  double value = 0;       ///< [m³], or [m²] for planar machines
  double error = 0;       ///< estimate, of the quadrature and of what lies between pieces
  bool reached = false;   ///< error <= tolerance × value
  int parts = 0;          ///< connected parts seen, the one measured among them
  std::size_t lines = 0;  ///< examined
  Bounds extent;          ///< where any part was seen, in the frame of the lines
};

struct ExactSearch {
  double tolerance = 1e-6;         ///< relative
  std::size_t lines = 20'000'000;  ///< most lines to examine
  std::function<void()> working;   ///< called now and then, from any thread; may be empty
};

/// Volume (area) of the part of a workspace that holds `inside`: lengths of lines, whose ends are
/// roots of polynomials, integrated over a plane of lines and then over the planes. Where other
/// limits take over from those that end the spans, the integrand has a kink: such places are found
/// by bisection, and each piece between two of them is smooth up to square roots at its ends, which
/// a substitution takes away, so Gauss–Kronrod rules converge fast. What is thinner than the first
/// planes and lines are apart (1/64 and 1/160 of the extent, 1/320 below a tolerance of 1e-6) and
/// touches none of them can be missed. nullopt
/// when no piece holds `inside`, or when the pieces are too many.
/// @param inside a place well inside, base frame. @param extent where lines are laid, in the frame
/// of the lines. @param size about what will come out: errors are judged by it; when
/// it is too large, or the extent more than twice what is found, another turn is taken. Same bits
/// for any number of threads.
[[nodiscard]] std::optional<ExactMeasure> measure_exactly(const LineLimits& limits,
                                                          const Vector3& inside,
                                                          const Bounds& extent, double size,
                                                          const ExactSearch& search);

}  // namespace polyglide
