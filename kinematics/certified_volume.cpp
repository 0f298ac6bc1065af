#include "kinematics/certified_volume.hpp"

#include <tbb/parallel_for.h>

#include <numeric>
#include <unordered_map>

#include "kinematics/leg_bounds.hpp"

namespace polyglide {
namespace {

using Index = std::array<int, 3>;
using Mask = LegBounds::Mask;

/// Part of the unit cube where n·x <= t, all n >= 0, enclosed. Closed form by inclusion and
/// exclusion of corners; components far below the largest are taken into t.
Interval part_below(std::array<double, 3> n, const Interval& t) {
  const double largest = std::max({n[0], n[1], n[2]});
  if (!(largest > 0)) return {t.lower() >= 0 ? 1.0 : 0.0, t.upper() >= 0 ? 1.0 : 0.0};
  constexpr double kFlat = 1e-3;
  std::vector<double> used;
  Interval level = t;
  for (double each : n) {
    if (each > kFlat * largest)
      used.push_back(each);
    else
      level -= Interval(0, each);
  }
  const int m = static_cast<int>(used.size());
  const auto at = [&](double end) {
    Interval sum(0.0), product(1.0);
    for (int corner = 0; corner < 1 << m; ++corner) {
      Interval height(end);
      for (int i = 0; i < m; ++i)
        if (corner >> i & 1) height -= used[i];
      height = Interval(std::max(0.0, height.lower()), std::max(0.0, height.upper()));
      Interval power = height;
      for (int i = 1; i < m; ++i) power *= height;
      if (std::popcount(static_cast<unsigned>(corner)) % 2 == 0)
        sum += power;
      else
        sum -= power;
    }
    for (int i = 0; i < m; ++i) product *= used[i] * Interval(i + 1.0);
    const Interval part = sum / product;
    return Interval(std::clamp(part.lower(), 0.0, 1.0), std::clamp(part.upper(), 0.0, 1.0));
  };
  Interval total(0.0);
  for (double each : used) total += each;
  const double low = level.lower() <= 0               ? 0
                     : level.lower() >= total.upper() ? 1
                                                      : at(level.lower()).lower();
  const double high = level.upper() < 0                ? 0
                      : level.upper() >= total.upper() ? 1
                                                       : at(level.upper()).upper();
  return {low, high};
}

struct Cell {
  int level = 0;
  Index at{};
  Mask open;                    ///< limits not proved to hold on all of it
  bool regular = false;         ///< det J proved to have home's sign
  bool inside = false;          ///< wholly
  double lower = 0, upper = 1;  ///< part of it that is inside
  /// Corners (bits 0 to 7) and middles of faces (8 to 13) in the convex piece proved inside.
  unsigned points = 0;
};

class Octree {
 public:
  Octree(const LegBounds& limits, const Bounds& box, int side, bool holds_all)
      : limits_(limits), box_(box), side_(side), square_(side != 0), holds_all_(holds_all) {}

  std::optional<CertifiedVolume> run(double tolerance, int budget) {
    Cell root;
    for (std::size_t i = 0; i < limits_.size(); ++i) root.open.set(i);
    std::vector<Cell> start{root};
    classify(start);
    split_around_home(start);
    if (!holds_all_) split_along_box(start);
    cells_ = std::move(start);
    CertifiedVolume result;
    while (true) {
      const auto [lower, upper] = sums();
      if (upper <= 0) return std::nullopt;
      if (upper - lower <= kRoom * tolerance * upper || examined_ >= budget) break;
      const double gap = upper - lower;
      split_widest(std::max(gap - kRoom * tolerance * upper, gap / 8));
    }
    if (!bound_part(result)) return std::nullopt;
    result.cells = examined_;
    result.reached = result.upper - result.lower <= tolerance * result.upper;
    return result;
  }

 private:
  static constexpr double kRoom = 0.9;  // what is aimed at: joining parts loses a little
  static constexpr int kDeepest = 19;

  double corner(int axis, int level, int index) const {
    const double step = std::ldexp(box_.upper[axis] - box_.lower[axis], -level);
    return box_.lower[axis] + step * index;
  }

