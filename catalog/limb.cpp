#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "catalog/draft.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

constexpr std::size_t kMostCopies = 100;

/// One copy of a limb being expanded.
struct Copy {
  const Reader& reader;
  Compass compass;
  std::string name;                    ///< "leg2"
  std::array<std::string, 2> between;  ///< the bodies the limb joins
  std::vector<JointDraft>& joints;

  /// Appends a joint named "leg2.<part>".
  Joint& append(const std::string& part, JointType type, const Vector3& at, const json& origin,
                std::string first, std::string second) {
    JointDraft draft;
    draft.joint.name = name + '.' + part;
    draft.joint.type = type;
    draft.joint.at = at;
    draft.bodies = {std::move(first), std::move(second)};
    draft.origin = &origin;
    return joints.emplace_back(std::move(draft)).joint;
  }
};

/// A unit vector perpendicular to `axis` and to `rod`: the cross's other axis.
Vector3 cross_axis(const Vector3& axis, const Vector3& rod, const json& end, const Copy& copy) {
  const Vector3 other = axis.cross(rod);
  if (other.norm() < 1e-9)
    copy.reader.problems().add(end,
                               "the axis of this universal joint lies along the rod at home, "
                               "so its other axis is not determined");
  return other.normalized();
}

/// Appends the joint at one end of a rod or strut. The named axis is fixed in the
/// body that is not the rod: bodies[0] at the carriage, bodies[1] at the platform.
void append_end(Copy& copy, const std::string& part, const json& end, const Vector3& at,
                bool rod_comes_second, std::string first, std::string second) {
  const JointType type = joint_type(text(member(end, "joint"))).value_or(JointType::spherical);
  const Vector3 rod = *copy.compass.rod;
  Joint& joint = copy.append(part, type, at, end, std::move(first), std::move(second));
  if (type != JointType::spherical) {
    static const json kTangential = "tangential";
    const json& word = member(end, "axis");
    const Vector3 axis = copy.reader.direction(word.is_null() ? kTangential : word, copy.compass);
    joint.axes[0] = axis;
    if (type == JointType::universal) {
      const Vector3 other = cross_axis(axis, rod, end, copy);
      joint.axes = rod_comes_second ? std::array{axis, other} : std::array{other, axis};
    }
  }
  if (const json& cone = member(end, "cone"); !cone.is_null()) {
    joint.cone = copy.reader.angle(cone);
    joint.cone_axis = rod;
  }
}

/// Where on the guide the carriage stands so that its rod has its length: the
/// root s of |start + s direction − end| = rod, the larger one unless `near`.
/// NaN, and told, when the rod is too short to reach.
double carriage_position(const Vector3& start, const Vector3& direction, const Vector3& end,
                         double rod, bool near, const json& rods, const Copy& copy) {
  const Vector3 gap = start - end;
  const double along = direction.dot(gap);
  const double apart = (gap - along * direction).norm();
  const double rest = rod * rod - apart * apart;
  if (rest < 0) {
    const Units& units = copy.reader.units();
    copy.reader.problems().add(
        rods.is_object() && rods.contains("length") ? rods["length"] : rods,
        fmt::format("loop does not close at home: rod of {:.6g} {} cannot span the {:.6g} {} from "
                    "its platform joint to the guide",
                    rod / units.metres, units.length, apart / units.metres, units.length));
    return kNaN;
  }
  return -along + (near ? -1 : 1) * std::sqrt(rest);
}

/// The rod or rods that hang on a carriage or an arm at `from` (their common
/// middle), with the compass's rod set.
void append_rods(Copy& copy, const json& rods, const std::string& carrier, const Vector3& from,
                 const Vector3& to) {
  const Reader& reader = copy.reader;
  const auto append_rod = [&](const std::string& suffix, const Vector3& aside) {
    const std::string body = copy.name + ".rod" + suffix;
    append_end(copy, "top" + suffix, member(rods, "carriage"), from + aside, true, carrier, body);
    append_end(copy, "bottom" + suffix, member(rods, "platform"), to + aside, false, body,
               copy.between[1]);
  };
  if (text(member(rods, "form")) != "parallelogram") return append_rod("", Vector3::Zero());
  static const json kTangential = "tangential";
  const json& along = member(rods, "along");
  const Vector3 aside = reader.positive_length(member(rods, "spacing")) / 2 *
                        reader.direction(along.is_null() ? kTangential : along, copy.compass);
  append_rod("_a", -aside);
  append_rod("_b", aside);
}

