#include "kinematics/inscribed.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace polyglide {
namespace {

constexpr int kMostLayers = 40;         // of the thinned grid
constexpr double kFinest = 1.0 / 1024;  // of a grid step: where the pattern search stops
constexpr double kReserve = 1 + 2e-4;   // a shape asked for is sought this much larger

using Shape = Eigen::VectorXd;  // cylinder: x, y, bottom, top, radius; box: lower and upper corner

Cylinder as_cylinder(const Shape& s) {
  return {2 * s[4], s[3] - s[2], {s[0], s[1], (s[2] + s[3]) / 2}};
}
Box as_box(const Shape& s) { return {s.tail<3>() - s.head<3>(), (s.head<3>() + s.tail<3>()) / 2}; }

Shape as_shape(const Cylinder& c) {
  Shape s(5);
  s << c.center.x(), c.center.y(), c.center.z() - c.height / 2, c.center.z() + c.height / 2,
      c.diameter / 2;
  return s;
}

/// What a cylinder or a box shrinks to.
Shape axis_point(const Shape& s) {
  Shape point(5);
  point << s[0], s[1], (s[2] + s[3]) / 2, (s[2] + s[3]) / 2, 0;
  return point;
}
Shape middle_of(const Shape& s) {
  Shape middle(6);
  middle << as_box(s).center, as_box(s).center;
  return middle;
}

bool is_box(const Shape& s) { return (s.tail<3>() - s.head<3>()).minCoeff() > 0; }

/// How densely a cylinder's surface is asked about.
struct Density {
  int angles, levels, rings;
};
constexpr Density kCoarse{40, 6, 3}, kDense{120, 16, 6};

/// Points on the surface of a cylinder: its edges, which fail first; then the rest.
std::vector<Points> cylinder_surface(const Shape& s, const std::vector<Eigen::Vector2d>& circle,
                                     const Density& density) {
  std::vector<Points> parts(2);
  const auto ring = [&](Points& part, double radius, double z, std::size_t stride) {
    for (std::size_t a = 0; a < circle.size(); a += stride)
      part.add({s[0] + radius * circle[a].x(), s[1] + radius * circle[a].y(), z});
  };
  for (double z : {s[2], s[3]}) {
    ring(parts[0], s[4], z, 1);
    ring(parts[1], 0, z, circle.size());
    for (int r = 1; r < density.rings; ++r) ring(parts[1], s[4] * r / density.rings, z, 2);
  }
  for (int l = 1; l < density.levels; ++l)
    ring(parts[1], s[4], s[2] + (s[3] - s[2]) * l / density.levels, 1);
  return parts;
}

/// Points on the surface of a box, corners and edges before the rest.
std::vector<Points> box_surface(const Shape& s, int parts_per_edge) {
  std::vector<Points> parts(2);
  const int n = parts_per_edge;
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const int outer = (i == 0 || i == n) + (j == 0 || j == n) + (k == 0 || k == n);
        if (outer == 0) continue;
        const Vector3 share = Vector3(i, j, k) / n;
        const Vector3 size = s.tail<3>() - s.head<3>();
        parts[outer >= 2 ? 0 : 1].add(s.head<3>() + share.cwiseProduct(size));
      }
  return parts;
}

bool all_inside(const Probe& probe, const std::vector<Points>& parts) {
  return std::all_of(parts.begin(), parts.end(),
                     [&probe](const Points& part) { return probe.all_inside(part); });
}

/// What a search may change, what it must keep, and what it wants.
struct Goal {
  std::vector<Shape> moves;
  std::vector<int> free;  ///< entries of the shape that random moves change
  std::function<bool(const Shape&)> fits;
  std::function<double(const Shape&)> gain;
  double enough = std::numeric_limits<double>::infinity();
};

