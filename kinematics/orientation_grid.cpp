#include "kinematics/orientation_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace polyglide {
namespace {

using std::numbers::pi;

constexpr double kEnd = 1e-6;  // [rad] ends are bisected to this
constexpr std::size_t kPiece = std::size_t{1} << 17;

}  // namespace

std::vector<int> Turner::ask(const std::vector<Tilted>& rotations) const {
  const TaskSpace& task = probe_.evaluator().machine().task;
  std::vector<int> limits;
  for (std::size_t first = 0; first < rotations.size(); first += kPiece) {
    const std::size_t count = std::min(kPiece, rotations.size() - first);
    PoseBatch poses;
    poses.x.assign(count, at_.x());
    poses.y.assign(count, at_.y());
    poses.z.assign(count, at_.z());
    for (auto& column : poses.quaternion) column.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const Tilted& r = rotations[first + i];
      const Eigen::Quaterniond q = turned(task, r.azimuth, r.tilt, r.torsion);
      poses.quaternion[0][i] = q.w();
      for (int k = 0; k < 3; ++k) poses.quaternion[static_cast<std::size_t>(k) + 1][i] = q.vec()[k];
    }
    const Probe::Answers answers = probe_.ask(std::move(poses), false);
    limits.insert(limits.end(), answers.limit.begin(), answers.limit.end());
  }
  return limits;
}

std::vector<int> Turner::bisect(const std::vector<Tilted>& lines, std::vector<double>& free,
                                std::vector<double>& stopped) const {
  std::vector<int> limits(lines.size(), -1);
  double widest = kEnd;
  for (std::size_t i = 0; i < lines.size(); ++i)
    widest = std::max(widest, std::abs(stopped[i] - free[i]));
  const int rounds = 1 + static_cast<int>(std::ceil(std::log2(widest / kEnd)));
  std::vector<Tilted> middles = lines;
  for (int round = 0; round < rounds && !lines.empty(); ++round) {
    // The first round names the limit of what is stopped already.
    for (std::size_t i = 0; i < lines.size(); ++i)
      middles[i].tilt = round == 0 ? stopped[i] : (free[i] + stopped[i]) / 2;
    const std::vector<int> answers = ask(middles);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      (answers[i] < 0 && round > 0 ? free : stopped)[i] = middles[i].tilt;
      if (answers[i] >= 0) limits[i] = answers[i];
    }
  }
  return limits;
}

std::vector<int> Turner::first_ends(const std::vector<Tilted>& lines, double step, double most,
                                    std::vector<double>& tilts) const {
  const int steps = std::max(1, static_cast<int>(std::ceil(most / step - 1e-9)));
  std::vector<int> limits(lines.size(), -1);
  std::vector<double> free(lines.size(), 0), stopped(lines.size(), most);
  std::vector<std::size_t> going(lines.size());
  for (std::size_t i = 0; i < going.size(); ++i) going[i] = i;
  std::vector<std::size_t> ended;
  for (int n = 0; n <= steps && !going.empty(); ++n) {
    std::vector<Tilted> asked;
    for (std::size_t i : going) {
      asked.push_back(lines[i]);
      asked.back().tilt = most * n / steps;
    }
    const std::vector<int> answers = ask(asked);
    std::vector<std::size_t> still;
    for (std::size_t k = 0; k < going.size(); ++k) {
      const std::size_t i = going[k];
      if (answers[k] < 0) {
        free[i] = asked[k].tilt;
        still.push_back(i);
      } else if (n == 0) {
        limits[i] = answers[k];
      } else {
        stopped[i] = asked[k].tilt;
        ended.push_back(i);
      }
    }
    going = std::move(still);
  }
  std::vector<Tilted> last;
  std::vector<double> low, high;
  for (std::size_t i : ended) {
    last.push_back(lines[i]);
    low.push_back(free[i]);
    high.push_back(stopped[i]);
  }
  const std::vector<int> met = bisect(last, low, high);
  for (std::size_t k = 0; k < ended.size(); ++k) {
    free[ended[k]] = low[k];
    limits[ended[k]] = met[k];
  }
  tilts = std::move(free);
  return limits;
}

OrientationGrid::OrientationGrid(int azimuths, int tilts, int torsions, double most)
    : azimuths_(azimuths),
      tilts_(tilts),
      torsions_(torsions),
      most_(most),
      step_(most / tilts),
      state_(static_cast<std::size_t>(azimuths) * tilts * torsions, unknown),
      limit_(state_.size(), -1) {}

