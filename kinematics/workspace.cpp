#include "kinematics/workspace.hpp"

#include <tbb/parallel_invoke.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "kinematics/certified_volume.hpp"
#include "kinematics/clearance.hpp"
#include "kinematics/exact_workspace.hpp"
#include "kinematics/limits.hpp"
#include "kinematics/point_machine.hpp"
#include "kinematics/region_boundary.hpp"
#include "kinematics/region_measure.hpp"

namespace polyglide {
namespace {

/// A cell of the grid counts for a slice when one of its corners is in the region, so
/// that places of another part are left out.
bool near_region(const Region& region, const Vector3& point) {
  const NodeGrid& grid = region.grid;
  std::array<int, 3> low{};
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.count[axis] == 1) continue;
    low[axis] = static_cast<int>(std::floor((point[axis] - grid.origin[axis]) / grid.step));
    if (low[axis] < 0 || low[axis] > grid.count[axis] - 2) return false;
  }
  for (int corner = 0; corner < 8; ++corner) {
    std::array<int, 3> at = low;
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = std::min(at[axis] + (corner >> axis & 1), grid.count[axis] - 1);
    if (region.inside[grid.index(at[0], at[1], at[2])]) return true;
  }
  return false;
}

std::vector<double> spread(double lower, double upper, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(lower + (upper - lower) * (i + 0.5) / count);
  return values;
}

std::vector<Slice> make_slices(const Probe& probe, const Region& region, const Bounds& extent,
                               int count) {
  const int longest = probe.evaluator().closed_form() ? 40 : 11;
  const Vector3 size = extent.upper - extent.lower;
  const double step = std::max(size.x(), size.y()) / longest;
  const auto samples = [step](double length) {
    return step > 0 ? std::max(1, static_cast<int>(std::lround(length / step))) : 1;
  };
  std::vector<Slice> slices;
  for (double z : spread(extent.lower.z(), extent.upper.z(), size.z() > 0 ? count : 1)) {
    Slice slice{z,
                spread(extent.lower.x(), extent.upper.x(), samples(size.x())),
                spread(extent.lower.y(), extent.upper.y(), samples(size.y())),
                {}};
    Points points;
    std::vector<std::size_t> near;
    for (double y : slice.y)
      for (double x : slice.x) {
        slice.inverse_condition.push_back(std::numeric_limits<double>::quiet_NaN());
        if (!near_region(region, {x, y, z})) continue;
        near.push_back(slice.inverse_condition.size() - 1);
        points.add({x, y, z});
      }
    const Probe::Answers answers = probe.ask(points);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (answers.inside(i)) slice.inverse_condition[near[i]] = answers.inverse_condition[i];
    slices.push_back(std::move(slice));
  }
  return slices;
}

void take_measure(Workspace& result, const Probe& probe, const Region& region,
                  const RegionMeasure& measured) {
  result.global_conditioning = measured.mean;
  result.worst = measured.worst;
  result.best = measured.best;
  if (probe.dimensions() == 1) result.length = measured.value;
  if (probe.dimensions() == 3) {
    result.volume = measured.value;
    result.volume_lower = measured.lower;
    result.volume_upper = measured.upper;
  } else if (probe.dimensions() == 2) {
    result.area = measured.value;
    result.area_lower = measured.lower;
    result.area_upper = measured.upper;
  }
  result.error = measured.standard_error;
  const std::array<bool, 3>& active = probe.active();
  if (!active[0] || !active[1]) return;
  const double thickness = active[2] ? region.grid.step : 1;
  for (std::size_t k = 0; k < measured.layers.size(); ++k) {
    const double z =
        active[2] ? region.grid.origin.z() + (static_cast<double>(k) + 0.5) * thickness : 0;
    result.area_by_z.emplace_back(z, measured.layers[k] / thickness);
  }
}

/// Sampling is no way to more than that; what is asked beyond is left to quadrature.
double sampled_accuracy(const WorkspaceOptions& options) {
  constexpr double kDefault = 5e-4, kFinest = 1e-5;
  return options.accuracy < kFinest ? kDefault : options.accuracy;
}

