#include "catalog/write_mjcf.hpp"

#include <cmath>
#include <numbers>

#include "catalog/engine_tree.hpp"
#include "catalog/xml.hpp"

namespace polyglide {
namespace {

constexpr double kBandwidth = 2 * std::numbers::pi * 10;  // of the position drives [rad/s]

class MjcfWriter {
 public:
  explicit MjcfWriter(const Mechanism& mechanism)
      : mechanism_(mechanism),
        tree_(engine_tree(mechanism)),
        figures_(stick_figures(mechanism, tree_)),
        radius_(bar_radius(mechanism)),
        density_(bar_density(mechanism)) {
    (void)body_names_.take("world");  // what MuJoCo calls the space around
    for (const EngineLink& link : tree_.links)
      names_.push_back(body_names_.take(link.body >= 0
                                            ? mechanism.bodies[link.body]
                                            : mechanism.joints[link.joint].name + ".cut"));
  }

  std::string write() {
    XmlElement root{"mujoco", {{"model", mechanism_.name}}, {}};
    // Loops couple light links stiffly: small steps, and an integrator that damps.
    root.add("compiler")
        .set("angle", "radian")
        .set("boundmass", "1e-6")
        .set("boundinertia", "1e-9");
    root.add("option").set("timestep", "0.0005").set("integrator", "implicit");
    root.add("size").set("njmax", xml_number(row_bound())).set("nconmax", "1");
    add_defaults(root.add("default"));
    XmlElement world = body(0);
    root.add("worldbody").children.push_back(std::move(world));
    if (!equalities_.children.empty() || !tree_.closures.empty()) {
      add_closures();
      root.children.push_back(std::move(equalities_));
    }
    if (!actuators_.children.empty()) root.children.push_back(std::move(actuators_));
    return to_text(root, mechanism_.title.empty() ? mechanism_.name : mechanism_.title);
  }

 private:
  /// Enough constraint rows for all equalities and limits at once.
  double row_bound() const {
    std::size_t rows = 6 * tree_.closures.size();
    for (const EngineLink& link : tree_.links) rows += 3 * link.motions.size();
    return static_cast<double>(rows + 1);
  }

  void add_defaults(XmlElement& defaults) const {
    defaults.add("geom")
        .set("type", "capsule")
        .set("size", xml_number(radius_))
        .set("density", xml_number(density_))
        .set("contype", "0")
        .set("conaffinity", "0")
        .set("rgba", "0.6 0.65 0.7 1");
    defaults.add("site").set("size", xml_number(2 * radius_)).set("rgba", "0.9 0.3 0.1 1");
    defaults.add("equality").set("solref", "0.002 1").set("solimp", "0.99 0.9999 0.001");
  }

  XmlElement body(int index) {
    const EngineLink& link = tree_.links[index];
    const Vector3 from = link.parent < 0 ? Vector3::Zero() : tree_.links[link.parent].origin;
    XmlElement element{"body", {}, {}};
    element.set("name", names_[index]).set("pos", xml_vector(link.origin - from));
    if (link.joint >= 0) add_joints(element, link);
    add_shape(element, index);
    for (std::size_t child = 0; child < tree_.links.size(); ++child)
      if (tree_.links[child].parent == index)
        element.children.push_back(body(static_cast<int>(child)));
    return element;
  }

  void add_joints(XmlElement& element, const EngineLink& link) {
    const Joint& joint = mechanism_.joints[link.joint];
    if (joint.type == JointType::spherical) {
      const std::string name = joint_names_.take(joint.name);
      element.add("joint").set("name", name).set("type", "ball");
      for (const EngineMotion& motion : link.motions)
        if (motion.driven) drive(name, motion, xml_vector(motion.motion.axis));
      return;
    }
    for (const EngineMotion& motion : link.motions) {
      const std::string name = joint_names_.take(freedom_name(joint, motion.freedom));
      add_joint(element, name, motion);
      if (motion.motion.pitch != 0) add_advance(element, name, motion.motion);
      if (motion.driven) drive(name, motion);
    }
  }

