#include "kinematics/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "kinematics/pose_table.hpp"
#include "kinematics/rank.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

/// Tenths of a micrometre are plenty for a drawing and keep files small.
double drawn(double value) {
  const double rounded = std::round(value * 1e7) / 1e7;
  return rounded == 0 ? 0 : rounded;
}

Json drawn_point(const Vector3& v) { return {drawn(v.x()), drawn(v.y()), drawn(v.z())}; }

void append_pose(Json& list, const Transform& body) {
  const Eigen::Quaterniond q(body.linear());
  for (double value : {q.w(), q.x(), q.y(), q.z()}) list.push_back(drawn(value));
  for (int i = 0; i < 3; ++i) list.push_back(drawn(body.translation()[i]));
}

const char* type_name(JointType type) {
  switch (type) {
    case JointType::revolute:
      return "revolute";
    case JointType::prismatic:
      return "prismatic";
    case JointType::helical:
      return "helical";
    case JointType::cylindrical:
      return "cylindrical";
    case JointType::universal:
      return "universal";
    case JointType::spherical:
      return "spherical";
    case JointType::planar:
      return "planar";
    case JointType::weld:
      return "weld";
  }
  return "";
}

/// A joint whose `at` is the same point of both bodies whatever the posture.
bool is_point(const Joint& joint) {
  return joint.type == JointType::revolute || joint.type == JointType::universal ||
         joint.type == JointType::spherical;
}

/// Decides which bodies a page must move and draws the rest between them.
class SceneWriter {
 public:
  explicit SceneWriter(const Machine& machine)
      : machine_(machine),
        model_(machine.model),
        mechanism_(machine.model.mechanism),
        joints_of_(mechanism_.bodies.size()),
        shown_(mechanism_.bodies.size(), -1),
        drawn_(mechanism_.bodies.size(), false) {
    for (int j = 0; j < static_cast<int>(mechanism_.joints.size()); ++j)
      for (int body : mechanism_.joints[j].bodies) joints_of_[body].push_back(j);
  }

  Json picture() {
    choose_bodies();
    draw();
    return {{"bodies", bodies_}, {"segments", segments_}};
  }

  Json scene(int nodes) {
    Json scene = picture();
    scene["joints"] = joints();
    scene["tool"] = drawn_point(mechanism_.tool);
    scene["platform"] = shown_[mechanism_.platform];
    add_table(scene, nodes);
    return scene;
  }

 private:
  int other_body(int joint, int body) const {
    const auto& bodies = mechanism_.joints[joint].bodies;
    return bodies[0] == body ? bodies[1] : bodies[0];
  }

  int drive_of(int joint) const {
    for (int d = 0; d < static_cast<int>(model_.drives.size()); ++d)
      if (model_.freedoms[model_.drives[d]].joint == joint) return d;
    return -1;
  }

  void show(int body, Json motion) {
    shown_[body] = static_cast<int>(bodies_.size());
    if (motion == "table") tables_.push_back(body);
    bodies_.push_back({{"name", mechanism_.bodies[body]}, {"motion", std::move(motion)}});
  }

  /// The joint by which a body slides, driven, on the base; -1 for none.
  int guide_of(int body) const {
    for (int j : joints_of_[body])
      if (mechanism_.joints[j].type == JointType::prismatic && drive_of(j) >= 0 &&
          other_body(j, body) == mechanism_.base)
        return j;
    return -1;
  }

  void choose_bodies() {
    show(mechanism_.base, "fixed");
    for (int b = 0; b < static_cast<int>(mechanism_.bodies.size()); ++b) {
      const int guide = b == mechanism_.base || b == mechanism_.platform ? -1 : guide_of(b);
      if (guide < 0) continue;
      const Joint& joint = mechanism_.joints[guide];
      const Vector3 axis =
          joint.bodies[0] == mechanism_.base ? joint.axes[0] : Vector3(-joint.axes[0]);
      show(b, {{"drive", drive_of(guide)}, {"direction", drawn_point(axis)}});
    }
    if (mechanism_.platform != mechanism_.base) show(mechanism_.platform, "table");
    // What is left is a rod or a telescope between shown bodies, or must be shown itself.
    for (int b = 0; b < static_cast<int>(mechanism_.bodies.size()); ++b) {
      if (shown_[b] >= 0 || drawn_[b]) continue;
      if (!draw_rod(b) && !draw_strut(b)) show(b, "table");
    }
  }

