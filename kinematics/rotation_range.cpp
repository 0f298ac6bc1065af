#include "kinematics/rotation_range.hpp"

#include <algorithm>
#include <cmath>

namespace polyglide {
namespace {

class Turner {
 public:
  Turner(const Evaluator& evaluator, int axis) : evaluator_(evaluator), axis_(Vector3::Unit(axis)) {
    side_ = Probe(evaluator_, turned(0)).side();
  }

  /// Which places are reachable, regular and on home's side when turned by `angle`.
  std::vector<char> free_at(const Points& places, double angle) {
    Probe probe(evaluator_, turned(angle));
    probe.set_side(side_);
    const Probe::Answers answers = probe.ask(places);
    poses_ += places.size();
    std::vector<char> free(places.size());
    for (std::size_t i = 0; i < free.size(); ++i) free[i] = answers.inside(i);
    return free;
  }

  /// Where the rotation of one place ends between two angles.
  double bisect(const Vector3& place, double free, double stopped) {
    for (int i = 0; i < 12; ++i) {
      const double middle = (free + stopped) / 2;
      (free_at(single(place), middle)[0] ? free : stopped) = middle;
    }
    return free;
  }

  std::size_t poses() const { return poses_; }

 private:
  Eigen::Quaterniond turned(double angle) const {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis_));
  }
  static Points single(const Vector3& place) {
    Points points;
    points.add(place);
    return points;
  }

  const Evaluator& evaluator_;
  Vector3 axis_;
  int side_ = 0;
  std::size_t poses_ = 0;
};

/// Last free angle of every place when all turn one way together.
std::vector<double> turn_all(Turner& turner, Points places, double step) {
  std::vector<double> last(places.size(), 0);
  std::vector<std::size_t> turning(places.size());
  for (std::size_t i = 0; i < turning.size(); ++i) turning[i] = i;
  const int steps = static_cast<int>(std::floor(M_PI / std::abs(step) + 1e-9));
  for (int n = 1; n <= steps && !turning.empty(); ++n) {
    Points asked;
    for (std::size_t i : turning) asked.add(places[i]);
    const std::vector<char> free = turner.free_at(asked, n * step);
    std::vector<std::size_t> still;
    for (std::size_t i = 0; i < turning.size(); ++i) {
      if (!free[i]) continue;
      last[turning[i]] = n * step;
      still.push_back(turning[i]);
    }
    turning = std::move(still);
  }
  return last;
}

}  // namespace

std::optional<RotationRange> widest_rotation(const Evaluator& evaluator, const Bounds& extent,
                                             double step, std::size_t& poses) {
  const TaskSpace& task = evaluator.machine().task;
  if (task.rotations != 1 || task.axes.empty() || task.axes.back() < 3) return std::nullopt;
  const int axis = task.axes.back() - 3;
  Turner turner(evaluator, axis);

  constexpr int kPlaces = 9;  // per direction
  Points all, places;
  all.add(Vector3::Zero());
  for (int k = 0; k < kPlaces; ++k)
    for (int j = 0; j < kPlaces; ++j)
      for (int i = 0; i < kPlaces; ++i) {
        const Vector3 share = Vector3(i + 0.5, j + 0.5, k + 0.5) / kPlaces;
        all.add(extent.lower + share.cwiseProduct(extent.upper - extent.lower));
      }
  const std::vector<char> free = turner.free_at(all, 0);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (free[i]) places.add(all[i]);
  if (places.size() == 0) return std::nullopt;

  const std::vector<double> up = turn_all(turner, places, step), down = turn_all(turner, places, -step);
  std::size_t widest = 0;
  for (std::size_t i = 1; i < places.size(); ++i)
    if (up[i] - down[i] > up[widest] - down[widest] + 1e-12) widest = i;
  RotationRange range{static_cast<char>('A' + axis), places[widest], down[widest], up[widest]};
  if (range.max + step < M_PI) range.max = turner.bisect(range.at, range.max, range.max + step);
  if (range.min - step > -M_PI) range.min = turner.bisect(range.at, range.min, range.min - step);
  poses += turner.poses();
  return range;
}

}  // namespace polyglide
