#include "kinematics/orientation_workspace.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "kinematics/orientation_grid.hpp"

namespace polyglide {
namespace {

using std::numbers::pi;
using Lines = std::vector<std::vector<TiltInterval>>;

struct GridSize {
  int azimuths, tilts, torsions;
};

GridSize grid_size(std::size_t rotations, bool closed_form) {
  if (rotations == 3) return closed_form ? GridSize{72, 90, 90} : GridSize{16, 36, 24};
  return closed_form ? GridSize{180, 180, 1} : GridSize{48, 45, 1};
}

std::string name_of(const Probe& probe, int limit) { return limit < 0 ? "" : probe.names()[limit]; }

/// Ends of turning both ways: about the axis of one rotation, or of torsion without tilt.
void find_ends(const Turner& turner, bool torsion, OrientationWorkspace& result) {
  const TaskSpace& task = turner.probe().evaluator().machine().task;
  const double most = torsion ? pi : greatest_tilt(task);
  for (double sign : {1.0, -1.0}) {
    TurnEnd& end = sign > 0 ? result.most : result.least;
    const auto at = [&](double angle) {
      return torsion ? Tilted{0, 0, sign * angle} : Tilted{sign > 0 ? 0 : pi, angle, 0};
    };
    const int steps = static_cast<int>(std::ceil(most / result.step));
    std::vector<Tilted> asked;
    for (int n = 1; n <= steps; ++n) asked.push_back(at(most * n / steps));
    const std::vector<int> answers = turner.ask(asked);
    const auto first = std::find_if(answers.begin(), answers.end(), [](int a) { return a >= 0; });
    const auto passed = static_cast<double>(first - answers.begin());
    double free = most * passed / steps, stopped = most * (passed + 1) / steps;
    int limit = first == answers.end() ? -1 : *first;
    while (limit >= 0 && stopped - free > 1e-6) {
      const double middle = (free + stopped) / 2;
      const int answer = turner.ask({at(middle)})[0];
      (answer < 0 ? free : stopped) = middle;
      if (answer >= 0) limit = answer;
    }
    end = {sign * free, name_of(turner.probe(), limit)};
  }
}

/// Of the intervals of several lines at one azimuth: the solid angle per azimuth that any covers.
double covered(std::vector<TiltInterval> intervals) {
  std::sort(intervals.begin(), intervals.end(),
            [](const TiltInterval& a, const TiltInterval& b) { return a.from < b.from; });
  double sum = 0, reached = 0;
  for (const TiltInterval& interval : intervals) {
    const double from = std::max(interval.from, reached);
    if (interval.to > from) sum += std::cos(from) - std::cos(interval.to);
    reached = std::max(reached, interval.to);
  }
  return sum;
}

/// Integral of sin(tilt) over every `stride`-th line, as a share of all rotations or of the sphere.
double share_of(const OrientationGrid& grid, const Lines& lines, int stride) {
  double sum = 0;
  int count = 0;
  const int torsion_stride = grid.torsions() == 1 ? 1 : stride;
  for (int t = 0; t < grid.torsions(); t += torsion_stride)
    for (int a = 0; a < grid.azimuths(); a += stride, ++count)
      sum += covered(lines[static_cast<std::size_t>(t) * grid.azimuths() + a]);
  return sum / (2 * count);
}

/// Tilts round about: by lines without torsion for the first ends, by the flood for the rest.
void look_round(const Turner& turner, const OrientationGrid& grid, const Lines& lines, double most,
                OrientationWorkspace& result) {
  std::vector<Tilted> straight;
  for (int a = 0; a < grid.azimuths(); ++a)
    straight.push_back({2 * pi * a / grid.azimuths(), 0, 0});
  std::vector<double> tilts;
  const std::vector<int> limits = turner.first_ends(straight, grid.step(), most, tilts);
  for (int a = 0; a < grid.azimuths(); ++a) {
    const auto i = static_cast<std::size_t>(a);
    TiltDirection direction{straight[i].azimuth, {tilts[i], name_of(turner.probe(), limits[i])}, 0};
    for (int t = 0; t < grid.torsions(); ++t)
      for (const TiltInterval& interval : lines[static_cast<std::size_t>(t) * grid.azimuths() + i])
        direction.any_torsion = std::max(direction.any_torsion, interval.to);
    result.greatest = std::max(result.greatest, direction.any_torsion);
    result.directions.push_back(direction);
  }
}

/// The direction in which tilting ends first, sought ever more closely about the worst found.
void find_worst(const Turner& turner, double step, double most, OrientationWorkspace& result) {
  const auto shorter = [](const TiltDirection& a, const TiltDirection& b) {
    return a.end.angle < b.end.angle;
  };
  result.worst = *std::min_element(result.directions.begin(), result.directions.end(), shorter);
  double width = 2 * pi / static_cast<double>(result.directions.size());
  for (int round = 0; round < 4; ++round, width /= 4) {
    std::vector<Tilted> near;
    for (int i = -4; i <= 4; ++i) near.push_back({result.worst.azimuth + width * i / 4, 0, 0});
    std::vector<double> tilts;
    const std::vector<int> limits = turner.first_ends(near, step, most, tilts);
    for (std::size_t i = 0; i < near.size(); ++i)
      if (tilts[i] < result.worst.end.angle) {
        result.worst.azimuth = std::remainder(near[i].azimuth, 2 * pi);
        result.worst.end = {tilts[i], name_of(turner.probe(), limits[i])};
      }
  }
}

void count_limits(const Probe& probe, const Lines& lines, std::map<std::string, double>& limits) {
  double ends = 0;
  for (const auto& line : lines)
    for (const TiltInterval& interval : line)
      for (int limit : {interval.from_limit, interval.to_limit})
        if (limit >= 0) {
          ++limits[probe.names()[limit]];
          ++ends;
        }
  for (auto& [limit, share] : limits) share /= ends;
}

void explore_tilts(const Turner& turner, const GridSize& size, OrientationWorkspace& result) {
  const Probe& probe = turner.probe();
  const double most = greatest_tilt(probe.evaluator().machine().task);
  OrientationGrid grid(size.azimuths, size.tilts, size.torsions, most);
  grid.flood(turner);
  const Lines lines = grid.intervals(turner);
  look_round(turner, grid, lines, most, result);
  find_worst(turner, grid.step(), most, result);
  count_limits(probe, lines, result.limits_hit);
  if (result.rotations.size() == 2 && result.rotations != std::vector<int>{3, 4}) return;
  result.share = share_of(grid, lines, 1);
  result.share_error = std::abs(result.share - share_of(grid, lines, 2));
  for (int a = 0; a < grid.azimuths(); ++a) {
    std::vector<TiltInterval> all;
    for (int t = 0; t < grid.torsions(); ++t) {
      const auto& line = lines[static_cast<std::size_t>(t) * grid.azimuths() + a];
      all.insert(all.end(), line.begin(), line.end());
    }
    result.solid_angle += covered(std::move(all)) * 2 * pi / grid.azimuths();
  }
}

}  // namespace

OrientationWorkspace orientation_workspace(const Machine& machine,
                                           const OrientationOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  OrientationWorkspace result;
  result.rotations = rotations_of(machine.task);
  if (result.rotations.empty())
    throw std::invalid_argument("orientation_workspace: a machine without rotations");
  if (!options.at.allFinite())
    throw std::invalid_argument("orientation_workspace: the place is not finite");
  const Evaluator evaluator(machine, options.ignored);
  Probe probe(evaluator, Eigen::Quaterniond::Identity());
  const GridSize size = grid_size(result.rotations.size(), evaluator.closed_form());
  if (options.progress)
    probe.set_counter([&, expected = 0.5 * size.azimuths * size.tilts * size.torsions](auto poses) {
      const auto done = static_cast<double>(poses);
      options.progress(done, done < expected ? expected : 0);
    });
  const Turner turner(probe, options.at);
  const int home = turner.ask({Tilted{}})[0];
  result.reachable = home < 0;
  result.limit = name_of(probe, home);
  if (result.reachable) {
    result.step = greatest_tilt(machine.task) / size.tilts;
    if (result.rotations.size() != 2) find_ends(turner, result.rotations.size() == 3, result);
    if (result.rotations.size() == 1)
      result.share = (result.most.angle - result.least.angle) / (2 * pi);
    else
      explore_tilts(turner, size, result);
  }
  result.poses = probe.poses();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

nlohmann::ordered_json to_json(const OrientationWorkspace& workspace) {
  using Json = nlohmann::ordered_json;
  const auto text = [](const std::string& limit) { return limit.empty() ? Json() : Json(limit); };
  Json json;
  std::string axes;
  for (int axis : workspace.rotations) axes += static_cast<char>('A' + axis - 3);
  json["rotations"] = axes;
  json["reachable"] = workspace.reachable;
  json["limit"] = text(workspace.limit);
  if (workspace.reachable) {
    if (workspace.rotations.size() != 2)
      json[workspace.rotations.size() == 1 ? "range" : "torsion"] = {
          {"min", workspace.least.angle},
          {"max", workspace.most.angle},
          {"min_limit", text(workspace.least.limit)},
          {"max_limit", text(workspace.most.limit)}};
    if (workspace.rotations.size() > 1) {
      const auto direction = [&](const TiltDirection& d) {
        return Json{{"azimuth", d.azimuth}, {"tilt", d.end.angle}, {"limit", text(d.end.limit)}};
      };
      json["tilt_in_every_direction"] = direction(workspace.worst);
      json["greatest_tilt"] = workspace.greatest;
      json["directions"] = Json::array();
      for (const TiltDirection& d : workspace.directions) {
        json["directions"].push_back(direction(d));
        json["directions"].back()["any_torsion"] = d.any_torsion;
      }
      json["solid_angle"] = workspace.solid_angle > 0 ? Json(workspace.solid_angle) : Json();
    }
    json["share"] = workspace.share > 0 ? Json(workspace.share) : Json();
    json["share_error"] = workspace.share > 0 ? Json(workspace.share_error) : Json();
    json["limits_hit"] = workspace.limits_hit;
    json["step"] = workspace.step;
  }
  json["poses"] = workspace.poses;
  json["seconds"] = workspace.seconds;
  return json;
}

}  // namespace polyglide
