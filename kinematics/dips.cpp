#include "kinematics/dips.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace polyglide {
namespace {

/// Steps from `next` to zero when the fall from `before` goes on.
double steps_to_zero(double before, double next) {
  return before > next ? next / (before - next) : std::numeric_limits<double>::infinity();
}

}  // namespace

bool is_dip(double before, double near, double far, double beyond, double steps) {
  const double ahead = steps_to_zero(before, near), back = steps_to_zero(beyond, far);
  constexpr double kBend = 0.5;
  return std::abs(ahead + back - steps) < kBend && ahead < steps + kBend && back > 0;
}

std::vector<Bottom> bottoms(
    std::size_t count,
    const std::function<std::vector<double>(const std::vector<double>& ways)>& heights) {
  const double golden = (std::sqrt(5.0) - 1) / 2;
  std::vector<std::array<double, 2>> ends(count, {0, 1});
  std::vector<Bottom> result(count, {0.5, std::numeric_limits<double>::infinity()});
  constexpr int kRounds = 60;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> ways;
    for (const auto& [from, to] : ends)
      for (const double part : {1 - golden, golden}) ways.push_back(from + part * (to - from));
    const std::vector<double> found = heights(ways);
    for (std::size_t i = 0; i < count; ++i) {
      const double low = found[2 * i], high = found[2 * i + 1];
      const double cut = (1 - golden) * (ends[i][1] - ends[i][0]);
      if (low < high)
        ends[i][1] -= cut;
      else
        ends[i][0] += cut;
      result[i] = {(ends[i][0] + ends[i][1]) / 2, std::min({result[i].height, low, high})};
    }
  }
  return result;
}

std::vector<GridEdge> dips_of(const std::vector<double>& heights,
                              const std::vector<signed char>& signs, int width) {
  std::vector<GridEdge> found;
  for (std::size_t n = 0; n < heights.size(); ++n)
    for (const int step : {1, width}) {
      const std::size_t before = n - step, far = n + step, beyond = far + step;
      if (n < static_cast<std::size_t>(step) || beyond >= heights.size()) continue;
      // All four in one row.
      if (step == 1 && before / width != beyond / width) continue;
      if (signs[n] == signs[far] &&
          is_dip(heights[before], heights[n], heights[far], heights[beyond]))
        found.push_back({n, far});
    }
  return found;
}

std::vector<signed char> classes_apart(const std::vector<double>& heights, int width,
                                       const std::vector<GridEdge>& crossed) {
  constexpr signed char kUnknown = 2;
  const std::set<GridEdge> edges(crossed.begin(), crossed.end());
  std::vector<signed char> classes(heights.size(), kUnknown);
  std::vector<std::size_t> queue;
  const auto visit = [&](std::size_t from, std::size_t to) {
    if (classes[to] != kUnknown || std::isnan(heights[to])) return;
    const bool crosses = edges.contains({std::min(from, to), std::max(from, to)});
    classes[to] = static_cast<signed char>(crosses ? 1 - classes[from] : classes[from]);
    queue.push_back(to);
  };
  for (std::size_t start = 0; start < classes.size(); ++start) {
    if (classes[start] != kUnknown || std::isnan(heights[start])) continue;
    classes[start] = 1;
    queue.push_back(start);
    while (!queue.empty()) {
      const std::size_t n = queue.back(), column = n % width;
      queue.pop_back();
      if (column > 0) visit(n, n - 1);
      if (column + 1 < static_cast<std::size_t>(width)) visit(n, n + 1);
      if (n >= static_cast<std::size_t>(width)) visit(n, n - width);
      if (n + width < heights.size()) visit(n, n + width);
    }
  }
  return classes;
}

}  // namespace polyglide
