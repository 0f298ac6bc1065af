#include "kinematics/largest_disc.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace polyglide {
namespace {

/// min over v of (q - v)² + f[v] for every q: the lower envelope of parabolas.
void distance_row(const std::vector<double>& f, std::vector<double>& result) {
  const int n = static_cast<int>(f.size());
  const double huge = std::numeric_limits<double>::infinity();
  std::vector<int> vertex(n);
  std::vector<double> from(n + 1);
  int last = 0;
  vertex[0] = 0;
  from[0] = -huge;
  from[1] = huge;
  for (int q = 1; q < n; ++q) {
    const auto crossing = [&](int v) {
      return ((f[q] + q * q) - (f[v] + v * v)) / (2.0 * (q - v));
    };
    while (last >= 0 && crossing(vertex[last]) <= from[last]) --last;
    from[last + 1] = last < 0 ? -huge : crossing(vertex[last]);
    vertex[++last] = q;
    from[last + 1] = huge;
  }
  int v = 0;
  for (int q = 0; q < n; ++q) {
    while (from[v + 1] < q) ++v;
    result[q] = (q - vertex[v]) * (q - vertex[v]) + f[vertex[v]];
  }
}

/// Squared distance of every node of a mask to the nearest node outside, in steps. A rim of
/// nodes outside closes the mask.
std::vector<double> squared_distances(const std::vector<char>& mask,
                                      const std::array<int, 3>& count) {
  constexpr double kFar = 1e12;
  std::vector<double> square(mask.size());
  for (std::size_t i = 0; i < mask.size(); ++i) square[i] = mask[i] ? kFar : 0;
  std::size_t stride = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto length = static_cast<std::size_t>(count[axis]);
    std::vector<double> line(length + 2, 0), answer(length + 2);
    for (std::size_t i = 0; length > 1 && i < mask.size() / length; ++i) {
      const std::size_t first = i / stride * stride * length + i % stride;
      for (std::size_t k = 0; k < length; ++k) line[k + 1] = square[first + k * stride];
      distance_row(line, answer);
      for (std::size_t k = 0; k < length; ++k) square[first + k * stride] = answer[k + 1];
    }
    stride *= length;
  }
  return square;
}

}  // namespace

GridDisc largest_disc(const std::vector<char>& mask, int width) {
  const int height = static_cast<int>(mask.size()) / width;
  const std::vector<GridBall> balls = largest_balls(mask, {width, height, 1}, 1);
  if (balls.empty()) return {};
  return {balls[0].at[0], balls[0].at[1], balls[0].radius};
}

std::vector<GridBall> largest_balls(const std::vector<char>& mask, const std::array<int, 3>& count,
                                    int most) {
  std::vector<double> square = squared_distances(mask, count);
  const auto node = [&](std::size_t i) {
    const auto x = static_cast<std::size_t>(count[0]), y = static_cast<std::size_t>(count[1]);
    return std::array<int, 3>{static_cast<int>(i % x), static_cast<int>(i / x % y),
                              static_cast<int>(i / x / y)};
  };
  std::vector<GridBall> balls;
  for (;;) {
    const auto best = std::max_element(square.begin(), square.end());
    if (best == square.end() || *best <= 0) break;
    balls.push_back({node(static_cast<std::size_t>(best - square.begin())), std::sqrt(*best)});
    const GridBall& ball = balls.back();
    if (static_cast<int>(balls.size()) == most) break;
    for (std::size_t i = 0; i < square.size(); ++i) {
      const std::array<int, 3> at = node(i);
      double away = 0;
      for (int axis = 0; axis < 3; ++axis)
        away += static_cast<double>(at[axis] - ball.at[axis]) * (at[axis] - ball.at[axis]);
      if (away < ball.radius * ball.radius) square[i] = 0;
    }
  }
  return balls;
}

}  // namespace polyglide
