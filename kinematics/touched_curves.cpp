#include "kinematics/touched_curves.hpp"

#include "kinematics/dips.hpp"

namespace polyglide {
namespace {

constexpr double kZero = 1e-6;

/// From the first node of its edge to `far`, the second or, where the curve runs through that, the
/// one behind it.
struct GridDip {
  GridEdge edge;
  std::size_t far;
};

std::vector<GridDip> dips_of(const std::vector<double>& heights,
                             const std::vector<signed char>& signs, int width) {
  std::vector<GridDip> found;
  for (std::size_t n = 0; n < heights.size(); ++n)
    for (const int step : {1, width}) {
      const std::size_t steps = n + step < heights.size() && heights[n + step] < kZero ? 2 : 1;
      const std::size_t far = n + steps * step, before = n - step, beyond = far + step;
      if (n < static_cast<std::size_t>(step) || beyond >= heights.size()) continue;
      // All of them in one row.
      if (step == 1 && before / width != beyond / width) continue;
      if (heights[n] >= kZero && signs[n] == signs[far] &&
          is_dip(heights[before], heights[n], heights[far], heights[beyond],
                 static_cast<double>(steps)))
        found.push_back({{n, n + step}, far});
    }
  return found;
}

}  // namespace

std::vector<Contour> touched_curves(const std::vector<double>& heights,
                                    const std::vector<signed char>& signs, int width,
                                    const HeightsAt& ask) {
  const std::vector<GridDip> dips = dips_of(heights, signs, width);
  const auto node = [width](std::size_t n) -> std::array<double, 2> {
    return {static_cast<double>(n % width), static_cast<double>(n / width)};
  };
  const auto between = [&](const GridDip& dip, double way) -> std::array<double, 2> {
    const auto from = node(dip.edge[0]), to = node(dip.far);
    return {from[0] + way * (to[0] - from[0]), from[1] + way * (to[1] - from[1])};
  };
  const auto lowest = bottoms(dips.size(), [&](const std::vector<double>& ways) {
    std::vector<std::array<double, 2>> nodes;
    for (std::size_t i = 0; i < ways.size(); ++i) nodes.push_back(between(dips[i / 2], ways[i]));
    return ask(nodes);
  });
  std::map<GridEdge, std::array<double, 2>> zeros;
  for (std::size_t i = 0; i < dips.size(); ++i) {
    if (lowest[i].height >= kZero) continue;
    const auto& [edge, far] = dips[i];
    zeros[edge] = between(dips[i], lowest[i].at);
    if (far == edge[1]) continue;
    zeros[edge] = node(edge[1]);  // on the node itself
    zeros[{edge[1], far}] = node(edge[1]);
  }
  return contours_through(zeros, width, static_cast<int>(heights.size()) / width);
}

}  // namespace polyglide
