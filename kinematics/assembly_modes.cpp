#include "kinematics/assembly_modes.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

#include "catalog/counted.hpp"
#include "kinematics/distance_newton.hpp"
#include "kinematics/krawczyk.hpp"
#include "kinematics/manifold.hpp"
#include "kinematics/mode_bounds.hpp"

namespace polyglide {
namespace {

constexpr double kSame = 1e-6;  // [rad, or length/size] poses nearer than this are one

double distance(const Model& model, const Pose& a, const Pose& b) {
  return std::max((a.position - b.position).norm() / model.size,
                  a.rotation.angularDistance(b.rotation));
}

// --- Three spheres ---

/// Leg i keeps its platform joint at `radius` from its centre, so the displacement p obeys
/// |p - centre_i| = radius_i.
struct Sphere {
  Vector3 centre;
  double radius;
};

std::optional<std::vector<Sphere>> leg_spheres(const Machine& machine,
                                               const Eigen::VectorXd& drives) {
  const TaskSpace& task = machine.task;
  const bool translational = task.pure && task.translations == 3 && task.rotations == 0;
  if (!translational || !machine.legs || machine.legs->primary.size() != 3) return std::nullopt;
  std::vector<Sphere> spheres;
  for (int index : machine.legs->primary) {
    const Leg& leg = machine.legs->legs[index];
    const double q = drives[leg.drive];
    if (leg.kind == Leg::Kind::strut)
      spheres.push_back({leg.base_point - leg.platform_point, leg.length + q});
    else if (leg.kind == Leg::Kind::crank_rod)
      spheres.push_back({leg.centre +
                             Eigen::AngleAxisd(q, leg.direction) * (leg.base_point - leg.centre) -
                             leg.platform_point,
                         leg.length});
    else
      spheres.push_back({leg.base_point + q * leg.direction - leg.platform_point, leg.length});
  }
  return spheres;
}

/// Both points common to three spheres; empty when they do not meet or when the
/// centres lie on one line.
std::vector<Vector3> intersect(const std::vector<Sphere>& spheres) {
  const Vector3 &c1 = spheres[0].centre, &c2 = spheres[1].centre, &c3 = spheres[2].centre;
  const double r1 = spheres[0].radius, r2 = spheres[1].radius, r3 = spheres[2].radius;
  const Vector3 a = c2 - c1, b = c3 - c1, normal = a.cross(b);
  if (normal.norm() < 1e-12 * std::max(a.squaredNorm(), b.squaredNorm())) return {};
  // Radical planes of the pairs (1,2) and (1,3): p·a = h, p·b = k, relative to c1.
  const double h = (r1 * r1 - r2 * r2 + a.squaredNorm()) / 2;
  const double k = (r1 * r1 - r3 * r3 + b.squaredNorm()) / 2;
  const Vector3 foot = (h * b.cross(normal) + k * normal.cross(a)) / normal.squaredNorm();
  const double square = r1 * r1 - foot.squaredNorm();
  if (square < 0) return {};
  const Vector3 rise = std::sqrt(square) * normal.normalized();
  return {c1 + foot + rise, c1 + foot - rise};
}

/// Side of the plane of the centres that a point is on; 0 within rounding of it.
int sphere_side(const std::vector<Sphere>& spheres, const Vector3& point) {
  const Vector3 a = point - spheres[0].centre, b = point - spheres[1].centre,
                c = point - spheres[2].centre;
  const double volume = a.dot(b.cross(c));
  if (!(std::abs(volume) > 1e-12 * a.norm() * b.norm() * c.norm())) return 0;
  return volume > 0 ? 1 : -1;
}

// --- Many starts ---

/// What one Newton run ended in.
using Found = std::optional<ForwardSolution>;

/// Runs `start(number)` in rounds, the runs of a round on all threads, and gathers what is
/// new in the order of their numbers.
template <typename Start>
std::vector<ForwardSolution> gather(const Model& model, const AssemblySearch& search, int most,
                                    int round, Completeness& completeness, const Start& start) {
  constexpr int kLeast = 3, kFruitless = 8;  // rounds
  std::vector<ForwardSolution> modes;
  std::vector<int> hits;
  bool scattered = false;
  while (completeness.starts < most) {
    std::vector<Found> found(static_cast<std::size_t>(std::min(round, most - completeness.starts)));
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
      found[i] = start(static_cast<std::uint64_t>(completeness.starts) + i);
    });
    completeness.starts += static_cast<int>(found.size());
    for (Found& one : found) {
      if (!one) continue;
      ++completeness.hits;
      const auto known =
          std::find_if(modes.begin(), modes.end(), [&](const ForwardSolution& other) {
            return distance(model, other.pose, one->pose) < kSame;
          });
      if (known != modes.end()) {
        ++hits[known - modes.begin()];
        if (one->residual < known->residual) *known = std::move(*one);
      } else {
        modes.push_back(std::move(*one));
        hits.push_back(1);
      }
    }
    completeness.rarest_hits = hits.empty() ? 0 : *std::min_element(hits.begin(), hits.end());
    if (completeness.rarest_hits >= search.hits && completeness.starts >= kLeast * round) break;
    if (completeness.hits == 0 && completeness.starts >= kFruitless * round) break;
    // A continuum: nearly every start ends somewhere else.
    scattered =
        completeness.hits >= 60 && 2 * std::count(hits.begin(), hits.end(), 1) > completeness.hits;
    if (scattered) break;
    if (completeness.bound > 0 && static_cast<int>(modes.size()) >= completeness.bound) break;
  }
  const auto once = std::count(hits.begin(), hits.end(), 1);
  // Never below what so many hits can show.
  if (completeness.hits > 0)
    completeness.unseen =
        std::max(1.0, static_cast<double>(once)) / static_cast<double>(completeness.hits);
  if (completeness.hits == 0)
    completeness.stopped = fmt::format(
        "none of {} starts had ended in a posture: these drives seem to be out of reach",
        completeness.starts);
  else if (scattered)
    completeness.stopped =
        "nearly every start had ended elsewhere: the drives do not hold the platform";
  else if (completeness.rarest_hits >= search.hits)
    completeness.stopped = fmt::format("every mode was met {} times or more", search.hits);
  else if (completeness.bound > 0 && static_cast<int>(modes.size()) >= completeness.bound)
    completeness.stopped = "as many modes as such a machine can have";
  else
    completeness.stopped = fmt::format("the budget of {} starts was spent", most);
  return modes;
}