/// Pattern search: tries moves of a shape, keeps what fits and gains, and halves the
/// step when nothing does. Random moves, always the same ones, lead out of the
/// ridges where every listed move is blocked. Stops early at a gain of `enough`.
Shape climb(Shape shape, double step, double finest, const Goal& goal) {
  constexpr int kRandom = 40;
  std::mt19937_64 random(1);
  const auto random_move = [&] {
    Shape move = Shape::Zero(shape.size());
    for (int entry : goal.free) move[entry] = static_cast<double>(random() >> 11) * 0x1p-52 - 1;
    return move;
  };
  double best = goal.gain(shape);
  const auto follow = [&](const Shape& move) {
    bool improved = false;
    for (Shape trial = shape + move; best < goal.enough; trial += move) {
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

std::function<bool(const Shape&)> cylinder_fits(const Probe& probe, const Density& density) {
  std::vector<Eigen::Vector2d> circle;
  for (int a = 0; a < density.angles; ++a) {
    const double angle = 2 * M_PI * a / density.angles;
    circle.emplace_back(std::cos(angle), std::sin(angle));
  }
  return [&probe, density, circle](const Shape& s) {
    return s[3] >= s[2] && s[4] > 0 && all_inside(probe, cylinder_surface(s, circle, density));
  };
}

std::function<bool(const Shape&)> box_fits(const Probe& probe, int parts_per_edge) {
  return [&probe, parts_per_edge](const Shape& s) {
    return is_box(s) && all_inside(probe, box_surface(s, parts_per_edge));
  };
}

/// Shrinks about `centre` until it fits.
Shape shrink(Shape shape, const Shape& centre, double factor, int most,
             const std::function<bool(const Shape&)>& fits) {
  for (int i = 0; i < most && !fits(shape); ++i) shape = centre + factor * (shape - centre);
  return fits(shape) ? shape : centre;
}

/// Moves of bottom, top and radius, each with the axis shifted in 8 directions or not.
std::vector<Shape> with_shifts(const std::vector<std::array<double, 3>>& changes) {
  std::vector<Shape> moves;
  for (const auto& change : changes)
    for (int shift = 0; shift < 9; ++shift) {
      Shape move(5);
      move << (shift + 1) % 3 - 1, (shift / 3 + 1) % 3 - 1, change[0], change[1], change[2];
      moves.push_back(move);
    }
  return moves;
}

std::vector<Shape> height_moves() {
  return with_shifts(
      {{0, 1, 0}, {-1, 0, 0}, {-1, 1, 0}, {0, 0.2, 0}, {-0.2, 0, 0}, {1, 3, 0}, {-3, -1, 0}});
}

/// Growth, and trades of height for width.
std::vector<Shape> volume_moves() {
  return with_shifts({{0, 0, 1},
                      {0, 1, 0},
                      {-1, 0, 0},
                      {0, 0, 0.2},
                      {0, 0.2, 0},
                      {-0.2, 0, 0},
                      {0, 1, 1},
                      {-1, 0, 1},
                      {0, -1, 1},
                      {1, 0, 1},
                      {0, -3, 1},
                      {3, 0, 1},
                      {0, 2, -1},
                      {-2, 0, -1},
                      {0, 5, -1},
                      {-5, 0, -1}});
}

std::vector<Shape> box_moves() {
  std::vector<Shape> moves;
  const auto face = [](int f) {
    Shape move = Shape::Zero(6);
    move[f] = f < 3 ? -1 : 1;
    return move;
  };
  for (int f = 0; f < 6; ++f) moves.push_back(face(f));
  for (int axis = 0; axis < 3; ++axis) moves.push_back(face(axis) + face(axis + 3));
  for (int f = 0; f < 6; ++f)
    for (int other = 0; other < 6; ++other)
      if (other != f)
        for (double trade : {0.5, 1.0, 3.0}) moves.push_back(face(f) - trade * face(other));
  for (int axis = 0; axis < 3; ++axis)
    for (int other = 0; other < 3; ++other)
      if (other != axis)
        for (double trade : {0.5, 1.0, 2.0})
          moves.push_back(face(axis) + face(axis + 3) - trade * (face(other) + face(other + 3)));
  return moves;
}

/// Squared distance to the nearest zero of a row, given distances across rows
/// (Felzenszwalb and Huttenlocher 2012, lower envelope of parabolas).
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
      intervals_.push_back({low, high, mask, 0, 0, 0});
    }
  }
  tbb::parallel_for(std::size_t{0}, intervals_.size(),
                    [this](std::size_t i) { find_disc(intervals_[i]); });
}

