#include "kinematics/singular_wall.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "kinematics/dips.hpp"

namespace polyglide {
namespace {

/// Neighbours on a line of the grid between which 1/κ may touch zero.
struct Dip {
  Vector3 from, to;
};

/// Dips between the nodes of one line, whose indices into `answers` are given; a node of the line
/// may lie on the wall itself.
void look_along(const NodeGrid& grid, const std::vector<std::array<int, 3>>& line,
                const Probe& probe, const Probe::Answers& answers, std::vector<Dip>& dips) {
  const auto index = [&](std::size_t i) { return grid.index(line[i][0], line[i][1], line[i][2]); };
  const auto height = [&](std::size_t i) { return answers.inverse_condition[index(i)]; };
  const auto usable = [&](std::size_t i) { return answers.inside(index(i)); };
  const auto place = [&](std::size_t i) { return grid.at(line[i][0], line[i][1], line[i][2]); };
  const auto same_side = [&](std::size_t i, std::size_t k) {
    return answers.orientation[index(i)] == answers.orientation[index(k)];
  };
  for (std::size_t i = 1; i + 2 < line.size(); ++i) {
    if (!usable(i - 1) || !usable(i)) continue;
    const bool on_node = answers.limit[index(i + 1)] == probe.singularity();
    const std::size_t far = on_node ? i + 2 : i + 1;
    if (far + 1 >= line.size() || !usable(far) || !usable(far + 1) || !same_side(i, far)) continue;
    if (is_dip(height(i - 1), height(i), height(far), height(far + 1),
               static_cast<double>(far - i)))
      dips.push_back({place(i), place(far)});
  }
}

std::vector<Dip> look_for_dips(const Probe& probe, const NodeGrid& grid,
                               const Probe::Answers& answers) {
  std::vector<Dip> dips;
  std::vector<std::array<int, 3>> line;
  for (int axis = 0; axis < 3; ++axis) {
    const int first = (axis + 1) % 3, second = (axis + 2) % 3;
    for (int a = 0; a < grid.count[first]; ++a)
      for (int b = 0; b < grid.count[second]; ++b) {
        line.clear();
        for (int i = 0; i < grid.count[axis]; ++i) {
          std::array<int, 3>& at = line.emplace_back();
          at[axis] = i;
          at[first] = a;
          at[second] = b;
        }
        look_along(grid, line, probe, answers, dips);
      }
  }
  return dips;
}

BatchResult ask(const Probe& probe, const std::vector<Vector3>& places) {
  PoseBatch poses;
  poses.rotation = probe.rotation();
  poses.wanted = Wanted::condition;
  for (const Vector3& at : places) {
    poses.x.push_back(at.x());
    poses.y.push_back(at.y());
    poses.z.push_back(at.z());
  }
  BatchResult found;
  probe.evaluator().evaluate(poses, found);
  return found;
}

/// Where the dips reach zero, those that do.
std::vector<Vector3> zeros_in(const Probe& probe, const std::vector<Dip>& dips) {
  const auto place = [&](std::size_t i, double way) -> Vector3 {
    return dips[i].from + way * (dips[i].to - dips[i].from);
  };
  const std::vector<Bottom> lowest = bottoms(dips.size(), [&](const std::vector<double>& ways) {
    std::vector<Vector3> places;
    for (std::size_t i = 0; i < ways.size(); ++i) places.push_back(place(i / 2, ways[i]));
    return ask(probe, places).inverse_condition;
  });
  constexpr double kZero = 1e-7;
  std::vector<Vector3> result;
  for (std::size_t i = 0; i < lowest.size(); ++i)
    if (lowest[i].height < kZero) result.push_back(place(i, lowest[i].at));
  return result;
}

/// Whether all places between the zeros are singular that no limit stops: zeros of a curve that
/// lies in a plane do not make the plane singular.
bool is_singular_between(const Probe& probe, const std::vector<Vector3>& zeros) {
  constexpr std::size_t kPlaces = 64;
  constexpr double kSingular = 1e-6;
  std::mt19937_64 random(1);
  std::vector<Vector3> places;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    Vector3 weights;
    for (double& weight : weights) weight = 1 + static_cast<double>(random() % 1024);
    weights /= weights.sum();
    Vector3 place = Vector3::Zero();
    for (const double weight : weights) place += weight * zeros[random() % zeros.size()];
    places.push_back(place);
  }
  const BatchResult found = ask(probe, places);
  for (std::size_t i = 0; i < places.size(); ++i)
    if (found.limit[i] < 0 && found.inverse_condition[i] > kSingular) return false;
  return true;
}

/// The plane (line) through places, within `slack`.
std::optional<SingularWall> plane_through(const std::vector<Vector3>& places,
                                          const std::array<bool, 3>& active, double slack) {
  std::vector<int> axes;
  for (int k = 0; k < 3; ++k)
    if (active[k]) axes.push_back(k);
  const auto n = static_cast<Eigen::Index>(axes.size());
  Vector3 centre = Vector3::Zero();
  for (const Vector3& place : places) centre += place / static_cast<double>(places.size());
  Eigen::MatrixXd spread(static_cast<Eigen::Index>(places.size()), n);
  for (Eigen::Index i = 0; i < spread.rows(); ++i)
    for (Eigen::Index k = 0; k < n; ++k) spread(i, k) = places[i][axes[k]] - centre[axes[k]];
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(spread, Eigen::ComputeFullV);
  const double root = std::sqrt(static_cast<double>(places.size()));
  const auto wide = [&](Eigen::Index i) { return svd.singularValues()[i] / root; };
  // Neither thick nor so short that it might stand otherwise.
  if (n < 2 || wide(n - 1) > slack || wide(n - 2) < 1e6 * slack) return std::nullopt;
  SingularWall wall;
  for (Eigen::Index k = 0; k < n; ++k) wall.normal[axes[k]] = svd.matrixV()(k, n - 1);
  wall.offset = wall.normal.dot(centre);
  return wall;
}

/// Whether home lies beyond, or where home is no place to be, more than half of the nodes inside.
bool beyond_is_more(const Probe& probe, const NodeGrid& grid, const Probe::Answers& answers,
                    const SingularWall& wall) {
  const double home = wall.beyond(Vector3::Zero());
  const BatchResult at_home = ask(probe, {Vector3::Zero()});
  if (at_home.limit[0] < 0 && std::abs(home) > 1e-6 * grid.step) return home > 0;
  int beyond = 0;
  for (int k = 0; k < grid.count[2]; ++k)
    for (int j = 0; j < grid.count[1]; ++j)
      for (int i = 0; i < grid.count[0]; ++i)
        if (answers.inside(grid.index(i, j, k)))
          beyond += wall.beyond(grid.at(i, j, k)) > 0 ? 1 : -1;
  return beyond > 0;
}

}  // namespace

std::optional<SingularWall> find_singular_wall(const Probe& probe, const NodeGrid& grid,
                                               const Probe::Answers& answers) {
  if (!probe.sides() || probe.orientations() > 1) return std::nullopt;
  std::vector<Dip> dips = look_for_dips(probe, grid, answers);
  // Some of them, from everywhere.
  const std::size_t most = probe.evaluator().closed_form() ? 96 : 12;
  if (dips.size() > most) {
    std::vector<Dip> some;
    for (std::size_t i = 0; i < most; ++i) some.push_back(dips[i * dips.size() / most]);
    dips = std::move(some);
  }
  constexpr std::size_t kFewest = 8;
  if (dips.size() < kFewest) return std::nullopt;
  const std::vector<Vector3> zeros = zeros_in(probe, dips);
  if (zeros.size() < kFewest) return std::nullopt;
  auto wall = plane_through(zeros, probe.active(), 1e-7 * grid.step);
  if (!wall || !is_singular_between(probe, zeros)) return std::nullopt;
  if (beyond_is_more(probe, grid, answers, *wall)) *wall = {-wall->normal, -wall->offset};
  return wall;
}

}  // namespace polyglide
