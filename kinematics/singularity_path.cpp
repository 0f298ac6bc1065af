#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "kinematics/dips.hpp"
#include "kinematics/motion.hpp"
#include "kinematics/singularity.hpp"

// What lies on ways between poses.
namespace polyglide {
namespace {

using Coordinates = Eigen::Matrix<double, 6, 1>;

constexpr double kAtEnd = 1e-2;  // margins fall with the root of what is left of a way

/// Sign of det J, 0 where J is not square or not finite.
int orientation_at(const Machine& machine, const Posture& posture) {
  const std::optional<Eigen::MatrixXd> jacobian = task_jacobian(machine, posture);
  if (!jacobian || jacobian->rows() != jacobian->cols()) return 0;
  const double determinant = jacobian->determinant();
  return determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
}

/// The straight way between two poses in task coordinates, followed posture by posture.
class Way {
 public:
  Way(const Machine& machine, const Pose& from, const Pose& to)
      : machine_(machine), from_(coordinates_of(from)), span_(coordinates_of(to) - from_) {
    for (int i = 3; i < 6; ++i) span_[i] = std::remainder(span_[i], 2 * std::numbers::pi);
  }
  [[nodiscard]] Pose at(double part) const { return pose_of(from_ + part * span_); }
  /// Moves a posture to a place of the way; false, unchanged, when it cannot get there.
  bool follow(Posture& posture, double part) const {
    Posture trial = posture;
    if (!solve_inverse_general(machine_, at(part), trial).reachable) return false;
    posture = std::move(trial);
    return true;
  }

 private:
  const Machine& machine_;
  Coordinates from_, span_;
};

/// Halves the piece of a way in which the sign changes; the posture is at its beginning.
double bisect(const Machine& machine, const Way& way, Posture& posture, double low, double high,
              int sign) {
  for (int i = 0; i < 40 && high - low > 1e-9; ++i) {
    const double middle = (low + high) / 2;
    Posture trial = posture;
    if (!way.follow(trial, middle)) {
      high = middle;
      continue;
    }
    if (orientation_at(machine, trial) == sign) {
      low = middle;
      posture = std::move(trial);
    } else {
      high = middle;
    }
  }
  return low;
}

/// The farthest place of a piece of way that can be reached; moves the posture there.
double last_reached(const Way& way, Posture& posture, double low, double high) {
  while (high - low > 1e-7) {
    const double middle = (low + high) / 2;
    (way.follow(posture, middle) ? low : high) = middle;
  }
  return low;
}

/// Places between two samples of equal sign where a margin falls to zero and rises again.
class Touches {
 public:
  Touches(const Machine& machine, const Way& way, int mobility, int samples)
      : machine_(machine), way_(way), mobility_(mobility), step_(1.0 / samples) {}

  [[nodiscard]] double step() const { return step_; }

  /// A sample beyond the ends of the way, where the machine gets there.
  void look(Posture posture, double part, std::vector<SingularCrossing>& found) {
    if (way_.follow(posture, part))
      take(posture, part, smaller_margin(machine_, posture), orientation_at(machine_, posture),
           found);
  }

  /// Takes the next sample; looks at the piece between the last two but one.
  void take(const Posture& posture, double part, double margin, int sign,
            std::vector<SingularCrossing>& found) {
    last_.push_back({posture, part, margin, sign});
    if (last_.size() > 4) last_.erase(last_.begin());
    if (last_.size() < 4 || last_[1].sign != last_[2].sign) return;
    if (!is_dip(last_[0].margin, last_[1].margin, last_[2].margin, last_[3].margin)) return;
    Posture there = last_[1].posture;
    const double from = last_[1].part;
    const auto lowest = bottoms(1, [&](const std::vector<double>& ways) {
      std::vector<double> margins;
      for (const double way : ways)
        margins.push_back(way_.follow(there, from + way * step_) ? smaller_margin(machine_, there)
                                                                 : 1);
      return margins;
    });
    const double at = from + lowest[0].at * step_;
    if (!way_.follow(there, at)) return;
    const Singularity singularity = singularity_at(machine_, there, mobility_);
    if (!singularity.regular()) found.push_back({at, way_.at(at), singularity});
  }

