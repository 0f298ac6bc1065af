#include "kinematics/inscribed.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace polyglide {
namespace {

constexpr int kMostLayers = 40;             // of the thinned grid
constexpr double kFinestStep = 1.0 / 1024;  // of a grid step: where the pattern search stops
constexpr double kReserve = 1 + 2e-4;       // a shape asked for is sought this much larger
constexpr int kRoughSteps = 12;             // of 10 % each, where poses take long
constexpr int kSphereStarts = 4;

/// A search finds the gaps between the places it asks: the last test is finer than they are.
Shape settle(const Shape& shape, const Shape& centre,
             const std::function<bool(const Shape&)>& fits) {
  return shrink(shape, centre, 1 - 5e-5, 200, fits);
}

}  // namespace

Inscriber::Inscriber(const Probe& probe, const Region& region) : probe_(probe) {
  if (region.empty || probe.dimensions() < 3) return;
  const NodeGrid& fine = region.grid;
  const int stride =
      1 + *std::max_element(fine.count.begin(), fine.count.end()) / (kMostLayers + 1);
  grid_.origin = fine.origin;
  grid_.step = fine.step * stride;
  for (int axis = 0; axis < 3; ++axis) grid_.count[axis] = 1 + (fine.count[axis] - 1) / stride;
  for (int k = 0; k < grid_.count[2]; ++k)
    for (int j = 0; j < grid_.count[1]; ++j)
      for (int i = 0; i < grid_.count[0]; ++i)
        inside_.push_back(region.inside[fine.index(i * stride, j * stride, k * stride)]);
  add_intervals();
}

void Inscriber::add_intervals() {
  const std::size_t area = static_cast<std::size_t>(grid_.count[0]) * grid_.count[1];
  for (int low = 0; low < grid_.count[2]; ++low) {
    std::vector<char> mask(area, 1);
    for (int high = low; high < grid_.count[2]; ++high) {
      const char* layer = &inside_[area * high];
      for (std::size_t i = 0; i < area; ++i) mask[i] = mask[i] && layer[i];
      if (std::none_of(mask.begin(), mask.end(), [](char inside) { return inside; })) break;
      intervals_.push_back({low, high, mask, {}});
    }
  }
  tbb::parallel_for(std::size_t{0}, intervals_.size(), [this](std::size_t i) {
    intervals_[i].disc = largest_disc(intervals_[i].mask, grid_.count[0]);
  });
}

const Inscriber::Interval* Inscriber::best_interval(const CylinderGain& gain) const {
  const Interval* best = nullptr;
  double best_gain = 0;
  for (const Interval& interval : intervals_) {
    const double value =
        gain(interval.disc.radius * grid_.step, (interval.high - interval.low) * grid_.step);
    if (best && !(value > best_gain)) continue;
    best = &interval;
    best_gain = value;
  }
  return best;
}

Cylinder Inscriber::grid_cylinder(const Interval& interval) const {
  const GridDisc& disc = interval.disc;
  const Vector3 bottom = grid_.at(disc.x, disc.y, interval.low);
  const Vector3 top = grid_.at(disc.x, disc.y, interval.high);
  return {2 * std::max(disc.radius - 1, 0.25) * grid_.step, top.z() - bottom.z(),
          (bottom + top) / 2};
}

Cylinder Inscriber::largest_cylinder() const {
  const auto volume = [](double radius, double height) { return radius * radius * height; };
  const Interval* start = best_interval(volume);
  if (!start) return {};
  const Cylinder seed = grid_cylinder(*start);
  if (!probe_.evaluator().closed_form()) {
    const Shape rough = as_shape(seed), axis = axis_point(rough);
    const Shape fits = shrink(rough, axis, 0.9, kRoughSteps, cylinder_fits(probe_, kRough));
    return fits[4] > 0 ? as_cylinder(fits) : Cylinder{};
  }
  ShapeGoal goal;
  goal.moves = volume_moves();
  goal.free = {0, 1, 2, 3, 4};
  goal.fits = cylinder_fits(probe_, kCoarse);
  goal.gain = [](const Shape& s) {
    return s[3] > s[2] && s[4] > 0 ? s[4] * s[4] * (s[3] - s[2]) : -1;
  };
  Shape shape = as_shape(seed);
  shape = shrink(shape, axis_point(shape), 0.9, 60, goal.fits);
  shape = climb(shape, grid_.step, grid_.step / 64, goal);
  goal.fits = cylinder_fits(probe_, kDense);
  shape = shrink(shape, axis_point(shape), 0.9995, 200, goal.fits);
  if (!(shape[4] > 0)) return {};
  shape = climb(shape, grid_.step / 32, grid_.step * kFinestStep, goal);
  return as_cylinder(settle(shape, axis_point(shape), cylinder_fits(probe_, kFinest)));
}