  void segment(const char* role, const std::string& name, int from, const Vector3& a, int to,
               const Vector3& b) {
    if ((a - b).norm() < 1e-7) return;
    segments_.push_back({{"role", role},
                         {"name", name},
                         {"from", {{"body", from}, {"at", drawn_point(a)}}},
                         {"to", {{"body", to}, {"at", drawn_point(b)}}}});
  }

  bool draw_rod(int body) {
    if (joints_of_[body].size() != 2) return false;
    std::array<int, 2> ends{};
    for (int i = 0; i < 2; ++i) {
      const int joint = joints_of_[body][i];
      ends[i] = shown_[other_body(joint, body)];
      if (!is_point(mechanism_.joints[joint]) || ends[i] < 0) return false;
    }
    const Joint& a = mechanism_.joints[joints_of_[body][0]];
    const Joint& b = mechanism_.joints[joints_of_[body][1]];
    const bool hinged = a.type == JointType::revolute && b.type == JointType::revolute;
    segment(hinged ? "link" : "rod", mechanism_.bodies[body], ends[0], a.at, ends[1], b.at);
    drawn_[body] = true;
    return true;
  }

  /// Two bodies that slide in one another, each with one more joint to a shown body.
  bool draw_strut(int body) {
    if (joints_of_[body].size() != 2) return false;
    for (int slide : joints_of_[body]) {
      const int partner = other_body(slide, body);
      if (mechanism_.joints[slide].type != JointType::prismatic || shown_[partner] >= 0 ||
          joints_of_[partner].size() != 2)
        continue;
      const auto end_of = [&](int half) {
        return joints_of_[half][0] == slide ? joints_of_[half][1] : joints_of_[half][0];
      };
      const int a = end_of(body), b = end_of(partner);
      const int from = shown_[other_body(a, body)], to = shown_[other_body(b, partner)];
      if (!is_point(mechanism_.joints[a]) || !is_point(mechanism_.joints[b]) || from < 0 || to < 0)
        continue;
      segment("strut", mechanism_.joints[slide].name, from, mechanism_.joints[a].at, to,
              mechanism_.joints[b].at);
      if (const int drive = drive_of(slide); drive >= 0) segments_.back()["drive"] = drive;
      drawn_[body] = drawn_[partner] = true;
      return true;
    }
    return false;
  }

  void draw() {
    for (int b = 0; b < static_cast<int>(mechanism_.bodies.size()); ++b) {
      if (shown_[b] < 0) continue;
      if (b == mechanism_.platform)
        draw_platform();
      else if (b == mechanism_.base)
        draw_base();
      else
        draw_body(b);
    }
  }

  /// Guides over their stroke, and a frame through the joints that stand on the base.
  void draw_base() {
    std::vector<Vector3> feet;
    for (int j : joints_of_[mechanism_.base]) {
      const Joint& joint = mechanism_.joints[j];
      if (is_point(joint)) feet.push_back(joint.at);
      if (joint.type != JointType::prismatic) continue;
      const Range range = drawing_range(model_, j, 0);
      segment("guide", joint.name, 0, joint.at + range.min * joint.axes[0], 0,
              joint.at + range.max * joint.axes[0]);
    }
    polygon("link", mechanism_.bodies[mechanism_.base], 0, feet);
  }

  void draw_platform() {
    const int body = shown_[mechanism_.platform];
    std::vector<Vector3> points;
    for (int j : joints_of_[mechanism_.platform]) points.push_back(mechanism_.joints[j].at);
    polygon("platform", mechanism_.bodies[mechanism_.platform], body, points);
    if (!points.empty()) segment("tool", "tool", body, centroid(points), body, mechanism_.tool);
  }

  /// A carriage or link: from its first joint to the others.
  void draw_body(int b) {
    const char* role = guide_of(b) >= 0 ? "carriage" : "link";
    const Vector3& hub = mechanism_.joints[joints_of_[b].front()].at;
    for (int j : joints_of_[b])
      segment(role, mechanism_.bodies[b], shown_[b], hub, shown_[b], mechanism_.joints[j].at);
  }

  static Vector3 centroid(const std::vector<Vector3>& points) {
    Vector3 sum = Vector3::Zero();
    for (const Vector3& point : points) sum += point;
    return sum / static_cast<double>(points.size());
  }

