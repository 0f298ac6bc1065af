#pragma once

#include <array>

namespace polyglide {

/// Up to four numbers, ascending.
struct Roots {
  std::array<double, 4> at{};
  int count = 0;
  void add(double root) { at[count++] = root; }
};

/// c[0] + c[1] z + … + c[4] z⁴.
using Quartic = std::array<double, 5>;

/// Real roots of a polynomial between `low` and `high`, where its sign changes; a double root,
/// where it does not, may be missed. None for a constant. Quadratics by the stable closed form, the
/// rest between the roots of the derivative. Some 20 ns (quadratic) to 1 µs.
[[nodiscard]] Roots real_roots(const Quartic& c, double low, double high);

/// A zero of f in [a, b], where f changes its sign, to rounding (Illinois false position).
template <typename Function>
double zero_between(const Function& f, double a, double b, double fa, double fb) {
  constexpr int kMost = 100;
  int same = 0;
  for (int i = 0; i < kMost; ++i) {
    double z = (a * fb - b * fa) / (fb - fa);
    if (!(z > a && z < b) || i % 8 == 7) z = (a + b) / 2;
    if (z == a || z == b) break;
    const double fz = f(z);
    if (fz == 0) return z;
    if ((fz < 0) == (fb < 0)) {
      b = z;
      fb = fz;
      if (same == 1) fa /= 2;
      same = 1;
    } else {
      a = z;
      fa = fz;
      if (same == -1) fb /= 2;
      same = -1;
    }
    if (b - a < 1e-16 * (1 + (a < 0 ? -a : a))) break;
  }
  return (a + b) / 2;
}

}  // namespace polyglide