void Inscriber::find_disc(Interval& interval) const {
  // A rim of nodes outside closes the grid.
  const int nx = grid_.count[0] + 2, ny = grid_.count[1] + 2;
  constexpr double kFar = 1e12;
  std::vector<double> square(static_cast<std::size_t>(nx) * ny, 0);
  for (int j = 0; j < grid_.count[1]; ++j)
    for (int i = 0; i < grid_.count[0]; ++i)
      if (interval.mask[i + static_cast<std::size_t>(grid_.count[0]) * j])
        square[i + 1 + static_cast<std::size_t>(nx) * (j + 1)] = kFar;
  std::vector<double> line(ny), answer(ny);
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < ny; ++j) line[j] = square[i + static_cast<std::size_t>(nx) * j];
    distance_row(line, answer);
    for (int j = 0; j < ny; ++j) square[i + static_cast<std::size_t>(nx) * j] = answer[j];
  }
  line.resize(nx);
  answer.resize(nx);
  for (int j = 0; j < ny; ++j) {
    std::copy_n(&square[static_cast<std::size_t>(nx) * j], nx, line.begin());
    distance_row(line, answer);
    for (int i = 0; i < nx; ++i) {
      if (!(std::sqrt(answer[i]) * grid_.step > interval.radius)) continue;
      interval.radius = std::sqrt(answer[i]) * grid_.step;
      interval.x = grid_.origin.x() + (i - 1) * grid_.step;
      interval.y = grid_.origin.y() + (j - 1) * grid_.step;
    }
  }
}

const Inscriber::Interval* Inscriber::best_interval(const CylinderGain& gain) const {
  const Interval* best = nullptr;
  double best_gain = 0;
  for (const Interval& interval : intervals_) {
    const double value = gain(interval.radius, (interval.high - interval.low) * grid_.step);
    if (best && !(value > best_gain)) continue;
    best = &interval;
    best_gain = value;
  }
  return best;
}

Cylinder Inscriber::grid_cylinder(const Interval& interval) const {
  const double bottom = grid_.origin.z() + interval.low * grid_.step;
  const double top = grid_.origin.z() + interval.high * grid_.step;
  const double radius = std::max(interval.radius - grid_.step, 0.25 * grid_.step);
  return {2 * radius, top - bottom, {interval.x, interval.y, (bottom + top) / 2}};
}

Cylinder Inscriber::largest_cylinder() const {
  const auto volume = [](double radius, double height) { return radius * radius * height; };
  const Interval* start = best_interval(volume);
  if (!start) return {};
  const Cylinder seed = grid_cylinder(*start);
  if (!probe_.evaluator().closed_form()) return seed;
  Goal goal;
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
  return as_cylinder(climb(shape, grid_.step / 32, grid_.step * kFinest, goal));
}

Cylinder Inscriber::tallest(double diameter, double enough) const {
  // Width first: the tallest interval wide enough, else the widest.
  const double radius = diameter / 2 * kReserve;
  const auto width_first = [&](double r, double h) { return 1e3 * std::min(r / radius, 1.0) + h; };
  const Interval* start = best_interval(width_first);
  if (!start) return {};
  const Cylinder seed = grid_cylinder(*start);
  if (!probe_.evaluator().closed_form()) return seed.diameter < diameter ? Cylinder{} : seed;
  Goal goal;
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
  return as_cylinder(climb(shape, grid_.step / 32, grid_.step * kFinest, goal));
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
  const Vector3 half = start->size.cwiseMax(0.25 * grid_.step) / 2;
  Shape shape(6);
  shape << start->center - half, start->center + half;
  Goal goal;
  goal.moves = box_moves();
  goal.free = {0, 1, 2, 3, 4, 5};
  goal.enough = enough;
  goal.fits = box_fits(probe_, 6);
  goal.gain = [&gain](const Shape& s) { return is_box(s) ? gain(s.tail<3>() - s.head<3>()) : -1; };
  shape = shrink(shape, middle_of(shape), 0.9, 60, goal.fits);
  shape = climb(shape, grid_.step, grid_.step / 64, goal);
  goal.fits = box_fits(probe_, 20);
  shape = shrink(shape, middle_of(shape), 0.9995, 200, goal.fits);
  if (!is_box(shape)) return std::nullopt;
  return as_box(climb(shape, grid_.step / 32, grid_.step * kFinest, goal));
}

Box Inscriber::largest_box() const {
  const auto volume = [](const Vector3& size) { return size.prod(); };
  return best_box(volume, std::numeric_limits<double>::infinity()).value_or(Box{});
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
  for (const Interval& interval : intervals_) widest = std::max(widest, 2 * interval.radius);
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
