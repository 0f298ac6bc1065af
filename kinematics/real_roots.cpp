#include "kinematics/real_roots.hpp"

#include <algorithm>
#include <cmath>

namespace polyglide {
namespace {

double value(const Quartic& c, double z) {
  return c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * c[4])));
}

Roots quadratic(double c, double b, double a, double low, double high) {
  Roots roots;
  const auto add = [&](double z) {
    if (z >= low && z <= high) roots.add(z);
  };
  const double half = -b / 2, square = half * half - a * c;
  if (!(square >= 0)) return roots;
  const double sum = half + std::copysign(std::sqrt(square), half);
  if (sum == 0) return roots;
  double first = c / sum, second = sum / a;  // the second is infinite for a line
  if (first > second) std::swap(first, second);
  add(first);
  add(second);
  return roots;
}

}  // namespace

Roots real_roots(const Quartic& c, double low, double high) {
  const double reach = std::max(std::abs(low), std::abs(high));
  const double size =
      std::max({std::abs(c[0]), std::abs(c[1]) * reach, std::abs(c[2]) * reach * reach});
  if (std::abs(c[4]) * std::pow(reach, 4) <= 1e-15 * size &&
      std::abs(c[3]) * std::pow(reach, 3) <= 1e-15 * size)
    return quadratic(c[0], c[1], c[2], low, high);
  const Roots turns = real_roots({c[1], 2 * c[2], 3 * c[3], 4 * c[4], 0}, low, high);
  Roots roots;
  double from = low, before = value(c, low);
  for (int i = 0; i <= turns.count; ++i) {
    const double to = i < turns.count ? turns.at[i] : high, after = value(c, to);
    if ((before < 0) != (after < 0))
      roots.add(zero_between([&](double z) { return value(c, z); }, from, to, before, after));
    from = to;
    before = after;
  }
  return roots;
}

}  // namespace polyglide