  /// The points joined in order round their centre.
  void polygon(const char* role, const std::string& name, int body, std::vector<Vector3> points) {
    if (points.size() < 2) return;
    const Vector3 centre = centroid(points);
    Eigen::Matrix3Xd spread(3, points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      spread.col(static_cast<Eigen::Index>(i)) = points[i] - centre;
    const Svd svd = svd_of(spread);
    const Vector3 u = svd.u.col(0), v = svd.u.col(1);
    const auto angle = [&](const Vector3& p) {
      return std::atan2((p - centre).dot(v), (p - centre).dot(u));
    };
    std::stable_sort(points.begin(), points.end(),
                     [&](const Vector3& a, const Vector3& b) { return angle(a) < angle(b); });
    const std::size_t edges = points.size() == 2 ? 1 : points.size();
    for (std::size_t i = 0; i < edges; ++i)
      segment(role, name, body, points[i], body, points[(i + 1) % points.size()]);
  }

  /// Every joint, held by a shown body; the slide inside a telescope has none.
  Json joints() const {
    Json list = Json::array();
    for (int j = 0; j < static_cast<int>(mechanism_.joints.size()); ++j) {
      const Joint& joint = mechanism_.joints[j];
      int holder = -1;
      for (int body : joint.bodies)
        if (shown_[body] > 0 || (shown_[body] == 0 && holder < 0)) holder = shown_[body];
      if (holder < 0) continue;
      Json axes = Json::array();
      if (joint.type != JointType::spherical && joint.type != JointType::weld)
        axes.push_back(drawn_point(joint.axes[0]));
      if (joint.type == JointType::universal) axes.push_back(drawn_point(joint.axes[1]));
      list.push_back({{"name", joint.name},
                      {"type", type_name(joint.type)},
                      {"body", holder},
                      {"at", drawn_point(joint.at)},
                      {"axes", std::move(axes)},
                      {"driven", !joint.driven.empty()}});
    }
    return list;
  }

  void add_table(Json& scene, int nodes) const {
    const PoseTable table = tabulate_poses(machine_, nodes);
    scene["drives"] = Json::array();
    for (std::size_t d = 0; d < model_.drives.size(); ++d) {
      const Freedom& freedom = model_.freedoms[model_.drives[d]];
      Json samples = Json::array();
      for (double sample : table.samples[d]) samples.push_back(drawn(sample));
      scene["drives"].push_back({{"name", mechanism_.joints[freedom.joint].name},
                                 {"kind", freedom.translational ? "prismatic" : "revolute"},
                                 {"unit", freedom.translational ? "m" : "rad"},
                                 {"samples", std::move(samples)},
                                 {"min", drawn(table.ranges[d].min)},
                                 {"max", drawn(table.ranges[d].max)}});
    }
    scene["poses"] = Json::array();
    for (const auto& bodies : table.bodies) {
      Json poses;
      if (bodies)
        for (int body : tables_) append_pose(poses, (*bodies)[body]);
      scene["poses"].push_back(std::move(poses));
    }
  }

  const Machine& machine_;
  const Model& model_;
  const Mechanism& mechanism_;
  std::vector<std::vector<int>> joints_of_;
  std::vector<int> shown_;   // index in `bodies` of the scene, -1 = not there
  std::vector<bool> drawn_;  // as a segment between shown bodies
  std::vector<int> tables_;
  Json bodies_ = Json::array(), segments_ = Json::array();
};

}  // namespace

nlohmann::ordered_json scene_of(const Machine& machine, int nodes) {
  if (nodes < 1) throw std::invalid_argument("scene_of: nodes must be at least 1");
  return SceneWriter(machine).scene(nodes);
}

nlohmann::ordered_json picture_of(const Machine& machine) { return SceneWriter(machine).picture(); }

void add_mode(nlohmann::ordered_json& scene, const FreedomMode& mode, const Mechanism& mechanism) {
  Json frames = Json::array();
  for (const std::vector<Transform>& bodies : mode.frames) {
    Json frame = Json::array();
    for (const Json& shown : scene.at("bodies")) {
      const auto name =
          std::find(mechanism.bodies.begin(), mechanism.bodies.end(), shown.at("name"));
      if (name == mechanism.bodies.end())
        throw std::invalid_argument("add_mode: the scene is of another mechanism");
      Json pose = Json::array();
      append_pose(pose, bodies.at(static_cast<std::size_t>(name - mechanism.bodies.begin())));
      frame.push_back(std::move(pose));
    }
    frames.push_back(std::move(frame));
  }
  scene["mode"] = {{"about", mode.about}, {"frames", std::move(frames)}};
}

}  // namespace polyglide