Cylinder Inscriber::tallest(double diameter, double enough) const {
  // Width first: the tallest interval wide enough, else the widest.
  const double radius = diameter / 2 * kReserve;
  const auto width_first = [&](double r, double h) { return 1e3 * std::min(r / radius, 1.0) + h; };
  const Interval* start = best_interval(width_first);
  if (!start) return {};
  const Cylinder seed = grid_cylinder(*start);
  if (!probe_.evaluator().closed_form()) return seed.diameter < diameter ? Cylinder{} : seed;
  ShapeGoal goal;
  goal.moves = volume_moves();
  goal.free = {0, 1, 2, 3, 4};
  goal.fits = cylinder_fits(probe_, kCoarse);
  goal.gain = [](const Shape& s) { return s[3] > s[2] ? s[4] : -1; };
  goal.enough = radius;
  Shape shape = as_shape(seed);
  shape = shrink(shape, axis_point(shape), 0.9, 60, goal.fits);
  shape = climb(shape, grid_.step, grid_.step / 64, goal);
  shape[4] = std::min(shape[4], radius);

  goal.moves = height_moves();
  goal.free = {0, 1, 2, 3};
  goal.gain = [](const Shape& s) { return s[3] - s[2]; };
  goal.enough = enough * kReserve;
  shape = climb(shape, grid_.step, grid_.step / 64, goal);
  goal.fits = cylinder_fits(probe_, kDense);
  Shape flat = axis_point(shape);
  flat[4] = shape[4];
  shape = shrink(shape, flat, 0.999, 200, goal.fits);
  if (2 * shape[4] < diameter || !goal.fits(shape)) return {};
  return as_cylinder(climb(shape, grid_.step / 32, grid_.step * kFinestStep, goal));
}

/// Maximal rectangles of every interval's mask, by a stack over column heights.
std::optional<Box> Inscriber::best_rectangle(const BoxGain& gain) const {
  std::optional<Box> best;
  double best_gain = 0;
  const int nx = grid_.count[0], ny = grid_.count[1];
  for (const Interval& interval : intervals_) {
    std::vector<int> run(nx + 1, 0), stack;
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i)
        run[i] = interval.mask[i + static_cast<std::size_t>(nx) * j] ? run[i] + 1 : 0;
      stack.clear();
      for (int i = 0; i <= nx; ++i) {
        while (!stack.empty() && run[stack.back()] >= run[i]) {
          const int depth = run[stack.back()];
          stack.pop_back();
          const int left = stack.empty() ? 0 : stack.back() + 1;
          if (depth < 1 || i - left < 1) continue;
          const Vector3 nodes(i - left - 1, depth - 1, interval.high - interval.low);
          const double value = gain(nodes * grid_.step);
          if (best && !(value > best_gain)) continue;
          best_gain = value;
          const Vector3 lower = grid_.at(left, j - depth + 1, interval.low);
          best = Box{nodes * grid_.step, lower + nodes * grid_.step / 2};
        }
        stack.push_back(i);
      }
    }
  }
  return best;
}

std::optional<Box> Inscriber::best_box(const BoxGain& gain, double enough) const {
  const std::optional<Box> start = best_rectangle(gain);
  if (!start || !probe_.evaluator().closed_form()) return start;
  // A rectangle one node wide still has to grow.
  Shape shape = as_shape(Box{start->size.cwiseMax(0.25 * grid_.step), start->center});
  ShapeGoal goal;
  goal.moves = box_moves();
  goal.free = {0, 1, 2, 3, 4, 5};
  goal.enough = enough;
  goal.fits = box_fits(probe_, kCoarse);
  goal.gain = [&gain](const Shape& s) { return is_box(s) ? gain(s.tail<3>() - s.head<3>()) : -1; };
  shape = shrink(shape, middle_of(shape), 0.9, 60, goal.fits);
  shape = climb(shape, grid_.step, grid_.step / 64, goal);
  goal.fits = box_fits(probe_, kDense);
  shape = shrink(shape, middle_of(shape), 0.9995, 200, goal.fits);
  if (!is_box(shape)) return std::nullopt;
  return as_box(climb(shape, grid_.step / 32, grid_.step * kFinestStep, goal));
}