void expand_guide(Copy& copy, const json& limb) {
  const Reader& reader = copy.reader;
  const json& guide = member(limb, "guide");
  const json& rods = member(limb, "rods");
  const json& top = member(rods, "carriage");
  const json& bottom = member(rods, "platform");

  const Vector3 through = reader.point(member(guide, "through"), copy.compass);
  const Vector3 direction = reader.direction(member(guide, "direction"), copy.compass);
  copy.compass.guide = direction;
  const Vector3 to_rod = reader.offset(member(top, "at"), copy.compass);
  const Vector3 platform = reader.point(member(bottom, "at"), copy.compass);
  const double rod = reader.positive_length(member(rods, "length"));
  const double home = carriage_position(through + to_rod, direction, platform, rod,
                                        text(member(guide, "side")) == "near", rods, copy);
  const Vector3 carriage = through + home * direction;
  copy.compass.rod = (platform - carriage - to_rod).normalized();

  const std::string slider = copy.name + ".carriage";
  Joint& slide =
      copy.append("guide", JointType::prismatic, carriage, guide, copy.between[0], slider);
  slide.axes[0] = direction;
  if (member(guide, "drive") != false) slide.driven = {0};
  if (const json& stroke = member(guide, "stroke"); !stroke.is_null()) {
    const Range limits = reader.interval(stroke, reader.units().metres);
    slide.range = {{limits.min - home, limits.max - home}};
  }
  if (const json& travel = member(guide, "travel"); !travel.is_null()) {
    const double limit = reader.positive_length(travel);
    if (!slide.range.empty())
      reader.problems().add(travel, "either the stroke or the travel of a guide can be given");
    slide.range = {{-limit, limit}};
  }

  append_rods(copy, rods, slider, carriage + to_rod, platform);
}

void expand_strut(Copy& copy, const json& strut) {
  const Reader& reader = copy.reader;
  const json& foot = member(strut, "base");
  const json& head = member(strut, "platform");
  const Vector3 from = reader.point(member(foot, "at"), copy.compass);
  const Vector3 to = reader.point(member(head, "at"), copy.compass);
  const double length = (to - from).norm();
  if (length < 1e-9) {
    reader.problems().add(strut, "the two ends of a strut must not be at the same point");
    return;
  }
  copy.compass.rod = unit_vector((to - from) / length);

  const std::string lower = copy.name + ".lower", upper = copy.name + ".upper";
  append_end(copy, "base", foot, from, true, copy.between[0], lower);
  Joint& slide = copy.append("strut", JointType::prismatic, from, strut, lower, upper);
  slide.axes[0] = *copy.compass.rod;
  if (member(strut, "drive") != false) slide.driven = {0};
  if (const json& stroke = member(strut, "stroke"); !stroke.is_null()) {
    const Range limits = reader.interval(stroke, reader.units().metres);
    slide.range = {{limits.min - length, limits.max - length}};
  }
  append_end(copy, "platform", head, to, false, upper, copy.between[1]);
}

void expand_chain(Copy& copy, const json& chain) {
  if (!chain.is_array()) return;  // told by the schema
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const auto link = [&](std::size_t n) {
      return n == 0              ? copy.between[0]
             : n == chain.size() ? copy.between[1]
                                 : fmt::format("{}.link{}", copy.name, n);
    };
    JointDraft draft = read_joint(chain[i], copy.reader, copy.compass);
    draft.joint.name = fmt::format("{}.{}", copy.name,
                                   text(member(chain[i], "name"), fmt::format("joint{}", i + 1)));
    draft.bodies = {link(i), link(i + 1)};
    copy.joints.push_back(std::move(draft));
  }
}

/// Where an arm of length `arm` about `axis` through `centre` ends so that its
/// rod reaches `end`: of the two places the one further out along the limb's
/// radial direction (the higher one where they are equally far), or the other one
/// with `near`. NaN, and told, when arm and rod do not reach.
Vector3 arm_end(const Vector3& centre, const Vector3& axis, double arm, const Vector3& end,
                double rod, bool near, const json& rods, const Copy& copy) {
  const Vector3 gap = end - centre;
  const Vector3 across = gap - axis.dot(gap) * axis;
  const double apart = across.norm();
  // |gap − arm e| = rod for a unit vector e across the axis: across · e = reach.
  const double reach = (arm * arm + gap.squaredNorm() - rod * rod) / (2 * arm);
  if (!(std::abs(reach) <= apart)) {
    if (std::isfinite(reach)) {
      const Units& units = copy.reader.units();
      copy.reader.problems().add(
          rods.is_object() && rods.contains("length") ? rods["length"] : rods,
          fmt::format("loop does not close at home: arm of {:.6g} {} and rod of {:.6g} {} cannot "
                      "span the {:.6g} {} from the crank to the platform joint",
                      arm / units.metres, units.length, rod / units.metres, units.length,
                      gap.norm() / units.metres, units.length));
    }
    return Vector3::Constant(kNaN);
  }
  const Vector3 toward = across / apart, aside = axis.cross(toward);
  const double cosine = reach / apart, sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double outward = aside.dot(copy.compass.rotation.col(0));
  const double rank = std::abs(outward) > 1e-9 ? outward : aside.z();
  const double side = (rank < 0) != near ? -1 : 1;
  return centre + arm * (cosine * toward + side * sine * aside);
}