  /// The box of a cell. Neighbours share their rounded corners, so that no place is lost between.
  PoseBox box_of(const Cell& cell) const {
    PoseBox box;
    box.fill(Interval(0.0));
    for (int axis = 0; axis < 3; ++axis)
      box[axis] = Interval(corner(axis, cell.level, cell.at[axis]),
                           corner(axis, cell.level, cell.at[axis] + 1));
    return box;
  }

  /// False when the cell is out. `extra`, a place in [-1, 1]³ of the cell, is taken away when
  /// it is not in the piece proved inside.
  bool examine(Cell& cell, std::vector<LimitBound>& whole, std::vector<LimitBound>& middle_of,
               std::optional<Vector3>* extra = nullptr) const {
    const PoseBox box = box_of(cell);
    PoseBox centre = box;
    std::array<double, 3> half;
    for (int i = 0; i < 3; ++i) {
      centre[i] = Interval(middle(box[i]));
      half[i] = radius(box[i]);
    }
    limits_.enclose(box, cell.open, whole);
    limits_.enclose(centre, cell.open, middle_of);
    cell.upper = 1;
    Interval outside(0.0);
    cell.points = 0x3fff;
    for (std::size_t i = 0; i < limits_.size(); ++i) {
      if (!cell.open[i]) continue;
      const LimitBound& bound = whole[i];
      if (bound.value.lower() > 0) return false;
      // Slope of the plane in the middle, and how far the limit may be from that plane.
      std::array<double, 3> slope;
      Interval off(0.0), swing(0.0);
      bool smooth = true;
      for (int k = 0; k < 3; ++k) {
        const Interval& g = bound.gradient[k];
        smooth = smooth && std::isfinite(g.lower()) && std::isfinite(g.upper());
        if (!smooth) break;
        slope[k] = middle(g);
        off += radius(g) * Interval(half[k]);
        swing += std::abs(slope[k]) * Interval(half[k]);
      }
      if (!smooth) {
        if (bound.value.upper() <= 0) {
          cell.open.reset(i);
        } else {
          outside += 1.0;
          cell.points = 0;
          if (extra) extra->reset();
        }
        continue;
      }
      const Interval at = middle_of[i].value + Interval(-off.upper(), off.upper());
      const Interval value = at + Interval(-swing.upper(), swing.upper());
      if (value.lower() > 0) return false;
      if (value.upper() <= 0 || bound.value.upper() <= 0) {
        cell.open.reset(i);
        continue;
      }
      // at + Σ slope·half·ξ <= 0, ξ in [-1, 1], as n·x <= t on the unit cube.
      std::array<double, 3> n;
      Interval sum(0.0);
      Interval rounding(0.0);
      for (int k = 0; k < 3; ++k) {
        const Interval exact = std::abs(slope[k]) * Interval(half[k]);
        n[k] = 2 * middle(exact);
        rounding += Interval(-1, 1) * radius(exact);
        sum += exact;
      }
      const Interval part = part_below(n, sum - at + 2.0 * rounding);
      outside += 1.0 - Interval(part.lower());
      cell.upper = std::min(cell.upper, part.upper());
      const auto holds = [&](const Vector3& place) {
        Interval height(at.upper());
        for (int k = 0; k < 3; ++k) height += Interval(place[k]) * slope[k] * half[k];
        return height.upper() <= 0;
      };
      for (int point = 0; point < 14; ++point)
        if ((cell.points >> point & 1) && !holds(place_of(point))) cell.points &= ~(1u << point);
      if (extra && *extra && !holds(**extra)) extra->reset();
    }
    if (cell.upper <= 0) return false;
    if (!cell.regular && !look_at_jacobian(box, cell)) return false;
    cell.inside = cell.regular && cell.open.none();
    cell.lower = cell.inside ? 1 : std::max(0.0, (1.0 - outside).lower());
    if (!cell.regular) cell.lower = 0;
    if (cell.lower <= 0) cell.points = 0;
    return true;
  }

  /// Coordinate of a marked point in [-1, 1]: 8 corners, then the middles of the 6 faces.
  static double way_of(int point, int axis) {
    if (point < 8) return point >> axis & 1 ? 1 : -1;
    if ((point - 8) / 2 != axis) return 0;
    return (point - 8) % 2 ? 1 : -1;
  }

