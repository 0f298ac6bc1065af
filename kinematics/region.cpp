#include "kinematics/region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinematics/singular_wall.hpp"

namespace polyglide {
namespace {

constexpr double kSingular = 1e-6;  // 1/κ at which a posture counts as singular

NodeGrid make_grid(const Probe& probe, const Bounds& box, int nodes) {
  NodeGrid grid;
  const Vector3 extent = box.upper - box.lower;
  double product = 1;
  const double smallest = std::max(extent.maxCoeff() * 1e-3, 1e-9);
  for (int k = 0; k < 3; ++k)
    if (probe.active()[k]) product *= std::max(extent[k], smallest);
  const int dimensions = probe.dimensions();
  grid.origin = box.lower;
  if (dimensions == 0) return grid;
  // In fewer than three dimensions the same fineness needs fewer nodes.
  grid.step = std::pow(product, 1.0 / dimensions) / std::cbrt(static_cast<double>(nodes));
  for (int k = 0; k < 3; ++k) {
    if (!probe.active()[k]) continue;
    grid.count[k] = 2 + static_cast<int>(extent[k] / grid.step);
    grid.origin[k] -= (grid.step * (grid.count[k] - 1) - extent[k]) / 2;
  }
  return grid;
}

Points nodes_of(const NodeGrid& grid) {
  Points points;
  points.reserve(grid.size());
  for (int k = 0; k < grid.count[2]; ++k)
    for (int j = 0; j < grid.count[1]; ++j)
      for (int i = 0; i < grid.count[0]; ++i) points.add(grid.at(i, j, k));
  return points;
}

/// Connected parts of the nodes inside, over faces and with equal orientation.
/// Returns the part of each node, -1 outside, and the parts' sizes.
std::vector<int> label(const NodeGrid& grid, const Probe::Answers& answers,
                       std::vector<int>& sizes) {
  std::vector<int> part(grid.size(), -1);
  std::vector<std::array<int, 3>> queue;
  const auto visit = [&](int i, int j, int k, int number, int orientation) {
    const std::size_t at = grid.index(i, j, k);
    if (part[at] >= 0 || !answers.inside(at) || answers.orientation[at] != orientation) return;
    part[at] = number;
    ++sizes[number];
    queue.push_back({i, j, k});
  };
  for (int k = 0; k < grid.count[2]; ++k)
    for (int j = 0; j < grid.count[1]; ++j)
      for (int i = 0; i < grid.count[0]; ++i) {
        const std::size_t start = grid.index(i, j, k);
        if (part[start] >= 0 || !answers.inside(start)) continue;
        const int number = static_cast<int>(sizes.size()), orientation = answers.orientation[start];
        sizes.push_back(0);
        visit(i, j, k, number, orientation);
        while (!queue.empty()) {
          const std::array<int, 3> node = queue.back();
          queue.pop_back();
          for (int axis = 0; axis < 3; ++axis)
            for (int way : {-1, 1}) {
              std::array<int, 3> next = node;
              next[axis] += way;
              if (next[axis] < 0 || next[axis] >= grid.count[axis]) continue;
              visit(next[0], next[1], next[2], number, orientation);
            }
        }
      }
  return part;
}

/// The part at a corner of home's cell, else the largest; -1 when there is none.
int choose_part(const NodeGrid& grid, const std::vector<int>& part, const std::vector<int>& sizes) {
  int chosen = -1;
  const auto consider = [&](int number) {
    if (number >= 0 && (chosen < 0 || sizes[number] > sizes[chosen])) chosen = number;
  };
  std::array<int, 3> low{};
  bool covered = true;
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.count[axis] == 1) continue;
    low[axis] = static_cast<int>(std::floor(-grid.origin[axis] / grid.step));
    covered = covered && low[axis] >= 0 && low[axis] < grid.count[axis] - 1;
  }
  for (int corner = 0; covered && corner < 8; ++corner) {
    std::array<int, 3> at = low;
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = std::min(low[axis] + (corner >> axis & 1), grid.count[axis] - 1);
    consider(part[grid.index(at[0], at[1], at[2])]);
  }
  if (chosen >= 0 || sizes.empty()) return chosen;
  return static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
}

void measure_extent(Region& region) {
  const double huge = std::numeric_limits<double>::infinity();
  region.extent = {Vector3::Constant(huge), Vector3::Constant(-huge)};
  for (int k = 0; k < region.grid.count[2]; ++k)
    for (int j = 0; j < region.grid.count[1]; ++j)
      for (int i = 0; i < region.grid.count[0]; ++i) {
        if (!region.inside[region.grid.index(i, j, k)]) continue;
        const Vector3 at = region.grid.at(i, j, k);
        region.extent.lower = region.extent.lower.cwiseMin(at);
        region.extent.upper = region.extent.upper.cwiseMax(at);
      }
}