 private:
  struct Sample {
    Posture posture;
    double part, margin;
    int sign;
  };
  const Machine& machine_;
  const Way& way_;
  int mobility_;
  double step_;
  std::vector<Sample> last_;
};

/// What lies nearer together than a tenth of a sample is one place: at a touch signs are chance.
void put_in_order(PathSingularities& found, int samples) {
  const auto margin = [](const SingularCrossing& crossing) {
    return std::min(crossing.singularity.direct_margin, crossing.singularity.inverse_margin);
  };
  std::ranges::sort(found.crossings, {}, &SingularCrossing::at);
  std::vector<SingularCrossing> kept;
  for (SingularCrossing& crossing : found.crossings) {
    const bool inside = crossing.at >= 0 && crossing.at <= 1;
    const bool again = !kept.empty() && crossing.at - kept.back().at < 0.1 / samples;
    if (inside && !again)
      kept.push_back(std::move(crossing));
    else if (inside && margin(crossing) < margin(kept.back()))
      kept.back() = std::move(crossing);
  }
  found.crossings = std::move(kept);
  if (found.crossings.empty() || !(found.smallest_margin > 0)) return;
  found.smallest_margin = 0;
  found.smallest_at = found.crossings.front().at;
}

}  // namespace

PathSingularities singularities_on_path(const Machine& machine, const Pose& from, const Pose& to,
                                        int samples) {
  PathSingularities found;
  const int mobility = freedoms_at(machine.model, home(machine.model)).mobility;
  const Way way(machine, from, to);
  Posture posture = home(machine.model);
  if (!way.follow(posture, 0)) {
    found.end = 0;
    return found;
  }
  int sign = orientation_at(machine, posture);
  Touches touches(machine, way, mobility, samples);
  touches.look(posture, -touches.step(), found.crossings);
  for (int i = 0; i <= samples; ++i) {
    const double part = static_cast<double>(i) / samples;
    const Posture before = posture;
    if (!way.follow(posture, part)) {
      found.end = last_reached(way, posture, std::max(0.0, (i - 1.0) / samples), part);
      found.at_end = singularity_at(machine, posture, mobility, kAtEnd);
      put_in_order(found, samples);
      return found;
    }
    const double margin = smaller_margin(machine, posture);
    const int here = orientation_at(machine, posture);
    touches.take(posture, part, margin, here, found.crossings);
    if (margin < found.smallest_margin) {
      found.smallest_margin = margin;
      found.smallest_at = part;
    }
    if (here != sign && i > 0) {
      Posture there = before;
      const double at = bisect(machine, way, there, (i - 1.0) / samples, part, sign);
      found.smallest_margin = 0;
      found.smallest_at = at;
      found.crossings.push_back({at, way.at(at), singularity_at(machine, there, mobility)});
    }
    sign = here;
  }
  touches.look(posture, 1 + touches.step(), found.crossings);
  put_in_order(found, samples);
  found.reached = true;
  return found;
}

NearestSingularity nearest_singularity(const Machine& machine, const Pose& pose, double radius,
                                       int directions, std::uint64_t seed) {
  NearestSingularity nearest;
  nearest.directions = directions;
  nearest.distance = radius > 0 ? radius : machine.model.size;
  const auto axes = static_cast<Eigen::Index>(machine.task.axes.size());
  std::mt19937_64 random(seed);
  constexpr int kSamples = 40;

  // Looks along a unit direction of the scaled task space, no farther than the best so far.
  const auto look = [&](const Eigen::VectorXd& direction) {
    Coordinates span = Coordinates::Zero();
    for (Eigen::Index i = 0; i < axes; ++i) {
      const int axis = machine.task.axes[i];
      span[axis] =
          nearest.distance * direction[i] / (axis < 3 ? 1 : machine.task.characteristic_length);
    }
    const Pose end = pose_of(coordinates_of(pose) + span);
    const PathSingularities path = singularities_on_path(machine, pose, end, kSamples);
    const bool crossed = !path.crossings.empty();
    if (!crossed && path.reached) return false;
    const double part = crossed ? path.crossings.front().at : path.end;
    if (!(part < 1)) return false;
    nearest.found = true;
    nearest.distance *= part;
    nearest.pose = Way(machine, pose, end).at(part);
    nearest.singularity = crossed ? path.crossings.front().singularity : path.at_end;
    return part > 0;
  };

  Eigen::VectorXd best = Eigen::VectorXd::Zero(axes);
  for (int i = 0; i < directions; ++i) {
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(axes);
    if (i < 2 * axes)
      direction[i / 2] = i % 2 == 0 ? 1 : -1;
    else
      direction = random_direction(random, axes).normalized();
    if (look(direction)) best = direction;
  }
  if (!nearest.found) return nearest;
  // Downhill: turn the best direction by less and less.
  for (double turn = 0.3; turn > 0.01; turn /= 1.5)
    for (int i = 0; i < 6; ++i) {
      const Eigen::VectorXd direction = (best + turn * random_direction(random, axes)).normalized();
      if (look(direction)) best = direction;
    }
  return nearest;
}

}  // namespace polyglide