/// Every joint coordinate anywhere, as a start for Newton.
Posture random_posture(const Model& model, std::mt19937_64& random) {
  Posture posture = home(model);
  Eigen::VectorXd increments(model.freedoms.size());
  for (Eigen::Index f = 0; f < increments.size(); ++f) {
    const double unit = 2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1;
    increments[f] = unit * (model.freedoms[f].translational ? 2 * model.size : M_PI);
  }
  advance(model, posture, increments);
  return posture;
}

Found closure_start(const Model& model, const std::vector<int>& passive,
                    const Eigen::VectorXd& drives, std::uint64_t seed, std::uint64_t number) {
  std::mt19937_64 random(seed * 0x9e3779b97f4a7c15ULL + number);
  Posture posture = random_posture(model, random);
  Eigen::VectorXd increments =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.freedoms.size()));
  increments(model.drives) = drives - drive_positions(model, posture);
  advance(model, posture, increments);
  const Projection projection = project(model, posture, passive);
  if (!projection.closed) return std::nullopt;
  ForwardSolution found;
  found.pose = platform_pose(model, posture.bodies[model.mechanism.platform]);
  found.residual = projection.residual;
  found.posture = std::move(posture);
  return found;
}

// --- Regions ---

/// Numbers the modes by regions: those joined by a straight way, or by two through another mode's
/// or home's surroundings, without det J changing sign. Home's pose is one more place.
void find_regions(const DistancePlatform& platform, std::vector<ForwardSolution>& modes,
                  std::uint64_t seed) {
  constexpr int kSamples = 48, kWays = 6;
  std::vector<Pose> poses;
  for (const ForwardSolution& mode : modes) poses.push_back(mode.pose);
  poses.emplace_back();
  std::vector<int> group(poses.size());
  std::iota(group.begin(), group.end(), 0);
  const auto root = [&](int i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  std::mt19937_64 random(seed);
  const int count = static_cast<int>(poses.size());
  for (int way = 0; way < kWays; ++way)
    for (int i = 0; i < count; ++i)
      for (int j = i + 1; j < count; ++j) {
        if (root(i) == root(j)) continue;
        const Pose &a = poses[i], &b = poses[j];
        if (platform.side(a) != platform.side(b)) continue;
        bool joined = false;
        if (way == 0) {
          joined = platform.regular_between(a, b, kSamples);
        } else {
          // Around a corner: somewhere beside the middle of the straight way.
          const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
          const Vector3 aside(unit(), unit(), unit()), turn(unit(), unit(), unit());
          const double far = (a.position - b.position).norm(), angle = turn.norm();
          const Pose corner{(a.position + b.position) / 2 + far / 2 * aside,
                            Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) *
                                a.rotation.slerp(0.5, b.rotation)};
          joined = platform.side(corner) == platform.side(a) &&
                   platform.regular_between(a, corner, kSamples) &&
                   platform.regular_between(corner, b, kSamples);
        }
        if (joined) group[root(j)] = root(i);
      }
  std::vector<int> numbers(poses.size(), -1);
  int next = 0;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    int& number = numbers[root(static_cast<int>(i))];
    if (number < 0) number = next++;
    modes[i].region = number;
    if (root(static_cast<int>(i)) == root(count - 1)) modes[i].connected_to_home = true;
  }
}

