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

}  // namespace

GridDisc largest_disc(const std::vector<char>& mask, int width) {
  // A rim of nodes outside closes the mask.
  const int height = static_cast<int>(mask.size()) / width, nx = width + 2, ny = height + 2;
  constexpr double kFar = 1e12;
  std::vector<double> square(static_cast<std::size_t>(nx) * ny, 0);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      if (mask[i + static_cast<std::size_t>(width) * j])
        square[i + 1 + static_cast<std::size_t>(nx) * (j + 1)] = kFar;
  std::vector<double> line(ny), answer(ny);
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < ny; ++j) line[j] = square[i + static_cast<std::size_t>(nx) * j];
    distance_row(line, answer);
    for (int j = 0; j < ny; ++j) square[i + static_cast<std::size_t>(nx) * j] = answer[j];
  }
  line.resize(nx);
  answer.resize(nx);
  GridDisc disc;
  for (int j = 0; j < ny; ++j) {
    std::copy_n(&square[static_cast<std::size_t>(nx) * j], nx, line.begin());
    distance_row(line, answer);
    for (int i = 0; i < nx; ++i)
      if (const double radius = std::sqrt(answer[i]); radius > disc.radius)
        disc = {i - 1, j - 1, radius};
  }
  return disc;
}

}  // namespace polyglide
