#include "kinematics/limb_reach.hpp"

#include <cmath>
#include <limits>

#include "kinematics/limits.hpp"

namespace polyglide {
namespace {

constexpr double kSame = 1e-9;

struct Slide {
  Vector3 direction;
  Range range;
};

/// A body between two turning axes, or before the first and after the last: the way from one to
/// the other at home, and slides on it.
struct Link {
  Vector3 way = Vector3::Zero();
  std::vector<Slide> slides;
};

/// Axes one after the other; links[i] leads to axis i, the last one to the platform.
struct Limb {
  std::vector<Vector3> points, axes;
  std::vector<Link> links{Link{}};
};

Range range_of(const Model& model, int freedom, const std::vector<std::string>& ignored) {
  const Joint& joint = model.mechanism.joints[model.freedoms[freedom].joint];
  const int index = model.freedoms[freedom].index;
  if (joint.range.empty()) return {};
  const bool driven = std::ranges::count(joint.driven, index) > 0;
  const std::string word = (driven ? "stroke " : "range ") + joint.name;
  Range range = joint.range[index];
  if (is_ignored(word + " min", ignored)) range.min = Range{}.min;
  if (is_ignored(word + " max", ignored)) range.max = Range{}.max;
  return range;
}

void add_freedom(const Model& model, int f, const std::vector<std::string>& ignored, Limb& limb) {
  const Freedom& freedom = model.freedoms[f];
  if (freedom.translational) {
    limb.links.back().slides.push_back({freedom.screw.tail<3>(), range_of(model, f, ignored)});
    return;
  }
  const Joint& joint = model.mechanism.joints[freedom.joint];
  // A screw shifts along its axis without an end.
  if (joint.type == JointType::helical)
    limb.links.back().slides.push_back({freedom.screw.head<3>(), Range{}});
  if (!limb.points.empty()) limb.links.back().way = joint.at - limb.points.back();
  limb.points.push_back(joint.at);
  limb.axes.push_back(freedom.screw.head<3>());
  limb.links.emplace_back();
}

Limb limb_of(const Model& model, const std::vector<LoopStep>& way,
             const std::vector<std::string>& ignored) {
  Limb limb;
  for (const LoopStep& step : way) {
    const int first = model.first_freedom[step.joint];
    const int count = freedoms(model.mechanism.joints[step.joint].type);
    for (int i = 0; i < count; ++i)
      add_freedom(model, first + (step.sign > 0 ? i : count - 1 - i), ignored, limb);
  }
  return limb;
}

/// The greatest length of a link, across a direction if one is given; infinite where it slides on
/// without an end.
double longest(const Link& link, const std::optional<Vector3>& along) {
  const auto across = [&](const Vector3& v) -> Vector3 {
    return along ? Vector3(v - v.dot(*along) * *along) : v;
  };
  double result = 0;
  for (std::size_t corner = 0; corner < std::size_t{1} << link.slides.size(); ++corner) {
    Vector3 way = across(link.way);
    for (std::size_t i = 0; i < link.slides.size(); ++i) {
      const Vector3 direction = across(link.slides[i].direction);
      if (direction.norm() < 1e-12) continue;
      const Range& range = link.slides[i].range;
      const double end = corner >> i & 1 ? range.max : range.min;
      if (!std::isfinite(end)) return std::numeric_limits<double>::infinity();
      way += end * direction;
    }
    result = std::max(result, way.norm());
  }
  return result + kSame;
}

/// How far the slides of a link go along a direction, and its way.
Range span_of(const Link& link, const Vector3& along) {
  Range span{link.way.dot(along) - kSame, link.way.dot(along) + kSame};
  for (const Slide& slide : link.slides) {
    const double slope = slide.direction.dot(along);
    if (std::abs(slope) < 1e-12) continue;
    span.min += slope * (slope > 0 ? slide.range.min : slide.range.max);
    span.max += slope * (slope > 0 ? slide.range.max : slide.range.min);
  }
  return span;
}

/// The axis on which hinges that are all parallel to the first end: later axes go through its
/// point, and nothing slides there.
std::optional<std::size_t> last_parallel(const Limb& limb) {
  std::size_t last = 0;
  while (last + 1 < limb.axes.size() && limb.axes[last + 1].cross(limb.axes[0]).norm() < kSame)
    ++last;
  for (std::size_t i = last + 1; i < limb.axes.size(); ++i)
    if ((limb.points[i] - limb.points[last]).cross(limb.axes[i]).norm() > kSame)
      return std::nullopt;
  for (std::size_t i = last + 1; i < limb.links.size(); ++i)
    if (!limb.links[i].slides.empty()) return std::nullopt;
  return last;
}

}  // namespace

std::vector<ReachBound> reach_bounds(const Model& model, const std::vector<LoopStep>& way,
                                     const std::vector<std::string>& ignored) {
  const Limb limb = limb_of(model, way, ignored);
  std::vector<ReachBound> bounds;
  if (limb.points.empty()) return bounds;
  const std::size_t last = limb.points.size() - 1;
  double most = 0;
  for (std::size_t i = 1; i < limb.links.size(); ++i) most += longest(limb.links[i], std::nullopt);
  const std::vector<Slide>& guides = limb.links[0].slides;
  ReachBound free{limb.points[0], limb.points[last], std::nullopt, most, {}};
  if (guides.size() == 1) {
    free.along = guides[0].direction.normalized();
    const Range span = span_of(limb.links[0], *free.along);
    free.span = {span.min - most, span.max + most};
  } else {
    free.most += longest(limb.links[0], std::nullopt);
  }
  if (std::isfinite(free.most)) bounds.push_back(free);
  if (const auto end = last_parallel(limb); end && *end > 0) {
    const Vector3 axis = limb.axes[0].normalized();
    ReachBound planar{limb.points[0], limb.points[*end], axis, 0, {0, 0}};
    for (std::size_t i = 0; i <= *end; ++i) {
      planar.most += longest(limb.links[i], axis);
      // Turned about the axis, a link keeps its part along it.
      const Range span = span_of(limb.links[i], axis);
      planar.span = {planar.span.min + span.min, planar.span.max + span.max};
    }
    if (std::isfinite(planar.most) || std::isfinite(planar.span.min) ||
        std::isfinite(planar.span.max))
      bounds.push_back(planar);
  }
  return bounds;
}

}  // namespace polyglide