/// Where joints are followed large boxes say nothing: what was sampled, with a margin. That the
/// workspace ends within it is proved on the way.
Bounds around(const Region& region) {
  constexpr double kMargin = 0.1;
  Bounds box = region.extent;
  for (int k = 0; k < 3; ++k) {
    if (region.grid.count[k] == 1) continue;  // not commanded
    const double margin = kMargin * (box.upper[k] - box.lower[k]) + region.grid.step;
    box.lower[k] -= margin;
    box.upper[k] += margin;
  }
  return box;
}

/// Puts proved bounds in place of sampled ones, where there is a proof.
void certify(Workspace& result, const Machine& machine, const WorkspaceOptions& options,
             const Bounds& reach, const SingularPlaces& singular) {
  constexpr double kOfAccuracy = 2;   // bounds as wide as the volume is uncertain to either side
  constexpr double kFollowed = 1e-2;  // where joints are followed, cells take long
  const double tolerance =
      std::max(kOfAccuracy * sampled_accuracy(options), machine.legs ? 1e-4 : kFollowed);
  // Bounds made by clearances close slowly; where they stay wide, sampled ones say more.
  constexpr double kWidest = 0.05;
  // Those at a wall close slowly, too: two singular values vanish there.
  constexpr int kBudget = 600000, kBudgetAtWall = 200000, kBudgetOfClearances = 20000;
  const bool clearances = !watched_pairs(machine.model.mechanism, options.ignored).empty();
  const auto proved =
      certify_volume(machine, options.ignored, options.rotation, reach, singular, tolerance,
                     clearances      ? kBudgetOfClearances
                     : singular.wall ? kBudgetAtWall
                                     : kBudget);
  if (!proved) return;
  if (clearances && proved->upper - proved->lower > kWidest * proved->upper) return;
  const bool flat = machine.task.translations == 2;
  double& size = flat ? result.area : result.volume;
  result.certified = true;
  (flat ? result.area_lower : result.volume_lower) = proved->lower;
  (flat ? result.area_upper : result.volume_upper) = proved->upper;
  // Of a machine of which few poses are asked the proof may know the size better than they do.
  const double half = (proved->upper - proved->lower) / 2;
  if (size >= proved->lower && size <= proved->upper && result.error <= half) return;
  size = proved->lower + half;
  result.error = half;
}

/// Poses that a workspace takes, about: to say how much of the work is done.
double expected_poses(const Evaluator& evaluator, std::size_t orientations) {
  constexpr double kClosedForm = 9e6, kGeneral = 8e3;
  return (evaluator.closed_form() ? kClosedForm : kGeneral) *
         static_cast<double>(orientations + 1) / 2;
}

PoseCounter counter_for(const WorkspaceOptions& options, double expected) {
  if (!options.progress) return {};
  return [report = options.progress, expected](std::size_t poses) {
    const auto done = static_cast<double>(poses);
    report(done, done < expected ? expected : 0);
  };
}

/// Orientations at every place; one for a workspace at one orientation.
std::vector<Eigen::Quaterniond> orientations_of(const Machine& machine,
                                                const WorkspaceOptions& options, int fineness) {
  if (!options.orientations) return {options.rotation};
  const OrientationSet& set = *options.orientations;
  const double most = greatest_tilt(machine.task);
  if (!(set.tilt >= 0 && set.tilt <= most && set.torsion >= 0 && set.torsion <= M_PI))
    throw std::invalid_argument(
        "compute_workspace: orientations need tilt and torsion from 0 to their greatest");
  return sample(machine.task, set, fineness);
}

/// Orientations between which nothing is asked: how many, and what a coarser set says.
OrientationSamples compare_samples(const Evaluator& evaluator, const WorkspaceOptions& options,
                                   std::size_t count, const std::vector<Eigen::Quaterniond>& few,
                                   double volume, std::size_t& poses) {
  constexpr double kRough = 5e-3;
  OrientationSamples samples{*options.orientations, count, few.size(), 0};
  Probe probe(evaluator, few);
  const RegionFineness fineness = region_fineness(kRough, evaluator.closed_form());
  const Region region = explore(probe, fineness.nodes);
  const double before = region.empty ? 0 : measure_region(probe, region, fineness, kRough).value;
  samples.change = before > 0 ? std::max(0.0, 1 - volume / before) : 0;
  poses += probe.poses();
  return samples;
}

