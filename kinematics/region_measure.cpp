#include "kinematics/region_measure.hpp"

#include <algorithm>
#include <cmath>

namespace polyglide {
namespace {

constexpr std::size_t kBatch = 200000;  // poses asked at a time, to bound memory

/// Uniform in [0, 1) from three numbers (SplitMix64), so that every sample has its
/// own place whatever the order of work.
double jitter(std::uint64_t cell, std::uint64_t sample, std::uint64_t axis) {
  std::uint64_t z = (cell * 4096 + sample) * 3 + axis + 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

class Measurer {
 public:
  Measurer(const Probe& probe, const Region& region, const RegionFineness& fineness)
      : probe_(probe), region_(region), grid_(region.grid), fineness_(fineness) {
    cell_size_ = 1;
    for (int axis = 0; axis < 3; ++axis) {
      active_[axis] = grid_.count[axis] > 1;
      cells_[axis] = std::max(grid_.count[axis] - 1, 1);
      if (active_[axis]) cell_size_ *= grid_.step;
    }
  }

  RegionMeasure run(double accuracy) {
    classify();
    promote_neighbours();
    start();
    sample(accuracy);
    bound();
    return result_;
  }

 private:
  enum State : char { out, in, mixed };
  using Cell = std::array<int, 3>;

  std::size_t number(const Cell& c) const {
    return static_cast<std::size_t>(c[0]) + static_cast<std::size_t>(cells_[0]) *
                                                (c[1] + static_cast<std::size_t>(cells_[1]) * c[2]);
  }

  template <typename Visit>
  void for_cells(const Visit& visit) const {
    for (int k = 0; k < cells_[2]; ++k)
      for (int j = 0; j < cells_[1]; ++j)
        for (int i = 0; i < cells_[0]; ++i) visit(Cell{i, j, k});
  }

  template <typename Visit>
  void for_corners(const Cell& cell, const Visit& visit) const {
    for (int c = 0; c < 8; ++c) {
      Cell node = cell;
      bool exists = true;
      for (int axis = 0; axis < 3; ++axis) {
        node[axis] += c >> axis & 1;
        exists = exists && node[axis] < grid_.count[axis];
      }
      if (exists) visit(grid_.index(node[0], node[1], node[2]));
    }
  }

  void classify() {
    state_.assign(static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2], out);
    for_cells([this](const Cell& cell) {
      int inside = 0, corners = 0;
      for_corners(cell, [&](std::size_t node) {
        inside += region_.inside[node];
        ++corners;
      });
      state_[number(cell)] = inside == 0 ? out : inside == corners ? in : mixed;
    });
  }

  /// One place in each of strata × strata × strata equal parts of the cell.
  void add_samples(const Cell& cell, int strata, int first, Points& points) const {
    Cell parts;
    for (int axis = 0; axis < 3; ++axis) parts[axis] = active_[axis] ? strata : 1;
    std::uint64_t sample = static_cast<std::uint64_t>(first);
    for (int c = 0; c < parts[2]; ++c)
      for (int b = 0; b < parts[1]; ++b)
        for (int a = 0; a < parts[0]; ++a, ++sample) {
          Vector3 at = grid_.at(cell[0], cell[1], cell[2]);
          const Cell part{a, b, c};
          for (int axis = 0; axis < 3; ++axis)
            if (active_[axis])
              at[axis] +=
                  grid_.step *
                  (part[axis] + jitter(number(cell), sample, static_cast<std::uint64_t>(axis))) /
                  strata;
          points.add(at);
        }
  }

  int samples_per_cell(int strata) const {
    int samples = 1;
    for (bool active : active_) samples *= active ? strata : 1;
    return samples;
  }

  /// Asks `strata`-samples in all `cells` and hands each cell its answers.
  template <typename Use>
  void ask(const std::vector<Cell>& cells, int strata, int first, const Use& use) const {
    const std::size_t per_cell = static_cast<std::size_t>(samples_per_cell(strata));
    const std::size_t batch = std::max<std::size_t>(1, kBatch / per_cell);
    for (std::size_t begin = 0; begin < cells.size(); begin += batch) {
      const std::size_t end = std::min(cells.size(), begin + batch);
      Points points;
      points.reserve((end - begin) * per_cell);
      for (std::size_t c = begin; c < end; ++c) add_samples(cells[c], strata, first, points);
      const Probe::Answers answers = probe_.ask(points);
      for (std::size_t c = begin; c < end; ++c) use(c, answers, (c - begin) * per_cell, per_cell);
    }
  }

  /// A thin fin or notch may pass between the corners of a cell, but hardly far
  /// from the boundary the corners do see.
  void promote_neighbours() {
    std::vector<Cell> doubtful;
    for_cells([&](const Cell& cell) {
      if (state_[number(cell)] == mixed) return;
      bool beside = false;
      for (int n = 0; n < 27 && !beside; ++n) {
        const Cell next{cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1};
        bool exists = true;
        for (int axis = 0; axis < 3; ++axis)
          exists = exists && next[axis] >= 0 && next[axis] < cells_[axis];
        beside = exists && state_[number(next)] == mixed;
      }
      if (beside) doubtful.push_back(cell);
    });
    std::vector<std::size_t> promoted;
    ask(doubtful, fineness_.probes >= 8 ? 2 : 1, 4000,
        [&](std::size_t c, const Probe::Answers& answers, std::size_t at, std::size_t count) {
          const std::size_t cell = number(doubtful[c]);
          const bool expected = state_[cell] == in;
          for (std::size_t i = at; i < at + count; ++i)
            if (answers.inside(i) != expected) {
              promoted.push_back(cell);
              return;
            }
        });
    for (std::size_t cell : promoted) state_[cell] = mixed;
  }

  void start() {
    result_.layers.assign(cells_[2], 0);
    result_.worst = 1;
    for_cells([this](const Cell& cell) {
      const std::size_t at = number(cell);
      if (state_[at] == mixed) mixed_.push_back(cell);
      if (state_[at] != in) return;
      double sum = 0;
      int corners = 0;
      for_corners(cell, [&](std::size_t node) {
        sum += region_.inverse_condition[node];
        ++corners;
      });
      whole_ += 1;
      condition_ += sum / corners;
      result_.layers[cell[2]] += cell_size_;
    });
    for (std::size_t node = 0; node < grid_.size(); ++node)
      if (region_.inside[node]) see(region_.inverse_condition[node]);
  }

  void see(double inverse_condition) {
    result_.worst = std::min(result_.worst, inverse_condition);
    result_.best = std::max(result_.best, inverse_condition);
  }

  void sample(double accuracy) {
    std::vector<double> share(mixed_.size(), 0), squares(mixed_.size(), 0);
    double condition = 0;
    int rounds = 0;
    const int per_cell = samples_per_cell(fineness_.strata);
    while (rounds < fineness_.rounds) {
      ask(mixed_, fineness_.strata, rounds * per_cell,
          [&](std::size_t c, const Probe::Answers& answers, std::size_t at, std::size_t count) {
            int hits = 0;
            for (std::size_t i = at; i < at + count; ++i) {
              if (!answers.inside(i)) continue;
              ++hits;
              condition += answers.inverse_condition[i] / per_cell;
              see(answers.inverse_condition[i]);
            }
            const double part = static_cast<double>(hits) / per_cell;
            share[c] += part;
            squares[c] += part * part;
          });
      ++rounds;
      if (rounds < 2) continue;
      double variance = 0, sum = whole_;
      for (std::size_t c = 0; c < share.size(); ++c) {
        const double mean = share[c] / rounds;
        sum += mean;
        variance += std::max(0.0, squares[c] / rounds - mean * mean) / (rounds - 1);
      }
      result_.value = sum * cell_size_;
      result_.standard_error = std::sqrt(variance) * cell_size_;
      if (result_.standard_error <= accuracy * result_.value) break;
    }
    for (std::size_t c = 0; c < mixed_.size(); ++c)
      result_.layers[mixed_[c][2]] += share[c] / rounds * cell_size_;
    const double cells = result_.value / cell_size_;
    result_.mean = cells > 0 ? (condition_ + condition / rounds) / cells : 0;
    if (result_.best == 0) result_.worst = 0;
  }

  /// Sub-cells of the mixed cells that are wholly in, or not wholly out. Undivided, they are
  /// neither; all that is to be asked about them was asked.
  void bound() {
    const int split = fineness_.split;
    if (split == 1) {
      result_.lower = whole_ * cell_size_;
      result_.upper = result_.lower + static_cast<double>(mixed_.size()) * cell_size_;
      return;
    }
    std::array<int, 3> nodes, parts;
    for (int axis = 0; axis < 3; ++axis) {
      nodes[axis] = active_[axis] ? split + 1 : 1;
      parts[axis] = active_[axis] ? split : 1;
    }
    const std::size_t per_cell = static_cast<std::size_t>(nodes[0]) * nodes[1] * nodes[2];
    const std::size_t batch = std::max<std::size_t>(1, kBatch / per_cell);
    std::size_t wholly_in = 0, not_out = 0;
    for (std::size_t begin = 0; begin < mixed_.size(); begin += batch) {
      const std::size_t end = std::min(mixed_.size(), begin + batch);
      Points points;
      points.reserve((end - begin) * per_cell);
      for (std::size_t m = begin; m < end; ++m) {
        const Vector3 corner = grid_.at(mixed_[m][0], mixed_[m][1], mixed_[m][2]);
        for (int c = 0; c < nodes[2]; ++c)
          for (int b = 0; b < nodes[1]; ++b)
            for (int a = 0; a < nodes[0]; ++a)
              points.add(corner + grid_.step / split * Vector3(a, b, c));
      }
      const Probe::Answers answers = probe_.ask(points, false);
      for (std::size_t m = 0; m < end - begin; ++m)
        for (int c = 0; c < parts[2]; ++c)
          for (int b = 0; b < parts[1]; ++b)
            for (int a = 0; a < parts[0]; ++a) {
              int inside = 0, corners = 0;
              for (int n = 0; n < 8; ++n) {
                const int i = a + (n & 1), j = b + (n >> 1 & 1), k = c + (n >> 2 & 1);
                if (i >= nodes[0] || j >= nodes[1] || k >= nodes[2]) continue;
                ++corners;
                inside += answers.inside(m * per_cell + i +
                                         static_cast<std::size_t>(nodes[0]) *
                                             (j + static_cast<std::size_t>(nodes[1]) * k));
              }
              wholly_in += inside == corners;
              not_out += inside > 0;
            }
    }
    const double part = cell_size_ / (static_cast<double>(parts[0]) * parts[1] * parts[2]);
    result_.lower = whole_ * cell_size_ + static_cast<double>(wholly_in) * part;
    result_.upper = whole_ * cell_size_ + static_cast<double>(not_out) * part;
  }

  const Probe& probe_;
  const Region& region_;
  const NodeGrid& grid_;
  const RegionFineness& fineness_;
  std::array<bool, 3> active_{};
  Cell cells_{};
  double cell_size_ = 0, whole_ = 0, condition_ = 0;
  std::vector<char> state_;
  std::vector<Cell> mixed_;
  RegionMeasure result_;
};

}  // namespace

RegionFineness region_fineness(double accuracy, bool closed_form) {
  RegionFineness fineness;
  if (!closed_form) return {1500, 1, 1, 1, 2, 4};
  if (accuracy > 1e-3) {
    const double nodes = 2e5 * 1e-3 / accuracy;
    fineness = {static_cast<int>(std::clamp(nodes, 4000.0, 2e5)), 1, 1, 2, 8, 6};
  }
  return fineness;
}

RegionMeasure measure_region(const Probe& probe, const Region& region,
                             const RegionFineness& fineness, double accuracy) {
  if (region.empty) return {};
  return Measurer(probe, region, fineness).run(accuracy);
}

}  // namespace polyglide
