#include "kinematics/singularity_map.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "kinematics/contours.hpp"
#include "kinematics/mobility.hpp"
#include "kinematics/region.hpp"
#include "kinematics/touched_curves.hpp"

namespace polyglide {
namespace {

using Coordinates = Eigen::Matrix<double, 6, 1>;
using std::numbers::pi;

constexpr double kSingular = 1e-6;   // 1/κ
constexpr double kSuspect = 0.02;    // 1/κ below which a cell is refined
constexpr signed char kUnknown = 2;  // class of nodes that were not asked

/// All limits of an evaluator but those without which there is no posture.
std::vector<std::string> limits_to_ignore(const Evaluator& evaluator) {
  std::vector<std::string> names;
  for (const std::string& name : evaluator.limit_names())
    if (!name.starts_with("reach") && name != "motion" && name != "not finite")
      names.push_back(name);
  return names;
}

struct Axis {
  double from = 0, step = 0;
  int count = 0;
  [[nodiscard]] double at(double node) const { return from + step * node; }
};

class Mapper {
 public:
  Mapper(const Machine& machine, const SingularityMapOptions& options)
      : options_(options),
        limited_(machine, options.ignored),
        free_(machine, limits_to_ignore(limited_)),
        cut_(free_.closed_form() ? 4 : 2),
        near_(free_.closed_form() ? 1e-4 : 1e-3),
        at_reach_(free_.closed_form() ? 1e-2 : 4e-2) {
    map_.axes = options.axes;
    map_.at = options.at;
    map_.square = machine.model.drives.size() == machine.task.axes.size();
    map_.limits = limited_.limit_names();
  }

  SingularityMap run() {
    choose_range();
    put_axes(nodes());
    fill();
    refine();
    trace(reach_, true);
    if (map_.square) trace(side_, false);
    if (map_.square) trace_touched();
    return std::move(map_);
  }

 private:
  [[nodiscard]] int nodes() const {
    return options_.nodes > 0 ? std::max(options_.nodes, 4) : free_.closed_form() ? 100 : 28;
  }

  using Places = std::vector<std::array<double, 2>>;  ///< u, v

  BatchResult ask(const Evaluator& evaluator, const Places& places, bool condition) {
    // Slow machines in pieces, so that progress is seen.
    const std::size_t piece = evaluator.closed_form() ? places.size() + 1 : 256;
    BatchResult all;
    for (std::size_t first = 0; first < places.size(); first += piece) {
      PoseBatch batch;
      batch.wanted = condition ? Wanted::condition | Wanted::orientation : Wanted::orientation;
      for (auto& column : batch.angles) column.clear();
      const std::size_t last = std::min(places.size(), first + piece);
      for (std::size_t i = first; i < last; ++i) {
        Coordinates c = options_.at;
        for (int k = 0; k < 2; ++k) c[options_.axes[k]] = places[i][k];
        batch.x.push_back(c[0]);
        batch.y.push_back(c[1]);
        batch.z.push_back(c[2]);
        for (int k = 0; k < 3; ++k) batch.angles[k].push_back(c[3 + k]);
      }
      BatchResult answers;
      evaluator.evaluate(batch, answers);
      const auto append = [](auto& to, const auto& from) {
        to.insert(to.end(), from.begin(), from.end());
      };
      append(all.limit, answers.limit);
      append(all.inverse_condition, answers.inverse_condition);
      append(all.orientation, answers.orientation);
      map_.poses += batch.size();
      if (options_.progress) {
        const auto done = static_cast<double>(map_.poses);
        const double expected = (free_.closed_form() ? 1.5e5 : 1.2e4);
        options_.progress(done, done < expected ? expected : 0);
      }
    }
    return all;
  }

  Places grid() const {
    Places places;
    for (int j = 0; j < v_.count; ++j)
      for (int i = 0; i < u_.count; ++i) places.push_back({u_.at(i), v_.at(j)});
    return places;
  }

  void put_axes(int longest) {
    std::array<double, 2> span, weight;
    for (int k = 0; k < 2; ++k) {
      span[k] = range_[k][1] - range_[k][0];
      weight[k] = options_.axes[k] < 3 ? 1 : free_.machine().task.characteristic_length;
    }
    const double step = std::max({span[0] * weight[0], span[1] * weight[1], 1e-9}) / (longest - 1);
    std::array<Axis*, 2> axes{&u_, &v_};
    for (int k = 0; k < 2; ++k) {
      const int cells = std::max(3, static_cast<int>(std::lround(span[k] * weight[k] / step)));
      *axes[k] = {range_[k][0], span[k] / cells, cells + 1};
    }
  }

