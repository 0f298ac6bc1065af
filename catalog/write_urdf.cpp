#include "catalog/write_urdf.hpp"

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "catalog/engine_tree.hpp"
#include "catalog/xml.hpp"

namespace polyglide {
namespace {

constexpr double kUnlimited = 1e6;  // URDF wants numbers for every prismatic joint

/// 'a', with quotes doubled: YAML's plainest string.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (char c : text) result += c == '\'' ? "''" : std::string(1, c);
  return result + "'";
}

std::string yaml_list(const std::vector<std::string>& items) {
  std::string list;
  for (const std::string& item : items) list += (list.empty() ? "" : ", ") + item;
  return "[" + list + "]";
}

class UrdfWriter {
 public:
  explicit UrdfWriter(const Mechanism& mechanism)
      : mechanism_(mechanism),
        tree_(engine_tree(mechanism)),
        figures_(stick_figures(mechanism, tree_)),
        radius_(bar_radius(mechanism)),
        density_(bar_density(mechanism)) {
    root_.set("name", mechanism.name);
    // Links first, so that bodies keep their names. Readers keep links and joints in one
    // list of frames, so no name may serve twice.
    for (const EngineLink& link : tree_.links)
      names_.push_back(unique_.take(link.body >= 0 ? mechanism.bodies[link.body]
                                                   : mechanism.joints[link.joint].name + ".cut"));
  }

  UrdfFiles write() {
    for (std::size_t i = 0; i < tree_.links.size(); ++i) add_link(static_cast<int>(i));
    for (const EngineClosure& closure : tree_.closures) add_closure(closure);
    const std::string about = mechanism_.title.empty() ? mechanism_.name : mechanism_.title;
    return {to_text(root_, about), loops()};
  }

 private:
  void add_link(int index) {
    const EngineLink& link = tree_.links[index];
    if (link.joint >= 0) hang(index);
    XmlElement& element = root_.add("link").set("name", names_[index]);
    if (link.body == mechanism_.base) return;
    const std::vector<Vector3>& ends = figures_[index].ends;
    add_inertia(element, ends);
    for (const Vector3& end : ends) add_bar(element, end);
  }

  /// The joint, or chain of joints, from the inner link to this one.
  void hang(int index) {
    const EngineLink& link = tree_.links[index];
    const Joint& joint = mechanism_.joints[link.joint];
    const Vector3 from = tree_.links[link.parent].origin;
    Step step{names_[link.parent], link.origin - from};
    if (link.motions.empty()) {
      add_fixed(unique_.take(joint.name), step, names_[index]);
      return;
    }
    for (const EngineMotion& motion : link.motions) {
      const bool last = &motion == &link.motions.back();
      const bool advances = motion.motion.pitch != 0;
      const std::string name = unique_.take(freedom_name(joint, motion.freedom));
      if (motion.driven) drives_.push_back(quoted(name));
      step = turn_or_shift(name, step, motion, last && !advances ? names_[index] : "");
      if (!advances) continue;
      EngineMotion advance{motion.freedom, {true, motion.motion.axis, 0}, {}, false};
      step = turn_or_shift(unique_.take(name + ".advance"), step, advance, names_[index], name,
                           motion.motion.pitch);
    }
  }

  /// The place that the next joint starts from.
  struct Step {
    std::string link;
    Vector3 offset;  ///< of the joint from the link's origin [m]
  };

  /// One joint and, unless it leads to `child`, the light link behind it.
  Step turn_or_shift(const std::string& name, const Step& from, const EngineMotion& motion,
                     std::string child, const std::string& mimic = "", double multiplier = 0) {
    if (child.empty()) {
      child = unique_.take(name + ".link");
      add_inertia(root_.add("link").set("name", child), {});
    }
    const Range& range = motion.range;
    const bool limited = std::isfinite(range.min) || std::isfinite(range.max);
    const std::string kind = motion.motion.translation ? "prismatic"
                             : limited                 ? "revolute"
                                                       : "continuous";
    XmlElement& joint = add_joint(name, kind, from, child);
    joint.add("axis").set("xyz", xml_vector(motion.motion.axis));
    XmlElement& limit = joint.add("limit");
    if (kind != "continuous")
      limit.set("lower", xml_number(std::max(range.min, -kUnlimited)))
          .set("upper", xml_number(std::min(range.max, kUnlimited)));
    limit.set("effort", xml_number(kUnlimited)).set("velocity", xml_number(kUnlimited));
    if (!mimic.empty())
      joint.add("mimic").set("joint", mimic).set("multiplier", xml_number(multiplier));
    return {child, Vector3::Zero()};
  }

