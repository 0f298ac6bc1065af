#include "kinematics/followed_root.hpp"

namespace polyglide {
namespace {

std::vector<double> middles(const std::vector<Interval>& box) {
  std::vector<double> result;
  for (const Interval& each : box) result.push_back(middle(each));
  return result;
}

std::vector<double> guess_at(const PointRoot& from, const IntervalMatrix& rates,
                             const std::vector<double>& where) {
  const std::vector<Interval> to(where.begin(), where.end());
  return middles(moved(from, rates, to));
}

/// The root at the end of one piece of the way, if the piece is proved.
std::optional<PointRoot> step_to(const ParametricEnclosure& equations, const PointRoot& from,
                                 const std::vector<double>& target) {
  auto end = root_at(equations, target, guess_at(from, from.rates, target));
  if (!end) return std::nullopt;
  std::vector<Interval> box;
  for (std::size_t k = 0; k < target.size(); ++k)
    box.emplace_back(std::min(from.where[k], target[k]), std::max(from.where[k], target[k]));
  const auto between = roots_over(equations, box, from);
  if (!between || !within(from.root, between->alone) || !within(end->root, between->alone))
    return std::nullopt;
  return end;
}

/// As far to a goal as can be proved; given up where steps become short.
PointRoot towards(const ParametricEnclosure& equations, const PointRoot& from,
                  const std::vector<double>& goal, int pieces) {
  PointRoot now = from;
  constexpr double kShortest = 1.0 / 16;
  double done = 0, step = 1;
  for (int piece = 0; piece < pieces && done < 1 && step > kShortest; ++piece) {
    const double next = std::min(1.0, done + step);
    std::vector<double> target = goal;
    for (std::size_t k = 0; next < 1 && k < goal.size(); ++k)
      target[k] = from.where[k] + next * (goal[k] - from.where[k]);
    auto end = step_to(equations, now, target);
    if (!end) {
      step /= 2;
      continue;
    }
    now = std::move(*end);
    done = next;
  }
  return now;
}

}  // namespace

FollowedRoot follow_root(const ParametricEnclosure& equations, const std::vector<Interval>& box,
                         const FollowedRoot& from, int pieces) {
  const std::vector<double> goal = middles(box);
  FollowedRoot result = from;
  result.in_middle = false;
  std::optional<PointRoot> found;
  if (from.whole) {
    found = root_at(equations, goal, guess_at(from.point, from.whole->rates, goal));
    // What is known of a larger box holds on.
    if (!found || !within(found->root, from.whole->alone)) return result;
  } else {
    found = towards(equations, from.point, goal, pieces);
    if (found->where != goal) {
      result.point = std::move(*found);
      return result;
    }
  }
  auto whole = roots_over(equations, box, *found);
  if (!whole && from.whole) return result;
  result.point = std::move(*found);
  result.in_middle = true;
  result.whole = whole ? std::make_shared<const BoxRoot>(std::move(*whole)) : nullptr;
  return result;
}

}  // namespace polyglide