/// Moves the sides of the box that the region touches outward, within `widest`. False when none is
/// moved.
bool make_room(Bounds& box, const Region& region, const Bounds& widest, double by) {
  const NodeGrid& grid = region.grid;
  const Vector3 first = grid.at(0, 0, 0),
                last = grid.at(grid.count[0] - 1, grid.count[1] - 1, grid.count[2] - 1);
  const Bounds before = box;
  for (int k = 0; k < 3; ++k) {
    if (grid.count[k] == 1) continue;
    if (region.extent.lower[k] <= first[k])
      box.lower[k] = std::max(widest.lower[k], box.lower[k] - by);
    if (region.extent.upper[k] >= last[k])
      box.upper[k] = std::min(widest.upper[k], box.upper[k] + by);
  }
  return box.lower != before.lower || box.upper != before.upper;
}

}  // namespace

Probe::Probe(const Evaluator& evaluator, const Eigen::Quaterniond& rotation)
    : Probe(evaluator, std::vector<Eigen::Quaterniond>{rotation}) {}

Probe::Probe(const Evaluator& evaluator, std::vector<Eigen::Quaterniond> rotations)
    : evaluator_(evaluator), rotations_(std::move(rotations)), names_(evaluator.limit_names()) {
  names_.push_back("singularity");
  names_.push_back("search box");
  for (int axis : evaluator.machine().task.axes)
    if (axis < 3) active_[axis] = true;
  square_ = evaluator.machine().model.drives.size() == evaluator.machine().task.axes.size();
  PoseBatch home;
  home.x = home.y = home.z = {0};
  BatchResult result;
  evaluator.evaluate(home, result);
  if (result.limit[0] < 0 && result.inverse_condition[0] > kSingular) side_ = result.orientation[0];
}

/// Slow poses in pieces, so that they can be counted; of a size that leaves the evaluator's blocks
/// and with them every bit as they are.
BatchResult Probe::evaluate(const PoseBatch& poses) const {
  constexpr std::size_t kPiece = 256;
  BatchResult result;
  if (!counter_ || evaluator_.closed_form() || poses.size() <= kPiece) {
    evaluator_.evaluate(poses, result);
    poses_ += poses.size();
    if (counter_) counter_(poses_);
    return result;
  }
  for (std::size_t first = 0; first < poses.size(); first += kPiece) {
    const auto count = static_cast<std::ptrdiff_t>(std::min(kPiece, poses.size() - first));
    const auto piece = [&](const std::vector<double>& all) {
      if (all.empty()) return all;
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
      return std::vector<double>(begin, begin + count);
    };
    PoseBatch part{piece(poses.x), piece(poses.y), piece(poses.z), poses.rotation, poses.wanted};
    for (std::size_t k = 0; k < 3; ++k) part.angles[k] = piece(poses.angles[k]);
    for (std::size_t k = 0; k < 4; ++k) part.quaternion[k] = piece(poses.quaternion[k]);
    BatchResult answers;
    evaluator_.evaluate(part, answers);
    const auto append = [](auto& all, const auto& some) {
      all.insert(all.end(), some.begin(), some.end());
    };
    append(result.limit, answers.limit);
    append(result.inverse_condition, answers.inverse_condition);
    append(result.orientation, answers.orientation);
    poses_ += part.size();
    counter_(poses_);
  }
  return result;
}

Probe::Answers Probe::ask(PoseBatch poses, bool conditioning) const {
  // Where J is square its determinant tells what is singular, and costs less.
  poses.wanted =
      !conditioning && square_ ? Wanted::orientation : Wanted::condition | Wanted::orientation;
  BatchResult result = evaluate(poses);
  if (crosses_) std::ranges::fill(result.orientation, 0);
  for (std::size_t i = 0; i < poses.size() && !crosses_; ++i) {
    const bool across = side_ != 0 && result.orientation[i] != side_;
    const bool regular = (poses.wanted & Wanted::condition) != 0
                             ? result.inverse_condition[i] > kSingular
                             : result.orientation[i] != 0;
    const bool walled = wall_ && wall_->beyond({poses.x[i], poses.y[i], poses.z[i]}) >= 0;
    if (result.limit[i] < 0 && (across || walled || !regular)) result.limit[i] = singularity();
  }
  return {std::move(result.limit), std::move(result.inverse_condition),
          std::move(result.orientation)};
}