  static Vector3 place_of(int point) {
    return {way_of(point, 0), way_of(point, 1), way_of(point, 2)};
  }

  /// False when det J has the other sign on all of the cell.
  bool look_at_jacobian(const PoseBox& box, Cell& cell) const {
    const IntervalMatrix jacobian = limits_.rod_rows(box);
    if (!square_) {
      cell.regular = singular_value_bounds(jacobian).least_lower > 0;
      return true;
    }
    const int sign = determinant_sign(jacobian);
    cell.regular = sign == side_;
    return sign != -side_;
  }

  /// Examines all, on all threads; leaves those that are not out, in their order.
  void classify(std::vector<Cell>& cells) {
    std::vector<char> keep(cells.size(), 0);
    constexpr std::size_t kBlock = 64;
    tbb::parallel_for(std::size_t{0}, (cells.size() + kBlock - 1) / kBlock, [&](std::size_t b) {
      const UpwardRounding rounding;
      std::vector<LimitBound> whole, middles;
      const std::size_t end = std::min(cells.size(), (b + 1) * kBlock);
      for (std::size_t i = b * kBlock; i < end; ++i) keep[i] = examine(cells[i], whole, middles);
    });
    examined_ += static_cast<int>(cells.size());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (keep[i]) cells[kept++] = cells[i];
    cells.resize(kept);
  }

  static void split(const Cell& cell, std::vector<Cell>& into) {
    for (int part = 0; part < 8; ++part) {
      Cell child = cell;
      child.level = cell.level + 1;
      for (int k = 0; k < 3; ++k) child.at[k] = 2 * cell.at[k] + (part >> k & 1);
      into.push_back(child);
    }
  }

  bool holds_home(const Cell& cell) const {
    for (int k = 0; k < 3; ++k)
      if (corner(k, cell.level, cell.at[k]) > 0 || corner(k, cell.level, cell.at[k] + 1) < 0)
        return false;
    return true;
  }

  bool touches_box(const Cell& cell) const {
    for (int k = 0; k < 3; ++k)
      if (cell.at[k] == 0 || cell.at[k] == (1 << cell.level) - 1) return true;
    return false;
  }

  /// Where strokes are unlimited the box is a guess: small cells along it show that it was wide
  /// enough.
  void split_along_box(std::vector<Cell>& cells) {
    constexpr int kFine = 6;
    for (int level = 0; level < kFine; ++level) {
      std::vector<Cell> children, others;
      for (const Cell& cell : cells) {
        if (touches_box(cell) && cell.level < kFine)
          split(cell, children);
        else
          others.push_back(cell);
      }
      classify(children);
      cells = std::move(others);
      cells.insert(cells.end(), children.begin(), children.end());
    }
  }

  /// Small cells around home until one that holds it is wholly inside.
  void split_around_home(std::vector<Cell>& cells) {
    for (int level = 0; level < 14; ++level) {
      std::vector<Cell> children, others;
      for (const Cell& cell : cells) {
        if (holds_home(cell)) {
          if (cell.inside) return;
          split(cell, children);
        } else {
          others.push_back(cell);
        }
      }
      if (children.empty()) return;
      classify(children);
      cells = std::move(others);
      cells.insert(cells.end(), children.begin(), children.end());
    }
  }

  double volume_of(const Cell& cell) const {
    const Vector3 size = box_.upper - box_.lower;
    return std::ldexp(size.prod(), -3 * cell.level);
  }

  std::pair<double, double> sums() const {
    double lower = 0, upper = 0;
    for (const Cell& cell : cells_) {
      lower += cell.lower * volume_of(cell);
      upper += cell.upper * volume_of(cell);
    }
    return {lower, upper};
  }