  /// First all that could be, then closer: round what is within limits, or can be reached.
  void choose_range() {
    Probe probe(limited_, pose_of(options_.at).rotation);
    const Bounds bounds = search_bounds(probe);
    for (int k = 0; k < 2; ++k) {
      const int axis = options_.axes[k];
      if (axis < 3)
        range_[k] = {bounds.lower[axis], bounds.upper[axis]};
      else
        range_[k] = {axis == 4 ? -pi / 2 : -pi, axis == 4 ? pi / 2 : pi};
    }
    map_.poses += probe.poses();
    for (int look = 0; look < 2; ++look) {
      put_axes(free_.closed_form() ? 60 : 16);
      const Places places = grid();
      const BatchResult limited = ask(limited_, places, false);
      if (close_in(places, limited)) continue;
      if (!close_in(places, ask(free_, places, false))) break;
    }
  }

  /// Draws the range closer about the places that have no limit; false when there are none.
  bool close_in(const Places& places, const BatchResult& answers) {
    const double huge = std::numeric_limits<double>::infinity();
    std::array<std::array<double, 2>, 2> found{{{huge, -huge}, {huge, -huge}}};
    for (std::size_t i = 0; i < places.size(); ++i)
      for (int k = 0; k < 2 && answers.limit[i] < 0; ++k) {
        found[k][0] = std::min(found[k][0], places[i][k]);
        found[k][1] = std::max(found[k][1], places[i][k]);
      }
    if (found[0][0] > found[0][1]) return false;
    const std::array<double, 2> step{u_.step, v_.step};
    for (int k = 0; k < 2; ++k) {
      const double margin = 0.15 * (found[k][1] - found[k][0]) + 2 * step[k];
      range_[k] = {std::max(range_[k][0], found[k][0] - margin),
                   std::min(range_[k][1], found[k][1] + margin)};
    }
    return true;
  }

  void fill() {
    const Places places = grid();
    const BatchResult free = ask(free_, places, true), limited = ask(limited_, places, false);
    for (int i = 0; i < u_.count; ++i) map_.u.push_back(u_.at(i));
    for (int j = 0; j < v_.count; ++j) map_.v.push_back(v_.at(j));
    map_.limit = limited.limit;
    map_.side = free.orientation;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const bool posture = free.limit[i] < 0;
      map_.inverse_condition.push_back(posture ? free.inverse_condition[i]
                                               : std::numeric_limits<double>::quiet_NaN());
      map_.singular_nodes += posture && free.inverse_condition[i] < kSingular;
    }
  }

  /// Classes of the fine nodes in and about the cells where something changes.
  void refine() {
    fine_width_ = (u_.count - 1) * cut_ + 1;
    const int height = (v_.count - 1) * cut_ + 1;
    reach_.assign(static_cast<std::size_t>(fine_width_) * height, kUnknown);
    side_ = reach_;
    map_.cell = {u_.step / cut_, v_.step / cut_};
    std::vector<char> wanted(reach_.size(), 0);
    for (int j = 0; j + 1 < v_.count; ++j)
      for (int i = 0; i + 1 < u_.count; ++i) {
        if (!changes(i, j)) continue;
        for (int b = std::max(0, (j - 1) * cut_); b <= std::min(height - 1, (j + 2) * cut_); ++b)
          for (int a = std::max(0, (i - 1) * cut_); a <= std::min(fine_width_ - 1, (i + 2) * cut_);
               ++a)
            wanted[a + static_cast<std::size_t>(fine_width_) * b] = 1;
      }
    Places places;
    std::vector<std::size_t> index;
    for (std::size_t n = 0; n < wanted.size(); ++n) {
      if (!wanted[n]) continue;
      index.push_back(n);
      places.push_back(
          place({static_cast<double>(n % fine_width_), static_cast<double>(n / fine_width_)}));
    }
    const BatchResult answers = ask(free_, places, false);
    for (std::size_t i = 0; i < index.size(); ++i) {
      reach_[index[i]] = answers.limit[i] < 0;
      // The side of a posture without one is that of no crossing: class 1.
      if (answers.limit[i] < 0) side_[index[i]] = answers.orientation[i] >= 0;
    }
  }

  bool changes(int i, int j) const {
    bool some = false, none = false, plus = false, minus = false, suspect = false;
    for (int c = 0; c < 4; ++c) {
      const std::size_t n = i + (c & 1) + static_cast<std::size_t>(u_.count) * (j + (c >> 1));
      const double inverse_condition = map_.inverse_condition[n];
      const bool posture = !std::isnan(inverse_condition);
      (posture ? some : none) = true;
      if (!posture) continue;
      (map_.side[n] >= 0 ? plus : minus) = true;
      suspect = suspect || inverse_condition < kSuspect;
    }
    return (some && none) || (plus && minus) || (suspect && free_.closed_form());
  }

  /// Fine node units to u, v.
  [[nodiscard]] std::array<double, 2> place(const std::array<double, 2>& node) const {
    return {u_.at(node[0] / cut_), v_.at(node[1] / cut_)};
  }