Probe::Answers Probe::ask(const Points& points, bool conditioning) const {
  Answers answers = ask({points.x, points.y, points.z, rotations_.front()}, conditioning);
  if (rotations_.size() == 1) return answers;
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (answers.inside(i)) left.push_back(i);
  for (std::size_t r = 1; r < rotations_.size() && !left.empty(); ++r) {
    Points some;
    for (std::size_t i : left) some.add(points[i]);
    const Answers turned = ask({some.x, some.y, some.z, rotations_[r]}, conditioning);
    std::vector<std::size_t> still;
    for (std::size_t k = 0; k < left.size(); ++k) {
      const std::size_t i = left[k];
      answers.limit[i] = turned.limit[k];
      if (!turned.inverse_condition.empty())
        answers.inverse_condition[i] =
            std::min(answers.inverse_condition[i], turned.inverse_condition[k]);
      if (turned.inside(k)) still.push_back(i);
    }
    left = std::move(still);
  }
  return answers;
}

bool Probe::beyond_reach(const Vector3& place) const {
  return reach_ && ((place.array() < reach_->lower.array()).any() ||
                    (place.array() > reach_->upper.array()).any());
}

bool Probe::all_inside(const Points& points) const {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (beyond_reach(points[i])) return false;
  return std::all_of(rotations_.begin(), rotations_.end(), [&](const auto& rotation) {
    const Answers answers = ask({points.x, points.y, points.z, rotation}, false);
    return std::all_of(answers.limit.begin(), answers.limit.end(),
                       [](int limit) { return limit < 0; });
  });
}

Region explore(Probe& probe, const Bounds& box, int nodes) {
  Region region;
  region.grid = make_grid(probe, box, nodes);
  Probe::Answers answers = probe.ask(nodes_of(region.grid));
  if (!probe.wall())
    if (const auto wall = find_singular_wall(probe, region.grid, answers)) {
      probe.set_wall(*wall);
      answers = probe.ask(nodes_of(region.grid));
    }
  std::vector<int> sizes;
  const std::vector<int> part = label(region.grid, answers, sizes);
  const int chosen = choose_part(region.grid, part, sizes);
  region.empty = chosen < 0;
  region.inside.assign(region.grid.size(), 0);
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (chosen < 0 || part[i] != chosen) continue;
    region.inside[i] = 1;
    probe.set_side(answers.orientation[i]);
  }
  // What was tolerated on the other side while the side was open is singular now.
  for (std::size_t i = 0; i < part.size(); ++i)
    if (answers.inside(i) && probe.side() != 0 && answers.orientation[i] != probe.side())
      answers.limit[i] = probe.singularity();
  region.limit = std::move(answers.limit);
  region.inverse_condition = std::move(answers.inverse_condition);
  if (!region.empty) measure_extent(region);
  return region;
}

Region explore(Probe& probe, int nodes) {
  const int coarse = probe.evaluator().closed_form() ? 10000 : 500;
  const Bounds widest = search_bounds(probe);
  Bounds box = widest;
  Region found = explore(probe, box, std::min(nodes, coarse));
  // A small workspace falls between the nodes of a wide box: look nearer to home.
  Points home;
  home.add(Vector3::Zero());
  for (int look = 0; found.empty && look < 8 && probe.all_inside(home); ++look) {
    const Vector3 half = box.lower.cwiseAbs().cwiseMax(box.upper.cwiseAbs()) / 4;
    box = {box.lower.cwiseMax(-half), box.upper.cwiseMin(half)};
    found = explore(probe, box, std::min(nodes, coarse));
  }
  if (found.empty) return found;
  // Search bounds can be far too wide: close in.
  double margin = 0;
  for (int look = 0; look < 2; ++look) {
    margin = found.grid.step;
    const Vector3 before = box.upper - box.lower;
    for (int k = 0; k < 3; ++k) {
      if (!probe.active()[k]) continue;
      box.lower[k] = std::max(box.lower[k], found.extent.lower[k] - margin);
      box.upper[k] = std::min(box.upper[k], found.extent.upper[k] + margin);
    }
    if (look == 1 || ((box.upper - box.lower) - 0.5 * before).maxCoeff() >= 0) break;
    found = explore(probe, box, std::min(nodes, coarse));
    if (found.empty) return found;
  }
  // What bulges between coarse nodes, or hangs on by a neck that they miss, may pass the margin:
  // leave more where the region ends at it, and twice as much each time.
  constexpr int kMostLooks = 6;
  for (int look = 1;; ++look, margin *= 2) {
    found = explore(probe, box, nodes);
    if (found.empty || look == kMostLooks || !make_room(box, found, widest, margin)) return found;
  }
}

}  // namespace polyglide
