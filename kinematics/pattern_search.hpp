#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

namespace polyglide {

/// Numbers that describe a shape, in metres.
using Shape = Eigen::VectorXd;

/// What a search may change, what it must keep, and what it wants.
struct ShapeGoal {
  std::vector<Shape> moves;
  std::vector<int> free;  ///< entries of the shape that random moves change
  std::function<bool(const Shape&)> fits;
  std::function<double(const Shape&)> gain;
  double enough = std::numeric_limits<double>::infinity();  ///< stop at this gain
};

/// Pattern search from a shape that fits: tries moves, keeps what fits and gains, and
/// halves the step from `step` to `finest` when nothing does. Random moves, always the
/// same ones, lead out of ridges on which every listed move is blocked. Ends after 20 000
/// trials at the latest.
[[nodiscard]] Shape climb(Shape shape, double step, double finest, const ShapeGoal& goal);

/// Shrinks about `centre`, at most `most` times by `factor`, until it fits; else `centre`.
[[nodiscard]] Shape shrink(Shape shape, const Shape& centre, double factor, int most,
                           const std::function<bool(const Shape&)>& fits);

}  // namespace polyglide
