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

  /// Which limit stops each place when turned by `angle`; "" where it is reachable,
  /// regular and on home's side.
  std::vector<std::string> stopped_at(const Points& places, double angle) {
    Probe probe(evaluator_, turned(angle));
    probe.set_side(side_);
    const Probe::Answers answers = probe.ask(places, false);
    poses_ += places.size();
    std::vector<std::string> limits(places.size());
    for (std::size_t i = 0; i < limits.size(); ++i)
      if (!answers.inside(i)) limits[i] = probe.names()[answers.limit[i]];
    return limits;
  }

  /// Moves `free` to where the rotation of one place ends before free + step, and
  /// names what ends it.
  std::string find_end(const Vector3& place, double& free, double step) {
    if (std::abs(free + step) > M_PI + 1e-9) return "";
    Points points;
    points.add(place);
    double stopped = free + step;
    std::string limit = stopped_at(points, stopped)[0];
    for (int i = 0; i < 12; ++i) {
      const double middle = (free + stopped) / 2;
      const std::string there = stopped_at(points, middle)[0];
      (there.empty() ? free : stopped) = middle;
      if (!there.empty()) limit = there;
    }
    return limit;
  }

  std::size_t poses() const { return poses_; }

 private:
  Eigen::Quaterniond turned(double angle) const {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis_));
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
    const std::vector<std::string> stopped = turner.stopped_at(asked, n * step);
    std::vector<std::size_t> still;
    for (std::size_t i = 0; i < turning.size(); ++i) {
      if (!stopped[i].empty()) continue;
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

  const int along = evaluator.closed_form() ? 9 : 3;  // per direction
  Points all, places;
  all.add(Vector3::Zero());
  for (int k = 0; k < along; ++k)
    for (int j = 0; j < along; ++j)
      for (int i = 0; i < along; ++i) {
        const Vector3 share = Vector3(i + 0.5, j + 0.5, k + 0.5) / along;
        all.add(extent.lower + share.cwiseProduct(extent.upper - extent.lower));
      }
  const std::vector<std::string> stopped = turner.stopped_at(all, 0);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (stopped[i].empty()) places.add(all[i]);
  if (places.size() == 0) return std::nullopt;

  const std::vector<double> up = turn_all(turner, places, step),
                            down = turn_all(turner, places, -step);
  std::size_t widest = 0;
  for (std::size_t i = 1; i < places.size(); ++i)
    if (up[i] - down[i] > up[widest] - down[widest] + 1e-12) widest = i;
  RotationRange range{
      static_cast<char>('A' + axis), places[widest], down[widest], up[widest], "", ""};
  range.max_limit = turner.find_end(range.at, range.max, step);
  range.min_limit = turner.find_end(range.at, range.min, -step);
  poses += turner.poses();
  return range;
}

}  // namespace polyglide