  [[nodiscard]] bool is_one(const BatchResult& answers, std::size_t i, bool reach) const {
    return answers.limit[i] < 0 && (reach || answers.orientation[i] >= 0);
  }

  void bisect(std::vector<CrossedEdge>& edges, bool reach, int rounds) {
    for (int round = 0; round < rounds && !edges.empty(); ++round) {
      Places middles;
      for (const CrossedEdge& edge : edges) middles.push_back(place(middle(edge)));
      const BatchResult answers = ask(free_, middles, false);
      for (std::size_t e = 0; e < edges.size(); ++e)
        (is_one(answers, e, reach) ? edges[e].one : edges[e].other) = middle(edges[e]);
    }
  }

  static std::array<double, 2> middle(const CrossedEdge& edge) {
    return {(edge.one[0] + edge.other[0]) / 2, (edge.one[1] + edge.other[1]) / 2};
  }

  void trace(const std::vector<signed char>& classes, bool reach) {
    const int rounds = free_.closed_form() ? 36 : 8;
    for (const Contour& contour :
         contours(classes, fine_width_, [&](auto& edges) { bisect(edges, reach, rounds); })) {
      SingularCurve curve;
      curve.closed = contour.closed;
      for (const auto& point : contour.points) curve.points.push_back(place(point));
      if (classify(curve, reach) || reach)
        map_.curves.push_back(std::move(curve));
      else
        ++map_.branch_changes;
    }
  }

  /// Curves on which det J is zero and on both sides of which it has one sign.
  void trace_touched() {
    const auto ask_nodes = [&](const Places& nodes) {
      Places places;
      for (const auto& [i, j] : nodes) places.push_back({u_.at(i), v_.at(j)});
      return ask(free_, places, true).inverse_condition;
    };
    for (const Contour& contour :
         touched_curves(map_.inverse_condition, map_.side, u_.count, ask_nodes)) {
      SingularCurve curve;
      curve.closed = contour.closed;
      for (const auto& [i, j] : contour.points) curve.points.push_back({u_.at(i), v_.at(j)});
      if (classify(curve, false)) map_.curves.push_back(std::move(curve));
    }
  }

  /// Looks at postures along a curve until one is singular; the points are on its side of class 1.
  /// False when none is.
  bool classify(SingularCurve& curve, bool reach) {
    const Machine& machine = free_.machine();
    if (mobility_ < 0) mobility_ = analyse_mobility(machine.model, screening_options(1)).finite;
    for (double part : {0.5, 0.25, 0.75}) {
      const auto last = static_cast<double>(curve.points.size() - 1);
      const auto& point = curve.points[static_cast<std::size_t>(std::lround(part * last))];
      Coordinates c = options_.at;
      for (int k = 0; k < 2; ++k) c[options_.axes[k]] = point[k];
      Posture posture = home(machine.model);
      if (!solve_inverse_general(machine, pose_of(c), posture).reachable) continue;
      const Singularity found =
          singularity_at(machine, posture, mobility_, reach ? at_reach_ : near_);
      if (found.regular()) continue;
      const auto add = [&](bool has, const char* word) {
        if (has) curve.kind += (curve.kind.empty() ? "" : " and ") + std::string(word);
      };
      add(found.direct && !(reach && found.inverse), "direct");
      add(found.inverse, "inverse");
      add(found.constraint, "constraint");
      curve.gained = found.gained;
      curve.lost = found.lost;
      return true;
    }
    curve.kind = "end of reach";
    return false;
  }

  const SingularityMapOptions& options_;
  Evaluator limited_, free_;
  int cut_;          ///< refined cells per side of a cell
  double near_;      ///< margins beside a curve that was bisected
  double at_reach_;  ///< the same at an end of reach: they fall with the root of what is left
  std::array<std::array<double, 2>, 2> range_{};
  Axis u_, v_;
  int fine_width_ = 0, mobility_ = -1;
  std::vector<signed char> reach_, side_;
  SingularityMap map_;
};

void check(const Machine& machine, const SingularityMapOptions& options) {
  const auto commands = [&](int axis) {
    return std::count(machine.task.axes.begin(), machine.task.axes.end(), axis) > 0;
  };
  if (options.axes[0] == options.axes[1] || !commands(options.axes[0]) ||
      !commands(options.axes[1]))
    throw std::invalid_argument("singularity_map: axes must be two that the machine commands");
  if (!options.at.allFinite())
    throw std::invalid_argument("singularity_map: the place is not finite");
}

}  // namespace

SingularityMap singularity_map(const Machine& machine, const SingularityMapOptions& options) {
  check(machine, options);
  const auto start = std::chrono::steady_clock::now();
  SingularityMap map = Mapper(machine, options).run();
  map.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return map;
}

}  // namespace polyglide
