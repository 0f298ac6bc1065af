#include <algorithm>
#include <cmath>
#include <random>

#include "kinematics/manifold.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {
namespace {

void set_drives(const Model& model, Posture& posture, const Eigen::VectorXd& drives) {
  Eigen::VectorXd increments =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.freedoms.size()));
  increments(model.drives) = drives - drive_positions(model, posture);
  advance(model, posture, increments);
}

bool same_pose(const Model& model, const Pose& a, const Pose& b) {
  return (a.position - b.position).norm() < 1e-6 * model.size &&
         a.rotation.angularDistance(b.rotation) < 1e-6;
}

/// Translational machine with three closed-form legs: the tool is where three
/// spheres meet. Leg i keeps its platform joint at `radius` from its centre, so
/// the displacement p obeys |p - centre_i| = radius_i.
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

std::vector<ForwardSolution> solve_spheres(const Model& model, const std::vector<Sphere>& spheres) {
  std::vector<ForwardSolution> solutions;
  for (const Vector3& point : intersect(spheres)) {
    ForwardSolution solution;
    solution.pose.position = point;
    for (const Sphere& sphere : spheres)
      solution.residual = std::max(
          solution.residual, std::abs((point - sphere.centre).norm() - sphere.radius) / model.size);
    solution.closed_form = true;
    solutions.push_back(solution);
  }
  return solutions;
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

std::vector<ForwardSolution> multistart(const Machine& machine, const Eigen::VectorXd& drives,
                                        std::uint64_t seed) {
  const Model& model = machine.model;
  const std::vector<int> passive = passive_freedoms(model);
  std::mt19937_64 random(seed);
  std::vector<ForwardSolution> solutions;
  constexpr int kStarts = 400;
  for (int i = 0; i < kStarts; ++i) {
    Posture posture = random_posture(model, random);
    set_drives(model, posture, drives);
    const Projection projection = project(model, posture, passive);
    if (!projection.closed) continue;
    ForwardSolution found;
    found.pose = platform_pose(model, posture.bodies[model.mechanism.platform]);
    found.residual = projection.residual;
    const bool known = std::any_of(
        solutions.begin(), solutions.end(),
        [&](const ForwardSolution& other) { return same_pose(model, other.pose, found.pose); });
    if (!known) solutions.push_back(found);
  }
  return solutions;
}

/// A total order of poses, so that answers print the same everywhere.
bool before(const ForwardSolution& a, const ForwardSolution& b) {
  if (a.home_mode != b.home_mode) return a.home_mode;
  const auto ca = coordinates_of(a.pose), cb = coordinates_of(b.pose);
  return std::lexicographical_compare(ca.begin(), ca.end(), cb.begin(), cb.end());
}

}  // namespace

bool solve_forward_from(const Machine& machine, const Eigen::VectorXd& drives, Posture& posture) {
  const Model& model = machine.model;
  const std::vector<int> passive = passive_freedoms(model);
  const Eigen::VectorXd start = drive_positions(model, posture);
  double farthest = 1e-9;
  for (Eigen::Index d = 0; d < drives.size(); ++d) {
    const double scale = model.freedoms[model.drives[d]].translational ? model.size : 1;
    farthest = std::max(farthest, std::abs(drives[d] - start[d]) / scale);
  }
  constexpr double kStep = 0.25, kShortest = 1e-4;
  Posture current = posture;
  double done = 0, step = std::min(1.0, kStep / farthest);
  while (done < 1) {
    const double next = std::min(1.0, done + step);
    Posture trial = current;
    set_drives(model, trial, start + next * (drives - start));
    if (project(model, trial, passive).closed && displacement(model, current, trial) < 1.5) {
      current = std::move(trial);
      done = next;
    } else if ((step /= 2) < kShortest) {
      return false;
    }
  }
  posture = std::move(current);
  return true;
}

std::vector<ForwardSolution> solve_forward(const Machine& machine, const Eigen::VectorXd& drives,
                                           bool all, std::uint64_t seed) {
  const Model& model = machine.model;
  Posture posture = home(model);
  const bool followed = solve_forward_from(machine, drives, posture);
  ForwardSolution own;
  own.home_mode = true;
  if (followed) {
    own.pose = platform_pose(model, posture.bodies[model.mechanism.platform]);
    const Eigen::VectorXd residual = closure_residual(model, posture);
    own.residual = residual.size() > 0 ? residual.cwiseAbs().maxCoeff() : 0;
  }
  const auto spheres = leg_spheres(machine, drives);
  std::vector<ForwardSolution> solutions;
  if (spheres)
    solutions = solve_spheres(model, *spheres);
  else if (all)
    solutions = multistart(machine, drives, seed);

  const auto mine =
      std::find_if(solutions.begin(), solutions.end(), [&](const ForwardSolution& solution) {
        return followed && same_pose(model, solution.pose, own.pose);
      });
  if (mine != solutions.end())
    mine->home_mode = true;
  else if (followed)
    solutions.push_back(own);
  std::sort(solutions.begin(), solutions.end(), before);
  if (!all && solutions.size() > 1) solutions.resize(1);
  return solutions;
}

}  // namespace polyglide