std::string limit_at_home(const Probe& probe) {
  Points home;
  home.add(Vector3::Zero());
  const int limit = probe.ask(home).limit[0];
  return limit < 0 ? "" : probe.names()[limit];
}

/// The largest shapes inside, and why they are believed to be.
void inscribe(Workspace& result, const Probe& probe, const Inscriber& inscriber) {
  tbb::parallel_invoke([&] { result.cylinders = inscriber.tallest_cylinders(); },
                       [&] {
                         result.inscribed_cylinder = inscriber.largest_cylinder();
                         result.cylinder_evidence = evidence_for(probe, result.inscribed_cylinder);
                       },
                       [&] {
                         result.inscribed_box = inscriber.largest_box();
                         result.box_evidence = evidence_for(probe, result.inscribed_box);
                       },
                       [&] {
                         result.inscribed_sphere = inscriber.largest_sphere();
                         result.sphere_evidence = evidence_for(probe, result.inscribed_sphere);
                       });
}

}  // namespace

Workspace compute_workspace(const Machine& machine, const WorkspaceOptions& options) {
  if (const auto point = point_machine(machine)) return compute_workspace(*point, options);
  const auto start = std::chrono::steady_clock::now();
  const Evaluator evaluator(machine, options.ignored);
  const int samples = evaluator.closed_form() ? 3 : 1;
  Probe probe(evaluator, orientations_of(machine, options, samples));
  const bool crosses = is_ignored("singularity", options.ignored);
  if (crosses) probe.cross_singularities();
  probe.set_counter(counter_for(options, expected_poses(evaluator, probe.orientations())));
  const RegionFineness fineness =
      region_fineness(sampled_accuracy(options), evaluator.closed_form());

  Workspace result;
  result.characteristic_length = machine.task.characteristic_length;
  const Region region = explore(probe, fineness.nodes);
  if (evaluator.closed_form()) probe.set_reach(search_bounds(probe));
  const bool one = !options.orientations;
  if (!region.empty) {
    take_measure(result, probe, region,
                 measure_region(probe, region, fineness, sampled_accuracy(options)));
    const Boundary boundary = find_boundary(probe, region, fineness.bisections);
    result.limits_hit = boundary.limits;
    if (one && !options.volume_only)
      certify(result, evaluator.machine(), options,
              evaluator.closed_form() ? search_bounds(probe) : around(region),
              {crosses, probe.wall()});
    result.lower = boundary.extent.lower;
    result.upper = boundary.extent.upper;
    if (!options.volume_only)
      result.slices = make_slices(probe, region, boundary.extent, options.slices);
  }
  if (one && !options.volume_only) measure_by_quadrature(result, probe, region, options);
  if (result.singular_throughout)
    certify(result, evaluator.machine(), options, search_bounds(probe), {true, {}});
  if (!region.empty && (!options.volume_only || options.box || options.cylinder)) {
    const Inscriber inscriber(probe, region);
    if (!options.volume_only) inscribe(result, probe, inscriber);
    if (options.box) result.asked_box = inscriber.place(*options.box);
    if (options.cylinder)
      result.asked_cylinder = inscriber.place(options.cylinder->first, options.cylinder->second);
  }
  if (region.empty) result.stopped_by = limit_at_home(probe);
  result.poses = probe.poses();
  if (!one) {
    const double size = result.volume + result.area + result.length;  // two of them are zero
    result.orientations = compare_samples(
        evaluator, options, probe.orientations(),
        orientations_of(machine, options, std::max(1, samples / 2)), size, result.poses);
    result.volume_lower *= 1 - result.orientations->change;
  }
  if (one && !region.empty && !options.volume_only && machine.task.translations == 3) {
    const double degrees = evaluator.closed_form() ? 1 : 5;
    result.rotation_range = widest_rotation(evaluator, {result.lower, result.upper},
                                            degrees * M_PI / 180, result.poses);
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace polyglide