  /// Splits the cells with the widest bounds, enough to hold most of `excess`.
  void split_widest(double excess) {
    std::vector<std::pair<double, int>> gaps;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const double gap = (cells_[i].upper - cells_[i].lower) * volume_of(cells_[i]);
      if (gap > 0 && cells_[i].level < kDeepest) gaps.emplace_back(gap, static_cast<int>(i));
    }
    std::sort(gaps.begin(), gaps.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    if (gaps.empty()) {
      examined_ = std::numeric_limits<int>::max();
      return;
    }
    std::vector<char> chosen(cells_.size(), 0);
    double sum = 0;
    for (const auto& [gap, cell] : gaps) {
      if (sum > excess) break;
      sum += gap;
      chosen[cell] = 1;
    }
    std::vector<Cell> children, rest;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      if (chosen[i])
        split(cells_[i], children);
      else
        rest.push_back(cells_[i]);
    }
    classify(children);
    rest.insert(rest.end(), children.begin(), children.end());
    cells_ = std::move(rest);
  }

  static std::uint64_t key(int level, const Index& at) {
    std::uint64_t result = static_cast<std::uint64_t>(level);
    for (int k = 0; k < 3; ++k) result = result << 19 | static_cast<std::uint64_t>(at[k]);
    return result;
  }

  /// Calls visit(neighbour) for the cell of equal or lower level across, if any is left.
  template <typename Visit>
  void neighbour(const Cell& cell, const Index& way, const Visit& visit) const {
    Index at;
    for (int k = 0; k < 3; ++k) {
      at[k] = cell.at[k] + way[k];
      if (at[k] < 0 || at[k] >= 1 << cell.level) return;
    }
    for (int level = cell.level; level >= lowest_; --level) {
      const auto found = places_.find(key(level, at));
      if (found != places_.end()) {
        visit(found->second);
        return;
      }
      for (int& each : at) each >>= 1;
    }
  }

  /// Whether the pieces proved inside have a common point; `a` is the finer one.
  bool joined(const Cell& a, const Cell& b, int axis, int way) const {
    if (!a.points || !(b.lower > 0)) return false;
    if (b.inside) {
      // Any marked point of a on the shared face will do.
      for (int point = 0; point < 14; ++point)
        if ((a.points >> point & 1) && way_of(point, axis) == way) return true;
      return false;
    }
    if (a.level != b.level) return joined_across_levels(a, b, axis, way);
    for (int point = 0; point < 8; ++point)
      if (way_of(point, axis) == way && (a.points >> point & 1) &&
          (b.points >> (point ^ (1 << axis)) & 1))
        return true;
    return (a.points >> (8 + 2 * axis + (way > 0)) & 1) &&
           (b.points >> (8 + 2 * axis + (way < 0)) & 1);
  }

  /// The same where b is coarser and crossed: its piece is asked about the marked points of a.
  bool joined_across_levels(const Cell& a, const Cell& b, int axis, int way) const {
    const UpwardRounding rounding;
    std::vector<LimitBound> whole, middles;
    const double scale = std::ldexp(1.0, b.level - a.level);
    for (int point = 0; point < 14; ++point) {
      if (!(a.points >> point & 1) || way_of(point, axis) != way) continue;
      // From a's own coordinates to those of b: halves and quarters, so exact.
      Vector3 place;
      for (int k = 0; k < 3; ++k)
        place[k] = 2 * scale * (a.at[k] + (way_of(point, k) + 1) / 2) - 2 * b.at[k] - 1;
      std::optional<Vector3> extra = place;
      Cell copy = b;
      if (examine(copy, whole, middles, &extra) && extra) return true;
    }
    return false;
  }