  void add_fixed(const std::string& name, const Step& from, const std::string& child) {
    add_joint(name, "fixed", from, child);
  }

  XmlElement& add_joint(const std::string& name, const std::string& kind, const Step& from,
                        const std::string& child) {
    XmlElement& joint = root_.add("joint").set("name", name).set("type", kind);
    joint.add("parent").set("link", from.link);
    joint.add("child").set("link", child);
    joint.add("origin").set("xyz", xml_vector(from.offset)).set("rpy", "0 0 0");
    return joint;
  }

  /// Two links without mass whose frames coincide at home mark where the loop is closed.
  void add_closure(const EngineClosure& closure) {
    const std::string number = std::to_string(closed_.size() + 1);
    std::vector<std::string> pair;
    for (const auto& [link, side] : {std::pair(closure.first, "_A"), {closure.second, "_B"}}) {
      const std::string frame = unique_.take("closedloop" + number + side);
      root_.add("link").set("name", frame);
      add_fixed(unique_.take(frame + "_fixed"),
                {names_[link], closure.at - tree_.links[link].origin}, frame);
      pair.push_back(quoted(frame));
    }
    closed_.push_back(yaml_list(pair));
    types_.push_back(closure.rigid ? "'6d'" : "'3d'");
  }

  std::string loops() const {
    return "closed_loop: " + yaml_list(closed_) + "\ntype: " + yaml_list(types_) +
           "\nname_mot: " + yaml_list(drives_) + "\njoint_name: []\njoint_type: []\n";
  }

  /// A bar is a sixth of its mass at either end and the rest in its middle (Simpson's rule,
  /// exact for a thin rod); a ball at the joint keeps the inertia positive.
  void add_inertia(XmlElement& link, const std::vector<Vector3>& ends) const {
    const double section = density_ * std::numbers::pi * radius_ * radius_;
    double mass = section * radius_;
    Vector3 first = Vector3::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    for (const Vector3& end : ends) {
      const double bar = section * end.norm();
      mass += bar;
      first += bar / 2 * end;
      second += bar / 3 * end * end.transpose();
    }
    const Vector3 centre = first / mass;
    second -= mass * centre * centre.transpose();
    const double ball = 0.4 * section * radius_ * radius_ * radius_;
    const Eigen::Matrix3d inertia = (second.trace() + ball) * Eigen::Matrix3d::Identity() - second;
    XmlElement& inertial = link.add("inertial");
    inertial.add("origin").set("xyz", xml_vector(centre)).set("rpy", "0 0 0");
    inertial.add("mass").set("value", xml_number(mass));
    inertial.add("inertia")
        .set("ixx", xml_number(inertia(0, 0)))
        .set("ixy", xml_number(inertia(0, 1)))
        .set("ixz", xml_number(inertia(0, 2)))
        .set("iyy", xml_number(inertia(1, 1)))
        .set("iyz", xml_number(inertia(1, 2)))
        .set("izz", xml_number(inertia(2, 2)));
  }

  /// A cylinder from the link's origin to `end`; URDF's stand along z.
  void add_bar(XmlElement& link, const Vector3& end) const {
    const double tilt = std::atan2(std::hypot(end.x(), end.y()), end.z());
    const double heading = std::atan2(end.y(), end.x());
    XmlElement& visual = link.add("visual");
    visual.add("origin").set("xyz", xml_vector(end / 2)).set("rpy", xml_vector({0, tilt, heading}));
    visual.add("geometry")
        .add("cylinder")
        .set("radius", xml_number(radius_))
        .set("length", xml_number(end.norm()));
  }

  const Mechanism& mechanism_;
  EngineTree tree_;
  std::vector<StickFigure> figures_;
  double radius_, density_;  ///< of the bars
  UniqueNames unique_;
  std::vector<std::string> names_;  ///< per link
  XmlElement root_{"robot", {}, {}};
  std::vector<std::string> closed_, types_, drives_;  ///< the YAML's lists
};

}  // namespace

UrdfFiles to_urdf(const Mechanism& mechanism) { return UrdfWriter(mechanism).write(); }

}  // namespace polyglide
