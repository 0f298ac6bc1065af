#include "kinematics/pattern_search.hpp"

#include <cmath>
#include <random>

namespace polyglide {

Shape climb(Shape shape, double step, double finest, const ShapeGoal& goal) {
  constexpr int kRandom = 40;
  // Where nothing bounds a shape (limits ignored) it would grow for ever.
  int budget = 20000;
  std::mt19937_64 random(1);
  const auto random_move = [&] {
    Shape move = Shape::Zero(shape.size());
    for (int entry : goal.free) move[entry] = static_cast<double>(random() >> 11) * 0x1p-52 - 1;
    return move;
  };
  double best = goal.gain(shape);
  const auto follow = [&](const Shape& move) {
    bool improved = false;
    for (Shape trial = shape + move; best < goal.enough && budget > 0; trial += move, --budget) {
      const double gain = goal.gain(trial);
      if (!(gain > best + 1e-9 * std::abs(best)) || !goal.fits(trial)) break;
      best = gain;
      shape = trial;
      improved = true;
    }
    return improved;
  };
  for (double length = step; length >= finest && best < goal.enough; length /= 2) {
    bool improved = true;
    for (int pass = 0; improved && pass < 10; ++pass) {
      improved = false;
      for (const Shape& move : goal.moves) improved |= follow(length * move);
      for (int i = 0; i < kRandom; ++i) improved |= follow(length * random_move());
    }
  }
  return shape;
}

Shape shrink(Shape shape, const Shape& centre, double factor, int most,
             const std::function<bool(const Shape&)>& fits) {
  for (int i = 0; i < most && !fits(shape); ++i) shape = centre + factor * (shape - centre);
  return fits(shape) ? shape : centre;
}

}  // namespace polyglide
