#include "kinematics/pose_table.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

namespace polyglide {
namespace {

/// Evenly over the range, with home among them.
std::vector<double> samples_of(const Range& range, int count) {
  if (count == 1) return {0};
  std::vector<double> samples;
  for (int i = 0; i < count; ++i)
    samples.push_back(range.min + (range.max - range.min) * i / (count - 1));
  const auto nearest = std::min_element(
      samples.begin(), samples.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  if (range.min <= 0 && range.max >= 0) *nearest = 0;
  return samples;
}

/// Part of the ranges, scaled about home, in which drives can be set independently.
double free_part(const Machine& machine, const std::vector<Range>& ranges) {
  const std::size_t halves = std::min<std::size_t>(ranges.size(), 6),
                    corners = std::size_t{1} << halves;
  constexpr double kLeast = 0.1;
  for (double part : {1.0, 0.75, 0.5, 0.35, 0.25, 0.15}) {
    std::size_t failed = 0;
    for (std::size_t corner = 0; corner < corners && 10 * failed <= corners; ++corner) {
      Eigen::VectorXd drives(static_cast<Eigen::Index>(ranges.size()));
      for (std::size_t d = 0; d < ranges.size(); ++d)
        drives[static_cast<Eigen::Index>(d)] =
            part * ((corner >> d % 6 & 1) != 0 ? ranges[d].max : ranges[d].min);
      Posture posture = home(machine.model);
      failed += !solve_forward_from(machine, drives, posture);
    }
    if (10 * failed <= corners) return part;
  }
  return kLeast;
}

/// Visits the nodes of a table from home outwards.
class Spreader {
 public:
  Spreader(const Machine& machine, PoseTable& table) : machine_(machine), table_(table) {
    std::size_t total = 1;
    for (const auto& samples : table_.samples) total *= samples.size();
    table_.bodies.assign(total, std::nullopt);
    trials_.assign(total, 0);
  }

  void run() {
    reach(home_node(), home(machine_.model));
    while (!queue_.empty()) {
      const auto [node, posture] = std::move(queue_.front());
      queue_.pop_front();
      std::size_t stride = 1;
      for (std::size_t d = table_.samples.size(); d-- > 0; stride *= table_.samples[d].size()) {
        const std::size_t place = node / stride % table_.samples[d].size();
        if (place > 0) reach(node - stride, posture);
        if (place + 1 < table_.samples[d].size()) reach(node + stride, posture);
      }
    }
  }

 private:
  void reach(std::size_t node, Posture posture) {
    constexpr char kMostTrials = 2;  // from different neighbours; a failure is slow
    if (table_.bodies[node] || trials_[node]++ >= kMostTrials) return;
    if (!solve_forward_from(machine_, drives_at(node), posture)) return;
    table_.bodies[node] = posture.bodies;
    queue_.emplace_back(node, std::move(posture));
  }

  Eigen::VectorXd drives_at(std::size_t node) const {
    Eigen::VectorXd values(static_cast<Eigen::Index>(table_.samples.size()));
    for (std::size_t d = table_.samples.size(); d-- > 0; node /= table_.samples[d].size())
      values[static_cast<Eigen::Index>(d)] = table_.samples[d][node % table_.samples[d].size()];
    return values;
  }

  /// The node nearest to home.
  std::size_t home_node() const {
    std::size_t node = 0;
    for (const auto& samples : table_.samples) {
      const auto nearest = std::min_element(samples.begin(), samples.end(), [](double a, double b) {
        return std::abs(a) < std::abs(b);
      });
      node = node * samples.size() + static_cast<std::size_t>(nearest - samples.begin());
    }
    return node;
  }

  const Machine& machine_;
  PoseTable& table_;
  std::vector<char> trials_;
  std::deque<std::pair<std::size_t, Posture>> queue_;
};

}  // namespace

Range drawing_range(const Model& model, int joint, int index) {
  const Joint& data = model.mechanism.joints[joint];
  Range range;
  if (index < static_cast<int>(data.range.size())) range = data.range[index];
  const bool slides = model.freedoms[model.first_freedom[joint] + index].translational;
  const double sensible = slides ? 0.6 * model.size : M_PI / 3;
  if (std::isinf(range.min)) range.min = std::min(-sensible, range.max - sensible);
  if (std::isinf(range.max)) range.max = std::max(sensible, range.min + sensible);
  return range;
}

PoseTable tabulate_poses(const Machine& machine, int nodes) {
  constexpr int kMostSamples = 61;
  const Model& model = machine.model;
  PoseTable table;
  for (int drive : model.drives)
    table.ranges.push_back(
        drawing_range(model, model.freedoms[drive].joint, model.freedoms[drive].index));
  const std::size_t drives = table.ranges.size();
  int count = 1;
  if (drives > 0)
    count = static_cast<int>(std::pow(nodes, 1.0 / static_cast<double>(drives)) + 1e-9);
  count = std::clamp(count, 1, kMostSamples);
  if (count % 2 == 0) --count;  // odd, so that home is in the middle
  const double part = free_part(machine, table.ranges);
  for (Range& range : table.ranges) {
    range = {part * range.min, part * range.max};
    table.samples.push_back(samples_of(range, count));
  }
  Spreader(machine, table).run();
  return table;
}

}  // namespace polyglide
