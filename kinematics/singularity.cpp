#include "kinematics/singularity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "kinematics/manifold.hpp"
#include "kinematics/motion.hpp"
#include "kinematics/screw_words.hpp"
#include "kinematics/second_order.hpp"

namespace polyglide {
namespace {

using Coordinates = Eigen::Matrix<double, 6, 1>;

constexpr double kAtEnd = 1e-2;    // margins fall with the root of what is left of a way
constexpr double kVisible = 1e-9;  // of a unit kernel vector's rates; less is an idle freedom

/// The mechanism's visible motions at a posture: combinations of kernel columns that move a drive
/// or the platform.
struct Rates {
  Eigen::MatrixXd drives;    ///< D: drive rates / size, per visible motion
  Eigen::MatrixXd platform;  ///< P: [w · length; v of the tool] / size
  Eigen::MatrixXd twists;    ///< [w; v of the tool / size]
};

Rates visible_rates(const Machine& machine, const Freedoms& freedoms) {
  const Model& model = machine.model;
  const double turning = machine.task.characteristic_length / model.size;
  Eigen::MatrixXd platform = freedoms.platform;
  platform.topRows(3) *= turning;
  Eigen::MatrixXd drives = freedoms.kernel(model.drives, Eigen::all);
  for (std::size_t d = 0; d < model.drives.size(); ++d)
    if (!model.freedoms[model.drives[d]].translational)
      drives.row(static_cast<Eigen::Index>(d)) *= turning;
  Eigen::MatrixXd both(drives.rows() + 6, freedoms.mobility);
  both << drives, platform;
  const Svd svd = svd_of(both);
  const Eigen::Index visible = (svd.values.array() > kVisible).count();
  const Eigen::MatrixXd mix = svd.v.leftCols(visible);
  return {drives * mix, platform * mix, freedoms.platform * mix};
}

/// Smallest over largest singular value; 0 when there are fewer rows than columns.
double margin_of(const Eigen::MatrixXd& rates) {
  if (rates.cols() == 0) return 1;
  if (rates.rows() < rates.cols()) return 0;
  const Eigen::VectorXd s = singular_values(rates);
  return s[0] > 0 ? s[s.size() - 1] / s[0] : 0;
}

/// Columns: what `rates` sends to zero.
Eigen::MatrixXd unseen_by(const Eigen::MatrixXd& rates, double singular) {
  const Svd svd = svd_of(rates);
  const Eigen::VectorXd& s = svd.values;
  Eigen::Index rank = 0;
  while (rank < s.size() && s[rank] > singular * s[0]) ++rank;
  return svd.v.rightCols(rates.cols() - rank);
}

/// Wrenches [f; n/size] about the tool that do no work on twists [w; v/size] of it.
Eigen::MatrixXd reciprocal(const Eigen::MatrixXd& twists, double singular) {
  Eigen::MatrixXd swapped(twists.cols(), 6);
  swapped << twists.bottomRows(3).transpose(), twists.topRows(3).transpose();
  return unseen_by(swapped, singular);
}

/// A posture close by, where the machine is regular if it ever is.
Posture nearby(const Model& model, const Posture& posture, const Eigen::MatrixXd& kernel) {
  constexpr double kStep = 0.02;
  std::mt19937_64 random(1);
  const std::vector<int> active = all_freedoms(model);
  for (int attempt = 0; attempt < 8; ++attempt) {
    Posture moved = posture;
    const Eigen::VectorXd along =
        tangent(model, moved, active, kernel * random_direction(random, kernel.cols()));
    if (!along.isZero() && step_along(model, moved, active, along, kStep).closed) return moved;
  }
  return posture;
}

std::vector<SingularScrew> in_words(const Eigen::MatrixXd& screws, const Vector3& point,
                                    double size, std::string (*describe)(const Screw&)) {
  std::vector<SingularScrew> list;
  for (const Screw& screw : plain_basis(screws, point, size))
    list.push_back({describe(screw), screw});
  return list;
}

/// Wrenches borne at this posture that are not borne close by.
std::vector<SingularScrew> lost_motions(const Machine& machine, const Posture& posture,
                                        const Freedoms& freedoms, const Rates& rates,
                                        double singular) {
  const Model& model = machine.model;
  const Posture other = nearby(model, posture, freedoms.kernel);
  const Rates generic = visible_rates(machine, freedoms_at(model, other));
  const Eigen::MatrixXd here = reciprocal(rates.twists, singular);
  const Eigen::MatrixXd there = reciprocal(generic.twists, kVisible);
  const Eigen::Index more = here.cols() - there.cols();
  if (more <= 0) return {};
  const Eigen::MatrixXd rest = here - there * (there.transpose() * here);
  const Svd svd = svd_of(rest);
  const Vector3 tool = posture.bodies[model.mechanism.platform] * model.mechanism.tool;
  return in_words(here * svd.v.leftCols(more), tool, model.size, describe_wrench);
}

/// Sign of det J, 0 where J is not square or not finite.
int orientation_at(const Machine& machine, const Posture& posture) {
  const std::optional<Eigen::MatrixXd> jacobian = task_jacobian(machine, posture);
  if (!jacobian || jacobian->rows() != jacobian->cols()) return 0;
  const double determinant = jacobian->determinant();
  return determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
}

double smaller_margin(const Machine& machine, const Posture& posture) {
  const Rates rates = visible_rates(machine, freedoms_at(machine.model, posture));
  return std::min(margin_of(rates.drives), margin_of(rates.platform));
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

}  // namespace

Singularity singularity_at(const Machine& machine, const Posture& posture, int mobility,
                           double singular) {
  const Model& model = machine.model;
  const Freedoms freedoms = freedoms_at(model, posture);
  const Rates rates = visible_rates(machine, freedoms);
  const Vector3 tool = posture.bodies[model.mechanism.platform] * model.mechanism.tool;
  Singularity found;
  found.direct_margin = margin_of(rates.drives);
  found.inverse_margin = margin_of(rates.platform);
  found.direct = found.direct_margin < singular;
  found.inverse = found.inverse_margin < singular;
  found.constraint = freedoms.mobility > mobility;
  if (found.direct)
    found.gained = in_words(rates.twists * unseen_by(rates.drives, singular), tool, model.size,
                            describe_twist);
  if (found.inverse) found.lost = lost_motions(machine, posture, freedoms, rates, singular);
  return found;
}

std::string singularity_name(const Singularity& singularity) {
  std::string name;
  const auto add = [&](bool has, const char* word) {
    if (has) name += (name.empty() ? "" : " and ") + std::string(word);
  };
  add(singularity.direct, "direct (type II)");
  add(singularity.inverse, "inverse (type I)");
  add(singularity.constraint, "constraint");
  return name.empty() ? "regular" : name;
}

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
  for (int i = 0; i <= samples; ++i) {
    const double part = static_cast<double>(i) / samples;
    const Posture before = posture;
    if (!way.follow(posture, part)) {
      found.end = last_reached(way, posture, std::max(0.0, (i - 1.0) / samples), part);
      found.at_end = singularity_at(machine, posture, mobility, kAtEnd);
      return found;
    }
    const double margin = smaller_margin(machine, posture);
    if (margin < found.smallest_margin) {
      found.smallest_margin = margin;
      found.smallest_at = part;
    }
    const int here = orientation_at(machine, posture);
    if (here != sign && i > 0) {
      Posture there = before;
      const double at = bisect(machine, way, there, (i - 1.0) / samples, part, sign);
      found.smallest_margin = 0;
      found.smallest_at = at;
      found.crossings.push_back({at, way.at(at), singularity_at(machine, there, mobility)});
    }
    sign = here;
  }
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
