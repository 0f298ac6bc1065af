#include "kinematics/exact_workspace.hpp"

#include <cmath>

#include "kinematics/exact_measure.hpp"

namespace polyglide {
namespace {

/// The node nearest to home whose neighbours are inside, too; else any inside.
std::optional<Vector3> well_inside(const Region& region, const LineLimits& limits) {
  const NodeGrid& grid = region.grid;
  std::optional<Vector3> best;
  double least = std::numeric_limits<double>::infinity();
  const auto inside = [&](std::array<int, 3> at, int axis, int way) {
    at[axis] += way;
    if (grid.count[axis] == 1) return true;
    if (at[axis] < 0 || at[axis] >= grid.count[axis]) return false;
    return region.inside[grid.index(at[0], at[1], at[2])] != 0;
  };
  for (int k = 0; k < grid.count[2]; ++k)
    for (int j = 0; j < grid.count[1]; ++j)
      for (int i = 0; i < grid.count[0]; ++i) {
        if (!region.inside[grid.index(i, j, k)]) continue;
        const Vector3 at = grid.at(i, j, k);
        double far = at.norm();
        for (int axis = 0; axis < 3; ++axis)
          for (int way : {-1, 1})
            if (!inside({i, j, k}, axis, way)) far += 10 * (grid.step + region.extent.upper.norm());
        if (far >= least || !limits.inside(at)) continue;
        least = far;
        best = at;
      }
  return best;
}

/// Where lines are laid: the sampled extent with a margin, no wider than the search box.
Bounds lines_around(const Region& region, const LineLimits& limits) {
  const Vector3 size = region.extent.upper - region.extent.lower;
  Bounds roomy = region.extent;
  const Vector3 margin = 0.1 * size + Vector3::Constant(3 * region.grid.step);
  roomy.lower -= margin;
  roomy.upper += margin;
  const Bounds own = limits.frame_bounds(roomy);
  return {own.lower.cwiseMax(limits.extent().lower), own.upper.cwiseMin(limits.extent().upper)};
}

/// The sampled estimate and the proved bounds must not contradict it.
bool agrees(const ExactMeasure& exact, double sampled, double error, double lower, double upper) {
  const double slack = 1e-7 * exact.value + exact.error;
  return std::abs(exact.value - sampled) <= 8 * error + 1e-3 * sampled + slack &&
         exact.value >= lower - slack && exact.value <= upper + slack;
}

}  // namespace

void measure_by_quadrature(Workspace& workspace, const Probe& probe, const Region& region,
                           const WorkspaceOptions& options) {
  const auto limits = LineLimits::make(probe.evaluator().machine(), options.ignored,
                                       probe.rotation(), search_bounds(probe));
  if (!limits) return;
  ExactSearch search;
  search.tolerance = std::min(1e-6, options.accuracy);
  search.lines = search.tolerance < 1e-6 ? 20'000'000 : 3'000'000;
  // How many lines it will take shows only in the end.
  if (options.progress) search.working = [&options] { options.progress(0, 0); };
  const bool flat = limits->dimensions() == 2;
  double& size = flat ? workspace.area : workspace.volume;
  if (region.empty) {
    // Limits hold at home, and yet nothing is inside: singular everywhere, or next to it.
    if (!limits->inside(Vector3::Zero())) return;
    const Vector3 extent = limits->extent().upper - limits->extent().lower;
    const auto whole =
        measure_exactly(*limits, Vector3::Zero(), limits->extent(),
                        extent.y() * extent.z() * (flat ? 1 : extent.x()) / 10, search);
    if (!whole) return;
    size = whole->value;
    workspace.reach = whole->value;
    workspace.error = whole->error;
    workspace.method = "quadrature";
    workspace.singular_throughout = true;
    (flat ? workspace.area_lower : workspace.volume_lower) = size - whole->error;
    (flat ? workspace.area_upper : workspace.volume_upper) = size + whole->error;
    return;
  }
  const auto inside = well_inside(region, *limits);
  if (!inside) return;
  LineLimits usable = *limits;
  const bool sided = (probe.side() != 0 && usable.keep_side_of(*inside)) || probe.wall();
  if (probe.wall()) usable.keep_before(*probe.wall());
  const Bounds lines = lines_around(region, *limits);
  const auto exact = measure_exactly(usable, *inside, lines, size, search);
  const double lower = flat ? workspace.area_lower : workspace.volume_lower;
  const double upper = flat ? workspace.area_upper : workspace.volume_upper;
  const bool taken =
      exact && agrees(*exact, size, workspace.error, workspace.certified ? lower : 0,
                      workspace.certified ? upper : std::numeric_limits<double>::infinity());
  if (taken) {
    size = exact->value;
    workspace.error = exact->error;
    workspace.method = "quadrature";
    if (!sided && exact->parts == 1) {
      workspace.reach = exact->value;
      return;
    }
  }
  const auto whole = measure_exactly(*limits, *inside, limits->extent(), size, search);
  if (whole && whole->value >= size * (1 - 8 * search.tolerance)) workspace.reach = whole->value;
}

}  // namespace polyglide