std::size_t OrientationGrid::lines() const {
  return static_cast<std::size_t>(azimuths_) * torsions_;
}

/// Nodes of a line are neighbours; azimuth next, torsion slowest.
std::size_t OrientationGrid::node(int azimuth, int tilt, int torsion) const {
  return static_cast<std::size_t>(tilt) +
         static_cast<std::size_t>(tilts_) *
             (azimuth + static_cast<std::size_t>(azimuths_) * torsion);
}

Tilted OrientationGrid::line(std::size_t number) const {
  const auto azimuth = static_cast<double>(number % azimuths_);
  const auto torsion = static_cast<double>(number / azimuths_);
  return {2 * pi * azimuth / azimuths_, 0,
          torsions_ == 1 ? 0 : 2 * pi * (torsion / torsions_ - 0.5)};
}

std::vector<std::size_t> OrientationGrid::neighbours(std::size_t at) const {
  const int tilt = static_cast<int>(at % tilts_);
  const int azimuth = static_cast<int>(at / tilts_ % azimuths_);
  const int torsion = static_cast<int>(at / tilts_ / azimuths_);
  const int opposite = (azimuth + azimuths_ / 2) % azimuths_;
  std::vector<std::size_t> list{
      node((azimuth + 1) % azimuths_, tilt, torsion),
      node((azimuth + azimuths_ - 1) % azimuths_, tilt, torsion),
      tilt > 0 ? node(azimuth, tilt - 1, torsion) : node(opposite, 0, torsion)};
  if (tilt + 1 < tilts_)
    list.push_back(node(azimuth, tilt + 1, torsion));
  else if (most_ > pi - 1e-9)  // tilted by half a turn towards either side is the same
    list.push_back(node(opposite, tilt, torsion));
  if (torsions_ > 1) {
    list.push_back(node(azimuth, tilt, (torsion + 1) % torsions_));
    list.push_back(node(azimuth, tilt, (torsion + torsions_ - 1) % torsions_));
  }
  return list;
}

void OrientationGrid::flood(const Turner& turner) {
  std::vector<std::size_t> asked;
  for (int azimuth = 0; azimuth < azimuths_; ++azimuth)
    asked.push_back(node(azimuth, 0, torsions_ == 1 ? 0 : torsions_ / 2));
  std::vector<char> listed(state_.size(), 0);
  for (std::size_t at : asked) listed[at] = 1;
  while (!asked.empty()) {
    std::vector<Tilted> rotations;
    for (std::size_t at : asked) {
      rotations.push_back(line(at / tilts_));
      rotations.back().tilt = tilt_of(static_cast<int>(at % tilts_));
    }
    const std::vector<int> answers = turner.ask(rotations);
    std::vector<std::size_t> next;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      state_[asked[i]] = answers[i] < 0 ? in : out;
      limit_[asked[i]] = answers[i];
      if (answers[i] >= 0) continue;
      for (std::size_t other : neighbours(asked[i])) {
        if (listed[other]) continue;
        listed[other] = 1;
        next.push_back(other);
      }
    }
    asked = std::move(next);
  }
}

std::vector<std::vector<TiltInterval>> OrientationGrid::intervals(const Turner& turner) const {
  std::vector<std::vector<TiltInterval>> all(lines());
  std::vector<Tilted> ends;
  std::vector<double> free, stopped;
  std::vector<std::pair<double*, int*>> results;
  for (std::size_t number = 0; number < lines(); ++number) {
    const char* state = &state_[number * tilts_];
    for (int t = 0; t < tilts_; ++t) {
      if (state[t] != in) continue;
      if (t == 0 || state[t - 1] != in) all[number].push_back({t == 0 ? 0 : tilt_of(t), most_});
      if (t + 1 < tilts_) all[number].back().to = tilt_of(t);
      if (t + 1 == tilts_) all[number].back().to = most_;
    }
  }
  const auto add = [&](std::size_t number, double from, double to, double& value, int& limit) {
    ends.push_back(line(number));
    free.push_back(from);
    stopped.push_back(to);
    results.emplace_back(&value, &limit);
  };
  for (std::size_t number = 0; number < lines(); ++number)
    for (TiltInterval& interval : all[number]) {
      if (interval.from > 0)
        add(number, interval.from, interval.from - step_, interval.from, interval.from_limit);
      if (interval.to < most_)
        add(number, interval.to, interval.to + step_, interval.to, interval.to_limit);
    }
  const std::vector<int> limits = turner.bisect(ends, free, stopped);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    *results[i].first = free[i];
    *results[i].second = limits[i];
  }
  return all;
}

}  // namespace polyglide