  /// Bounds of the part around home; false when it cannot be told.
  bool bound_part(CertifiedVolume& result) {
    lowest_ = kDeepest;
    places_.reserve(2 * cells_.size());
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      places_.emplace(key(cells_[i].level, cells_[i].at), static_cast<int>(i));
      lowest_ = std::min(lowest_, cells_[i].level);
    }
    const int count = static_cast<int>(cells_.size());
    std::vector<int> sure(count), maybe(count);
    std::iota(sure.begin(), sure.end(), 0);
    std::iota(maybe.begin(), maybe.end(), 0);
    const auto root = [](std::vector<int>& group, int i) {
      while (group[i] != i) i = group[i] = group[group[i]];
      return i;
    };
    const auto join = [&](std::vector<int>& group, int a, int b) {
      group[root(group, a)] = root(group, b);
    };
    for (int i = 0; i < count; ++i)
      for (int axis = 0; axis < 3; ++axis)
        for (int way : {-1, 1}) {
          Index step{};
          step[axis] = way;
          neighbour(cells_[i], step, [&](int other) {
            join(maybe, i, other);
            if (root(sure, i) != root(sure, other) && joined(cells_[i], cells_[other], axis, way))
              join(sure, i, other);
          });
        }
    int home = -1;
    for (int i = 0; i < count; ++i)
      if (holds_home(cells_[i]) && (home < 0 || cells_[i].inside)) home = i;
    if (home < 0) return false;
    const bool apart = [&] {
      for (int i = 0; i < count; ++i)
        if (root(maybe, i) != root(maybe, home)) return true;
      return false;
    }();
    // Cells that touch in an edge or a corner only are not separated either.
    if (apart)
      for (int i = 0; i < count; ++i)
        for (int code = 0; code < 27; ++code) {
          const Index step{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
          if (std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]) < 2) continue;
          neighbour(cells_[i], step, [&](int other) { join(maybe, i, other); });
        }
    const UpwardRounding rounding;
    Interval lower(0.0), upper(0.0);
    for (int i = 0; i < count; ++i) {
      const Cell& cell = cells_[i];
      if (root(maybe, i) != root(maybe, home)) continue;
      if (!holds_all_ && touches_box(cell)) return false;
      const PoseBox box = box_of(cell);
      Interval size(1.0);
      for (int k = 0; k < 3; ++k) size *= Interval(box[k].upper()) - box[k].lower();
      upper += cell.upper * size;
      if (cells_[home].inside && cell.lower > 0 && root(sure, i) == root(sure, home))
        lower += cell.lower * size;
    }
    result.lower = lower.lower();
    result.upper = upper.upper();
    return true;
  }

  const LegBounds& limits_;
  Bounds box_;
  int side_;
  bool square_, holds_all_;
  int examined_ = 0, lowest_ = 0;
  std::vector<Cell> cells_;
  std::unordered_map<std::uint64_t, int> places_;
};

}  // namespace

std::optional<CertifiedVolume> certify_volume(const Machine& machine,
                                              const std::vector<std::string>& ignored,
                                              const Eigen::Quaterniond& rotation, const Bounds& box,
                                              double tolerance, int budget) {
  if (machine.task.translations != 3) return std::nullopt;
  const auto asked = coordinates_of({Vector3::Zero(), rotation.normalized()});
  for (int axis = 3; axis < 6; ++axis)
    if (std::abs(asked[axis]) > 1e-9 &&
        std::count(machine.task.axes.begin(), machine.task.axes.end(), axis) == 0)
      return std::nullopt;
  std::optional<LegBounds> limits, at_home;
  int side = 0;
  {
    const UpwardRounding rounding;
    limits = LegBounds::make(machine, ignored, rotation, false);
    at_home = LegBounds::make(machine, ignored, Eigen::Quaterniond::Identity(), false);
    if (!limits || !at_home) return std::nullopt;
    PoseBox home;
    home.fill(Interval(0.0));
    const IntervalMatrix jacobian = at_home->rod_rows(home);
    if (jacobian.rows() < jacobian.cols()) return std::nullopt;
    if (jacobian.rows() == jacobian.cols()) {
      side = determinant_sign(jacobian);
      if (side == 0) return std::nullopt;
    }
  }
  // A margin, so that what is inside does not touch the box, and uneven, so that faces
  // of the workspace do not lie in faces of cells.
  Bounds roomy = box;
  const Vector3 size = box.upper - box.lower;
  if (!size.allFinite() || !(size.minCoeff() > 0)) return std::nullopt;
  roomy.lower -= size.cwiseProduct(Vector3(0.0131, 0.0173, 0.0119));
  roomy.upper += size.cwiseProduct(Vector3(0.0157, 0.0109, 0.0147));
  const bool limited =
      std::all_of(machine.legs->legs.begin(), machine.legs->legs.end(), [](const Leg& leg) {
        return std::isfinite(leg.stroke.max) &&
               (leg.kind == Leg::Kind::strut || std::isfinite(leg.stroke.min));
      });
  return Octree(*limits, roomy, side, limited).run(tolerance, budget);
}

}  // namespace polyglide
