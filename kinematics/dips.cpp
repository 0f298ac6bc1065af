#include "kinematics/dips.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace polyglide {
namespace {

/// Steps from `next` to zero when the fall from `before` goes on.
double steps_to_zero(double before, double next) {
  return before > next ? next / (before - next) : std::numeric_limits<double>::infinity();
}

bool falls_meet(double before, double near, double far, double beyond, double steps) {
  const double ahead = steps_to_zero(before, near), back = steps_to_zero(beyond, far);
  constexpr double kBend = 0.5;
  return std::abs(ahead + back - steps) < kBend && ahead < steps + kBend && back > 0;
}

}  // namespace

bool is_dip(double before, double near, double far, double beyond, double steps) {
  return falls_meet(before, near, far, beyond, steps) ||
         falls_meet(std::sqrt(before), std::sqrt(near), std::sqrt(far), std::sqrt(beyond), steps);
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

}  // namespace polyglide