// --- Together ---

/// A total order of poses, so that answers print the same everywhere.
bool before(const ForwardSolution& a, const ForwardSolution& b) {
  if (a.home_mode != b.home_mode) return a.home_mode;
  const auto ca = coordinates_of(a.pose), cb = coordinates_of(b.pose);
  return std::lexicographical_compare(ca.begin(), ca.end(), cb.begin(), cb.end());
}

/// Marks the mode that home's drives lead to; adds it when it was missed.
void mark_home_mode(const Machine& machine, const Eigen::VectorXd& drives,
                    std::vector<ForwardSolution>& modes) {
  auto own = follow_from_home(machine, drives);
  if (!own) return;
  const auto mine = std::find_if(modes.begin(), modes.end(), [&](const ForwardSolution& mode) {
    return distance(machine.model, mode.pose, own->pose) < kSame;
  });
  if (mine == modes.end()) {
    modes.push_back(std::move(*own));
  } else {
    mine->home_mode = true;
    if (!mine->posture) mine->posture = std::move(own->posture);
  }
}

void certify(ForwardSolution& mode, const ModeCertificate& certificate) {
  mode.certified = certificate.proved;
  mode.radius = certificate.radius;
}

void check_drives(const Machine& machine, const Eigen::VectorXd& drives) {
  const auto count = static_cast<Eigen::Index>(machine.model.drives.size());
  if (drives.size() != count)
    throw std::invalid_argument(fmt::format("{} given, the machine has {}",
                                            counted(drives.size(), "drive position"),
                                            counted(count, "drive")));
  if (!drives.allFinite()) throw std::invalid_argument("a drive position is not a finite number");
}

}  // namespace

std::vector<int> distance_legs(const Machine& machine) {
  if (!machine.legs || machine.legs->legs.size() != 6 || has_cranks(*machine.legs)) return {};
  std::vector<int> legs;
  for (int i = 0; i < 6; ++i) {
    const Leg& leg = machine.legs->legs[i];
    const auto ball = [&](int joint) {
      return machine.model.mechanism.joints[joint].type == JointType::spherical;
    };
    if (!ball(leg.base_joint) && !ball(leg.platform_joint)) return {};
    legs.push_back(i);
  }
  return legs;
}