  void add_joint(XmlElement& element, const std::string& name, const EngineMotion& motion) const {
    XmlElement& joint = element.add("joint");
    joint.set("name", name)
        .set("type", motion.motion.translation ? "slide" : "hinge")
        .set("axis", xml_vector(motion.motion.axis));
    if (motion.driven) joint.set("damping", xml_number(2 * moved(motion) * kBandwidth));
    const Range& range = motion.range;
    if (!(range.min < range.max) || (std::isinf(range.min) && std::isinf(range.max))) return;
    joint.set("limited", "true").set("range", bound(range.min) + ' ' + bound(range.max));
  }

  /// MuJoCo's limits have two sides.
  static std::string bound(double limit) {
    return xml_number(std::isinf(limit) ? std::copysign(1e6, limit) : limit);
  }

  /// A helical joint's advance: a slide that follows the hinge.
  void add_advance(XmlElement& element, const std::string& hinge, const ElementaryMotion& motion) {
    const std::string slide = joint_names_.take(hinge + ".advance");
    element.add("joint")
        .set("name", slide)
        .set("type", "slide")
        .set("axis", xml_vector(motion.axis));
    equalities_.add("joint")
        .set("joint1", slide)
        .set("joint2", hinge)
        .set("polycoef", "0 " + xml_number(motion.pitch) + " 0 0 0");
  }

  /// Bars as capsules; a ball where there are none. A cut joint's outer half is only weight.
  void add_shape(XmlElement& element, int index) const {
    const EngineLink& link = tree_.links[index];
    if (link.body < 0) {
      element.add("inertial")
          .set("pos", "0 0 0")
          .set("mass", xml_number(density_ * std::pow(radius_, 3)))
          .set("diaginertia", xml_vector(Vector3::Constant(density_ * std::pow(radius_, 5))));
      return;
    }
    for (const Vector3& end : figures_[index].ends)
      element.add("geom").set("fromto", "0 0 0 " + xml_vector(end));
    if (figures_[index].ends.empty() && link.body != mechanism_.base)
      element.add("geom").set("type", "sphere").set("size", xml_number(1.5 * radius_));
    if (link.body == mechanism_.platform)
      element.add("site").set("name", "tool").set("pos", xml_vector(mechanism_.tool - link.origin));
  }

  void add_closures() {
    for (const EngineClosure& closure : tree_.closures) {
      XmlElement& tie = equalities_.add(closure.rigid ? "weld" : "connect");
      tie.set("name", equality_names_.take(closure.name))
          .set("body1", names_[closure.first])
          .set("body2", names_[closure.second]);
      if (!closure.rigid)
        tie.set("anchor", xml_vector(closure.at - tree_.links[closure.first].origin));
    }
  }

  /// What a drive has to move, guessed high: bars as long as half the machine [kg or kg m²].
  double moved(const EngineMotion& motion) const {
    const double length = 50 * radius_;
    const double mass = density_ * std::numbers::pi * radius_ * radius_ * length *
                        static_cast<double>(tree_.links.size());
    return motion.motion.translation ? mass : mass * length * length;
  }

  void drive(const std::string& joint, const EngineMotion& motion, const std::string& gear = "") {
    XmlElement& actuator = actuators_.add("position");
    actuator.set("name", actuator_names_.take(joint))
        .set("joint", joint)
        .set("kp", xml_number(moved(motion) * kBandwidth * kBandwidth));
    if (!gear.empty()) actuator.set("gear", gear + " 0 0 0");
  }

  const Mechanism& mechanism_;
  EngineTree tree_;
  std::vector<StickFigure> figures_;
  double radius_, density_;  ///< of the bars
  UniqueNames body_names_, joint_names_, equality_names_, actuator_names_;
  std::vector<std::string> names_;  ///< per link
  XmlElement equalities_{"equality", {}, {}}, actuators_{"actuator", {}, {}};
};

}  // namespace

std::string to_mjcf(const Mechanism& mechanism) { return MjcfWriter(mechanism).write(); }

}  // namespace polyglide