Box Inscriber::largest_box() const {
  const auto volume = [](const Vector3& size) { return size.prod(); };
  const Box box = best_box(volume, std::numeric_limits<double>::infinity()).value_or(Box{});
  const Shape rough = as_shape(box);
  if (!is_box(rough)) return box;
  if (probe_.evaluator().closed_form())
    return as_box(settle(rough, middle_of(rough), box_fits(probe_, kFinest)));
  const Shape fits = shrink(rough, middle_of(rough), 0.9, kRoughSteps, box_fits(probe_, kRough));
  return is_box(fits) ? as_box(fits) : Box{};
}

/// The largest sphere that a search from a ball of the grid leads to; radius 0 for none.
Shape Inscriber::polish(const GridBall& ball) const {
  const Vector3 centre = grid_.at(ball.at[0], ball.at[1], ball.at[2]);
  Shape shape = as_shape(Sphere{2 * std::max(ball.radius - 1, 0.25) * grid_.step, centre});
  if (!probe_.evaluator().closed_form())
    return shrink(shape, centre_of(shape), 0.9, kRoughSteps, sphere_fits(probe_, kRough));
  ShapeGoal goal;
  goal.moves = sphere_moves();
  goal.free = {0, 1, 2, 3};
  goal.fits = sphere_fits(probe_, kCoarse);
  goal.gain = [](const Shape& s) { return s[3]; };
  shape = shrink(shape, centre_of(shape), 0.9, 60, goal.fits);
  shape = climb(shape, grid_.step, grid_.step / 64, goal);
  goal.fits = sphere_fits(probe_, kDense);
  shape = shrink(shape, centre_of(shape), 0.9995, 200, goal.fits);
  if (!(shape[3] > 0)) return shape;
  shape = climb(shape, grid_.step / 32, grid_.step * kFinestStep, goal);
  return settle(shape, centre_of(shape), sphere_fits(probe_, kFinest));
}

Sphere Inscriber::largest_sphere() const {
  if (inside_.empty()) return {};
  Shape best = as_shape(Sphere{});
  for (const GridBall& ball : largest_balls(inside_, grid_.count, kSphereStarts)) {
    // No sphere about a place near this node is larger than the way to the node outside, and a
    // cell.
    if ((ball.radius + 1) * grid_.step < best[3]) break;
    if (const Shape shape = polish(ball); shape[3] > best[3]) best = shape;
  }
  return best[3] > 0 ? as_sphere(best) : Sphere{};
}

std::optional<Cylinder> Inscriber::place(double diameter, double height) const {
  const Cylinder found = tallest(diameter, height);
  if (!(found.height >= height)) return std::nullopt;
  return Cylinder{diameter, height, found.center};
}

std::optional<Box> Inscriber::place(const Vector3& size) const {
  const auto gain = [&size](const Vector3& s) {
    return (s.array() / (size.array() * kReserve)).min(1).sum();
  };
  const std::optional<Box> found = best_box(gain, 3 - 1e-12);
  if (!found || (found->size - size).minCoeff() < 0) return std::nullopt;
  return Box{size, found->center};
}

std::vector<Cylinder> Inscriber::tallest_cylinders() const {
  std::vector<Cylinder> series;
  double widest = 0;
  for (const Interval& interval : intervals_)
    widest = std::max(widest, 2 * interval.disc.radius * grid_.step);
  if (!(widest > 0)) return series;
  // A round step: 1, 2 or 5 times a power of ten, at most 15 of them up to the widest.
  double step = std::pow(10, std::floor(std::log10(widest / 15)));
  for (double factor : {2.0, 2.5, 2.0})
    if (widest / step > 15) step *= factor;
  series.resize(static_cast<std::size_t>(widest / step));
  tbb::parallel_for(std::size_t{0}, series.size(), [&](std::size_t i) {
    const double diameter = static_cast<double>(i + 1) * step;
    series[i] = tallest(diameter, std::numeric_limits<double>::infinity());
    series[i].diameter = diameter;
  });
  const auto none = std::find_if(series.begin(), series.end(),
                                 [](const Cylinder& cylinder) { return !(cylinder.height > 0); });
  series.erase(none, series.end());
  return series;
}

}  // namespace polyglide