std::vector<ForwardSolution> three_sphere_modes(const Machine& machine,
                                                const Eigen::VectorXd& drives) {
  const auto spheres = leg_spheres(machine, drives);
  if (!spheres) return {};
  std::vector<ForwardSolution> solutions;
  for (const Vector3& point : intersect(*spheres)) {
    ForwardSolution solution;
    solution.pose.position = point;
    for (const Sphere& sphere : *spheres)
      solution.residual =
          std::max(solution.residual,
                   std::abs((point - sphere.centre).norm() - sphere.radius) / machine.model.size);
    solution.closed_form = true;
    certify(solution, certify_pose(machine, machine.legs->primary, drives, solution.pose, true));
    solutions.push_back(solution);
  }
  return solutions;
}

AssemblyModes find_assembly_modes(const Machine& machine, const Eigen::VectorXd& drives,
                                  const AssemblySearch& search) {
  check_drives(machine, drives);
  const Model& model = machine.model;
  AssemblyModes result;
  Completeness& completeness = result.completeness;
  if (!(drive_distance(model, 0 * drives, drives) < kFarthestWay)) {
    completeness.stopped =
        fmt::format("drives farther than {:g} sizes of the machine", kFarthestWay);
    return result;
  }
  if (const auto spheres = leg_spheres(machine, drives)) {
    result.solutions = three_sphere_modes(machine, drives);
    completeness.bound = 2;
    completeness.family = "three spheres";
    completeness.unseen = 0;
    completeness.stopped = "closed form";
    // The two points lie on either side of the plane of the centres, where det J is zero: home's
    // mode is on home's side.
    const int own = sphere_side(*leg_spheres(machine, 0 * drives), Vector3::Zero());
    for (std::size_t i = 0; i < result.solutions.size(); ++i) {
      ForwardSolution& mode = result.solutions[i];
      mode.region = static_cast<int>(i);
      mode.home_mode = own != 0 && sphere_side(*spheres, mode.pose.position) == own;
      mode.connected_to_home = mode.home_mode;
    }
    completeness.complete = std::all_of(result.solutions.begin(), result.solutions.end(),
                                        [](const auto& mode) { return mode.certified; }) &&
                            result.solutions.size() == 2;
    std::sort(result.solutions.begin(), result.solutions.end(), before);
    return result;
  }

  const ModeBound most = most_modes(machine);
  completeness.bound = most.count;
  completeness.family = most.family;
  const std::vector<int> legs = distance_legs(machine);
  if (!legs.empty()) {
    const DistancePlatform platform(machine, legs, drives);
    constexpr int kMost = 40000, kRound = 2000;
    result.solutions = gather(model, search, search.starts > 0 ? search.starts : kMost, kRound,
                              completeness, [&](std::uint64_t number) -> Found {
                                const auto pose = platform.random_root(search.seed, number);
                                if (!pose) return std::nullopt;
                                ForwardSolution found;
                                found.pose = *pose;
                                found.residual = platform.residual(*pose);
                                return found;
                              });
    mark_home_mode(machine, drives, result.solutions);
    for (ForwardSolution& mode : result.solutions)
      certify(mode, certify_pose(machine, legs, drives, mode.pose, false));
    std::sort(result.solutions.begin(), result.solutions.end(), before);
    if (search.regions) find_regions(platform, result.solutions, search.seed);
  } else {
    const std::vector<int> passive = passive_freedoms(model);
    constexpr int kMost = 1600, kRound = 100;
    result.solutions = gather(model, search, search.starts > 0 ? search.starts : kMost, kRound,
                              completeness, [&](std::uint64_t number) {
                                return closure_start(model, passive, drives, search.seed, number);
                              });
    mark_home_mode(machine, drives, result.solutions);
    for (ForwardSolution& mode : result.solutions)
      if (mode.posture) certify(mode, certify_closure(model, *mode.posture));
    std::sort(result.solutions.begin(), result.solutions.end(), before);
  }
  for (ForwardSolution& mode : result.solutions) mode.connected_to_home |= mode.home_mode;
  completeness.complete = completeness.bound > 0 &&
                          completeness.bound == static_cast<int>(result.solutions.size()) &&
                          std::all_of(result.solutions.begin(), result.solutions.end(),
                                      [](const ForwardSolution& mode) { return mode.certified; });
  return result;
}

}  // namespace polyglide
