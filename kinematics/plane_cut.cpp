#include "kinematics/plane_cut.hpp"

#include <bit>
#include <cmath>

namespace polyglide {
namespace {

/// How far rounding may move the middle and the sides of a box, as part of its half sides: for
/// coordinates up to 2^20 half sides. A cut by less than that is neither nothing nor all.
constexpr double kHair = 0x1p-30;

/// The normal of a plane before the unit cube, without the components that are nothing.
struct Normal {
  std::array<double, 3> along{};
  int count = 0;
};

/// Part of the unit cube where n·x <= height, all n > 0, enclosed: by inclusion and exclusion of
/// the corners below, Σ (-1)^|S| max(0, height - Σ_S n)^m / (m! Π n).
Interval part_below(const Normal& n, double height) {
  Interval sum(0.0), product(1.0);
  for (int corner = 0; corner < 1 << n.count; ++corner) {
    Interval left(height);
    for (int i = 0; i < n.count; ++i)
      if (corner >> i & 1) left -= n.along[i];
    left = Interval(std::max(0.0, left.lower()), std::max(0.0, left.upper()));
    Interval power = left;
    for (int i = 1; i < n.count; ++i) power *= left;
    if (std::popcount(static_cast<unsigned>(corner)) % 2 == 0)
      sum += power;
    else
      sum -= power;
  }
  for (int i = 0; i < n.count; ++i) product *= n.along[i] * Interval(i + 1.0);
  const Interval part = sum / product;
  return Interval(std::clamp(part.lower(), 0.0, 1.0), std::clamp(part.upper(), 0.0, 1.0));
}

/// The same for n >= 0 and a height between bounds. Components far below the largest are taken into
/// the height: divided by, they would cost digits.
Interval part_below(const std::array<double, 3>& n, Interval height) {
  constexpr double kFlat = 1e-3;
  const double largest = std::max({n[0], n[1], n[2]});
  Normal used;
  Interval total(0.0);
  for (double each : n) {
    if (each > kFlat * largest) {
      used.along[used.count++] = each;
      total += each;
    } else {
      height -= Interval(0, each);
    }
  }
  const double low = height.lower() <= 0               ? 0
                     : height.lower() >= total.upper() ? 1
                                                       : part_below(used, height.lower()).lower();
  const double high = height.upper() < 0                ? 0
                      : height.upper() >= total.upper() ? 1
                                                        : part_below(used, height.upper()).upper();
  return {low, high};
}

/// What a plane must be moved by so that what it allows then is allowed by the other, too; infinite
/// where they face apart.
double step_within(const Cuboid& cuboid, const PlaneBound& plane, const PlaneBound& other) {
  double common = 0, own = 0;
  for (int k = 0; k < 3; ++k) {
    const double square = cuboid.half[k] * cuboid.half[k];
    common += plane.slope[k] * other.slope[k] * square;
    own += plane.slope[k] * plane.slope[k] * square;
  }
  const double ratio = common / own;
  if (!(ratio > 0 && std::isfinite(ratio))) return std::numeric_limits<double>::infinity();
  // other - ratio·plane at its most.
  Interval most = Interval(other.at.upper()) - Interval(ratio) * plane.at.upper();
  for (int k = 0; k < 3; ++k)
    most += Interval(magnitude(other.slope[k] - Interval(ratio) * plane.slope[k])) * cuboid.half[k];
  return std::max(0.0, (most / ratio).upper());
}

}  // namespace

PlaneCut cut_of(const Cuboid& cuboid, const PlaneBound& plane) {
  // at + Σ slope·half·ξ <= 0, ξ in [-1, 1], as n·x <= height on the unit cube.
  std::array<double, 3> n;
  Interval swing(0.0), rounding(0.0);
  for (int k = 0; k < 3; ++k) {
    const Interval exact = std::abs(plane.slope[k]) * Interval(cuboid.half[k]);
    n[k] = 2 * middle(exact);
    rounding += Interval(-1, 1) * radius(exact);
    swing += exact;
  }
  if ((plane.at + swing).upper() <= 0) return {Interval(1.0), plane};
  if ((plane.at - swing).lower() > 0) return {Interval(0.0), plane};
  const Interval part = part_below(n, swing - plane.at + 2.0 * rounding);
  return {Interval(std::clamp(part.lower() - kHair, 0.0, 1 - kHair),
                   std::clamp(part.upper() + kHair, kHair, 1.0)),
          plane};
}

double part_taken(const Cuboid& cuboid, std::vector<PlaneCut> cuts) {
  const auto taken = [](const PlaneCut& each) { return 1.0 - Interval(each.part.lower()); };
  std::ranges::sort(cuts, {}, [](const PlaneCut& each) { return each.part.lower(); });
  std::size_t kept = 0;
  for (const PlaneCut& next : cuts) {
    bool within = false;
    for (std::size_t i = 0; i < kept && !within; ++i) {
      const double step = step_within(cuboid, cuts[i].plane, next.plane);
      if (!std::isfinite(step)) continue;
      PlaneCut both = cuts[i];
      if (step > 0) {
        PlaneBound moved = both.plane;
        moved.at += step;
        both = cut_of(cuboid, moved);
      }
      within = taken(both).upper() <= (taken(cuts[i]) + taken(next)).upper();
      if (within) cuts[i] = both;
    }
    if (!within) cuts[kept++] = next;
  }
  Interval sum(0.0);
  for (std::size_t i = 0; i < kept; ++i) sum += taken(cuts[i]);
  return std::min(1.0, sum.upper());
}

bool allows(const PlaneBound& plane, const Cuboid& cuboid, const Eigen::Vector3d& place) {
  Interval height(plane.at.upper());
  for (int k = 0; k < 3; ++k)
    height += Interval(place[k] - kHair, place[k] + kHair) * plane.slope[k] * cuboid.half[k];
  return height.upper() <= 0;
}

}  // namespace polyglide