void expand_crank(Copy& copy, const json& limb) {
  const Reader& reader = copy.reader;
  const json& crank = member(limb, "crank");
  const json& rods = member(limb, "rods");
  static const json kTangential = "tangential";
  const json& word = member(crank, "axis");
  const Vector3 axis = reader.direction(word.is_null() ? kTangential : word, copy.compass);
  const Vector3 centre = reader.point(member(crank, "at"), copy.compass);
  const Vector3 to_rod = reader.offset(member(member(rods, "carriage"), "at"), copy.compass);
  const Vector3 platform = reader.point(member(member(rods, "platform"), "at"), copy.compass);
  const double arm = reader.positive_length(member(crank, "length"));
  const double rod = reader.positive_length(member(rods, "length"));
  const Vector3 elbow = arm_end(centre, axis, arm, platform - to_rod, rod,
                                text(member(crank, "side")) == "near", rods, copy);
  copy.compass.rod = (platform - elbow - to_rod).normalized();

  const std::string body = copy.name + ".arm";
  Joint& turn = copy.append("crank", JointType::revolute, centre, crank, copy.between[0], body);
  turn.axes[0] = axis;
  if (member(crank, "drive") != false) turn.driven = {0};
  if (const json& range = member(crank, "range"); !range.is_null())
    turn.range = {reader.interval(range, reader.units().radians)};
  append_rods(copy, rods, body, elbow + to_rod, platform);
}

/// A body's name with the values of copy variables put in: "arm{k}" is "arm2" where k = 2.
std::string with_values(const std::string& name, const Scope& scope) {
  std::string result;
  for (std::size_t i = 0; i < name.size();) {
    const std::size_t close = name[i] == '{' ? name.find('}', i) : std::string::npos;
    const double* value =
        close == std::string::npos ? nullptr : scope.find(name.substr(i + 1, close - i - 1));
    if (value == nullptr) {
      result += name[i++];
      continue;
    }
    result += fmt::format("{:g}", *value);
    i = close + 1;
  }
  return result;
}

/// Turn about base z, without the rounding noise of cos 90°: tidy drawings.
Eigen::Matrix3d turned(double angle) {
  const auto tidy = [](double x) { return std::abs(x) < 1e-15 ? 0.0 : x; };
  const double c = tidy(std::cos(angle)), s = tidy(std::sin(angle));
  return (Eigen::Matrix3d() << c, -s, 0, s, c, 0, 0, 0, 1).finished();
}

/// Calls `visit(number)` for every combination of the listed values, which it
/// puts into the scope. The first variable (alphabetically) turns slowest.
template <typename Visit>
void for_each_copy(const json& copies, Scope& scope, Problems& problems, Visit visit) {
  if (!copies.is_object() || copies.empty()) return visit(0);
  std::vector<std::pair<std::string, const json*>> variables;
  std::size_t count = 1;
  for (const auto& [name, values] : copies.items()) {
    if (!values.is_array()) continue;  // told by the schema
    variables.emplace_back(name, &values);
    count = std::min(count * values.size(), kMostCopies + 1);
    scope.names.emplace_back(name, 0);
  }
  const std::size_t first = scope.names.size() - variables.size();
  if (count > kMostCopies) {
    problems.add(copies, fmt::format("a limb can have at most {} copies", kMostCopies));
    count = 0;
  }
  for (std::size_t number = 0; number < count; ++number) {
    std::size_t rest = number;
    for (std::size_t i = variables.size(); i-- > 0;) {
      const json& values = *variables[i].second;
      const json& value = values[rest % values.size()];
      scope.names[first + i].second = value.is_number() ? value.get<double>() : kNaN;
      rest /= values.size();
    }
    visit(number + 1);
  }
  scope.names.resize(first);
}

}  // namespace

void expand_limb(const json& limb, Scope& scope, const Units& units, Problems& problems,
                 const std::array<std::string, 2>& base_and_platform,
                 std::vector<JointDraft>& joints) {
  for_each_copy(member(limb, "copies"), scope, problems, [&](std::size_t number) {
    const Reader reader(problems, scope, units);
    const std::string name = text(member(limb, "name")) + (number ? std::to_string(number) : "");
    Copy copy{reader, {}, name, base_and_platform, joints};
    const json& between = member(limb, "between");
    if (between.is_array() && between.size() == 2)
      copy.between = {with_values(text(between[0]), scope), with_values(text(between[1]), scope)};
    const json& turn = member(limb, "turn");
    const double angle = turn.is_null() ? 0 : reader.angle(turn);
    copy.compass.origin = reader.offset(member(limb, "origin"), Compass{});
    copy.compass.rotation = turned(angle);

    if (limb.contains("guide")) expand_guide(copy, limb);
    if (limb.contains("crank")) expand_crank(copy, limb);
    if (limb.contains("strut")) expand_strut(copy, limb["strut"]);
    if (limb.contains("chain")) expand_chain(copy, limb["chain"]);
  });
}

}  // namespace polyglide
