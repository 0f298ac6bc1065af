// The limits of ClosureBounds.
#include "kinematics/closure_bounds.hpp"
#include "kinematics/limits.hpp"

namespace polyglide {
namespace {

constexpr double kFar = 1e6;  // [m] farther than anything

}  // namespace

void ClosureBounds::add_joint(int j, const std::vector<std::string>& ignored) {
  const Model& model = machine_->model;
  const Joint& joint = model.mechanism.joints[j];
  for (std::size_t i = 0; i < joint.range.size(); ++i) {
    const int variable = model.first_freedom[j] + static_cast<int>(i);
    if (system_.part_of(variable) < 0) continue;
    const bool driven = std::ranges::count(joint.driven, static_cast<int>(i)) > 0;
    const std::string word = (driven ? "stroke " : "range ") + joint.name;
    const Interval scale(model.freedoms[variable].translational ? model.size : 1.0);
    const auto [min, max] = joint.range[i];
    if (std::isfinite(min) && !is_ignored(word + " min", ignored))
      ends_.push_back({add(word + " min"), variable, scale, min, -1});
    if (std::isfinite(max) && !is_ignored(word + " max", ignored))
      ends_.push_back({add(word + " max"), variable, scale, max, 1});
  }
  if (!joint.cone || is_ignored("cone " + joint.name, ignored)) return;
  cones_.push_back({add("cone " + joint.name), joint_chain(model, j, home(model)), joint.cone_axis,
                    cosine(Interval(std::min(M_PI, *joint.cone + kSlack)))});
}

void ClosureBounds::add_limits(const std::vector<std::string>& ignored) {
  const Mechanism& mechanism = machine_->model.mechanism;
  add("reach");
  for (int j = 0; j < static_cast<int>(mechanism.joints.size()); ++j) add_joint(j, ignored);
  // Where coordinates follow from the limbs, where the platform is says little.
  for (const auto& limb : system_.limbs())
    for (const ReachBound& bound : reach_bounds(machine_->model, limb, ignored))
      if (machine_->task.pure) add_reach(bound);
  platform_ = system_.chain_to(mechanism.platform);
  for (const HalfSpaceLimit& limit : mechanism.limits) {
    if (is_ignored(limit.name, ignored)) continue;
    for (const Vector3& point : limit.points)
      for (const HalfSpaceLimit::Plane& plane : limit.planes)
        planes_.push_back({add(limit.name), system_.chain_to(limit.body), point, plane.normal,
                           Interval(plane.offset) + kSlack});
  }
}

bool ClosureBounds::beyond_reach(const PoseBox& box) const {
  Mask wanted;
  for (const Stretched& each : stretched_)
    for (const std::size_t limit : {each.most, each.min, each.max})
      if (limit < kMost) wanted.set(limit);
  std::vector<LimitBound> bounds(size());
  enclose_reach(pose_of_box(box), wanted, bounds);
  return std::ranges::any_of(bounds,
                             [](const LimitBound& bound) { return bound.value.lower() > 0; });
}

/// The gradient of what changes by change(screw) with a screw's coordinate.
template <typename Change>
void ClosureBounds::set(const Known& known, LimitBound& bound,
                        const std::vector<CarriedScrew>& screws, const Change& change) const {
  bound.gradient.fill(Interval(0.0));
  for (const CarriedScrew& screw : screws) {
    const Interval by_screw = change(screw);
    for (int k = 0; k < static_cast<int>(system_.commanded().size()); ++k)
      bound.gradient[system_.commanded()[k]] +=
          by_screw * rate(known, screw.variable, k) / scale_of(k);
  }
}

void ClosureBounds::enclose(const PoseBox& box, const Mask& wanted, std::vector<LimitBound>& bounds,
                            const BranchPointer& branch) const {
  bounds.resize(size());
  const Known known = this->known(box, branch);
  const double size = machine_->model.size;
  std::array<Interval, 6> nothing, anything;
  nothing.fill(Interval(0.0));
  anything.fill(kAnything);
  const LimitBound unknown{kAnything, anything};
  const auto is_known = [&](int variable) {
    return system_.part_of(variable) < 0 || known.rates[system_.part_of(variable)] != nullptr;
  };
  const auto all_known = [&](const ScrewChain& chain) {
    return std::ranges::all_of(chain, [&](const ScrewFactor& f) { return is_known(f.variable); });
  };
  if (wanted[0]) bounds[0] = known.all() ? LimitBound{Interval(-1.0), nothing} : unknown;
  enclose_reach(known, wanted, bounds);
  for (const EndOfRange& end : ends_) {
    if (!wanted[end.limit]) continue;
    LimitBound& bound = bounds[end.limit] = unknown;
    if (!is_known(end.variable)) continue;
    bound.value = end.sign * (end.scale * known.variables[end.variable] - end.end) - kSlack;
    bound.gradient = nothing;
    for (int k = 0; k < static_cast<int>(system_.commanded().size()); ++k)
      bound.gradient[system_.commanded()[k]] =
          end.sign * end.scale * rate(known, end.variable, k) / scale_of(k);
  }
  Carried carried;
  for (const Cone& cone : cones_) {
    if (!wanted[cone.limit]) continue;
    LimitBound& bound = bounds[cone.limit] = unknown;
    if (!all_known(cone.chain)) continue;
    carry(cone.chain, Vector3::Zero(), known.variables, size, carried);
    const IntervalVector axis = turned(carried.rotation, vector_of(cone.axis));
    // cos(limit) <= cone_axis · axis
    bound.value = cone.cosine - dot(cone.axis, axis);
    set(known, bound, carried.screws,
        [&](const CarriedScrew& screw) { return -dot(cone.axis, cross(screw.w, axis)); });
  }
  for (const Plane& plane : planes_) {
    if (!wanted[plane.limit]) continue;
    LimitBound& bound = bounds[plane.limit] = unknown;
    if (!all_known(plane.chain)) continue;
    carry(plane.chain, plane.point, known.variables, size, carried);
    bound.value = dot(plane.normal, plane.point) + dot(plane.normal, carried.shift) - plane.offset;
    set(known, bound, carried.screws, [&](const CarriedScrew& screw) {
      const Interval by = dot(plane.normal, screw.v);
      return screw.translational ? by * size : by;
    });
  }
}

void ClosureBounds::add_reach(const ReachBound& bound) {
  const auto wanted = [this](bool exists) { return exists ? add("reach") : kMost; };
  stretched_.push_back({wanted(std::isfinite(bound.most)), wanted(std::isfinite(bound.span.min)),
                        wanted(std::isfinite(bound.span.max)), bound});
}

/// Where a limb can be closed at all, whether or not it was followed there.
void ClosureBounds::enclose_reach(const Known& known, const Mask& wanted,
                                  std::vector<LimitBound>& bounds) const {
  Carried carried;
  const double size = machine_->model.size;
  const auto asked = [&](std::size_t limit) { return limit < kMost && wanted[limit]; };
  for (const auto& [most, min, max, bound] : stretched_) {
    if (!asked(most) && !asked(min) && !asked(max)) continue;
    carry(platform_, bound.platform, known.variables, size, carried);
    const Vector3 along = bound.along.value_or(Vector3::Zero());
    const auto across = [&](IntervalVector v) {
      const Interval part = dot(along, v);
      for (int i = 0; i < 3; ++i) v[i] -= part * along[i];
      return v;
    };
    IntervalVector way = carried.shift;
    for (int i = 0; i < 3; ++i) way[i] += Interval(bound.platform[i]) - bound.base[i];
    const auto put = [&](std::size_t limit, const Interval& value, const auto& change) {
      if (!asked(limit)) return;
      bounds[limit].value = value;
      set(known, bounds[limit], carried.screws, [&](const CarriedScrew& screw) {
        return screw.translational ? change(screw.v) * size : change(screw.v);
      });
    };
    const IntervalVector beside = across(way);
    put(most, squared_norm(beside) - square(Interval(std::min(bound.most, kFar))),
        [&](const IntervalVector& v) { return 2.0 * dot(beside, across(v)); });
    const Interval height = dot(along, way);
    put(min, std::max(bound.span.min, -kFar) - height,
        [&](const IntervalVector& v) { return -dot(along, v); });
    put(max, height - std::min(bound.span.max, kFar),
        [&](const IntervalVector& v) { return dot(along, v); });
  }
}

}  // namespace polyglide
