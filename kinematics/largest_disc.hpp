#pragma once

#include <array>
#include <vector>

namespace polyglide {

/// A disc on a grid: centre node and radius in grid steps.
struct GridDisc {
  int x = 0, y = 0;
  double radius = 0;  ///< to the nearest node outside; 0 = no node is inside
};

/// The largest disc round a node of a mask (row by row, `width` nodes each) that holds
/// no node outside; nodes beyond the mask are outside. Exact Euclidean distance
/// transform in linear time (Felzenszwalb and Huttenlocher 2012).
[[nodiscard]] GridDisc largest_disc(const std::vector<char>& mask, int width);

/// A ball on a grid: centre node and radius in grid steps.
struct GridBall {
  std::array<int, 3> at{};
  double radius = 0;  ///< to the nearest node outside
};

/// The same in space: the largest ball round a node of a mask (x fastest), then the largest round a
/// node that no ball before it holds, `most` of them or until the mask is used up.
[[nodiscard]] std::vector<GridBall> largest_balls(const std::vector<char>& mask,
                                                  const std::array<int, 3>& count, int most);

}  // namespace polyglide
