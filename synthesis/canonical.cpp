#include "synthesis/canonical.hpp"

#include <fmt/format.h>
#include <nauty/nauty.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "catalog/json_file.hpp"

namespace polyglide {
namespace {

constexpr double kTolerance = 1e-6;  // of the machine's size, or radians

enum Part : std::int64_t { kBody, kJoint, kAxis, kRay, kGap, kHand };
using Colour = std::array<std::int64_t, 6>;  // part, then what distinguishes parts of a kind

// The shift keeps the round numbers of drawings away from the rounding
// boundaries, where noise in the last digit would split equal machines.
std::int64_t quantised(double value) {
  return std::llround(value / kTolerance + std::numbers::inv_pi);
}

// A graph with coloured vertices and its canonical text.
class ColouredGraph {
 public:
  int add(const Colour& colour) {
    colours_.push_back(colour);
    return static_cast<int>(colours_.size()) - 1;
  }
  void join(int a, int b) { edges_.emplace_back(a, b); }

  [[nodiscard]] CanonicalForm canonical() const;

 private:
  std::vector<Colour> colours_;
  std::vector<std::pair<int, int>> edges_;
};

CanonicalForm ColouredGraph::canonical() const {
  const int n = static_cast<int>(colours_.size());
  const int words = SETWORDSNEEDED(n);
  std::vector<graph> before(static_cast<std::size_t>(n) * words, 0), after(before.size(), 0);
  for (const auto& [a, b] : edges_) ADDONEEDGE(before.data(), a, b, words);

  std::vector<int> label(n), same_as_next(n), orbits(n);
  std::iota(label.begin(), label.end(), 0);
  std::stable_sort(label.begin(), label.end(),
                   [&](int a, int b) { return colours_[a] < colours_[b]; });
  for (int i = 0; i + 1 < n; ++i)
    same_as_next[i] = colours_[label[i]] == colours_[label[i + 1]] ? 1 : 0;

  DEFAULTOPTIONS_GRAPH(options);
  options.getcanon = TRUE;
  options.defaultptn = FALSE;
  statsblk stats;
  densenauty(before.data(), label.data(), same_as_next.data(), orbits.data(), &options, &stats,
             words, n, after.data());

  CanonicalForm form;
  form.symmetry = stats.grpsize1 * std::pow(10.0, stats.grpsize2);
  auto out = std::back_inserter(form.code);
  for (const int vertex : label) fmt::format_to(out, "{};", fmt::join(colours_[vertex], ","));
  for (int a = 0; a < n; ++a)
    for (int b = a; b < n; ++b)
      if (ISELEMENT(GRAPHROW(after.data(), a, words), b)) fmt::format_to(out, "{}-{};", a, b);
  // Said last, because the last letters of a text move content_hash the least.
  form.code += "polyglide/form/1";
  return form;
}

// A joint whose `at` is a point of the mechanism, not only of its drawing.
bool has_point(const Joint& joint) {
  return joint.type != JointType::prismatic && joint.type != JointType::weld;
}

// Where lengths are measured from, and in what.
struct Frame {
  Vector3 centre = Vector3::Zero();
  double size = 1;
};

Frame frame_of(const Mechanism& mechanism) {
  std::vector<Vector3> points;
  for (const Joint& joint : mechanism.joints)
    if (has_point(joint)) points.push_back(joint.at);
  if (points.empty()) return {mechanism.tool, 1.0};
  Frame frame;
  for (const Vector3& point : points) frame.centre += point / static_cast<double>(points.size());
  double square = 0;
  for (const Vector3& point : points) square += (point - frame.centre).squaredNorm();
  const double size = std::sqrt(square / static_cast<double>(points.size()));
  if (size > 0) frame.size = size;
  return frame;
}

// Draws a mechanism as a coloured graph.
class Diagram {
 public:
  explicit Diagram(const Mechanism& mechanism)
      : mechanism_(mechanism), frame_(frame_of(mechanism)) {
    graph_.add({kHand});
    graph_.add({kHand});
    add_bodies();
    for (const Joint& joint : mechanism_.joints) add_joint(joint);
    add_ring();
  }
  [[nodiscard]] const ColouredGraph& graph() const { return graph_; }

 private:
  struct Cylindrical {
    double height, radius;
    std::optional<double> azimuth;  ///< none on the vertical axis
  };
  static Cylindrical cylindrical(const Vector3& vector) {
    Cylindrical result{vector.z(), std::hypot(vector.x(), vector.y()), std::nullopt};
    if (result.radius > kTolerance) result.azimuth = std::atan2(vector.y(), vector.x());
    return result;
  }
  [[nodiscard]] Cylindrical place(const Vector3& point) const {
    return cylindrical((point - frame_.centre) / frame_.size);
  }
  void hang(int vertex, const Cylindrical& place) {
    if (place.azimuth) azimuths_.emplace_back(*place.azimuth, vertex);
  }

  // The first vertices: the two hands, alike but for what is joined to them, then the bodies.
  static constexpr int kClockwise = 0, kCounterclockwise = 1;
  static int vertex_of_body(int body) { return 2 + body; }

  void add_bodies();
  void add_joint(const Joint& joint);
  void add_axis(int joint_vertex, const Vector3& direction, bool driven, int body);
  void add_ring();

  const Mechanism& mechanism_;
  Frame frame_;
  ColouredGraph graph_;
  std::vector<std::pair<double, int>> azimuths_;  ///< and the vertices that have them
};

void Diagram::add_bodies() {
  for (int body = 0; body < static_cast<int>(mechanism_.bodies.size()); ++body) {
    Colour colour{kBody, body == mechanism_.base, body == mechanism_.platform};
    const Cylindrical tool = place(mechanism_.tool);
    if (body == mechanism_.platform) {
      colour[3] = quantised(tool.height);
      colour[4] = quantised(tool.radius);
    }
    // All lengths are relative; the size itself is told once, by the base.
    if (body == mechanism_.base) colour[5] = quantised(std::log(frame_.size));
    graph_.add(colour);
    if (body == mechanism_.platform) hang(vertex_of_body(body), tool);
  }
}

void Diagram::add_joint(const Joint& joint) {
  Colour colour{kJoint, static_cast<std::int64_t>(joint.type)};
  const bool by_axis = joint.type == JointType::universal || joint.type == JointType::spherical;
  for (const int freedom : joint.driven)
    if (!by_axis) colour[2] |= std::int64_t{1} << freedom;
  const Cylindrical at = place(joint.at);
  if (has_point(joint)) {
    colour[3] = quantised(at.height);
    colour[4] = quantised(at.radius);
  }
  if (joint.type == JointType::helical) colour[5] = quantised(std::abs(joint.pitch) / frame_.size);
  const int vertex = graph_.add(colour);
  if (has_point(joint)) hang(vertex, at);
  for (const int body : joint.bodies) graph_.join(vertex, vertex_of_body(body));
  if (joint.type == JointType::helical)
    graph_.join(vertex, joint.pitch > 0 ? kCounterclockwise : kClockwise);

  const auto driven = [&](int freedom) { return std::ranges::count(joint.driven, freedom) > 0; };
  if (joint.type == JointType::universal) {
    for (int k = 0; k < 2; ++k) add_axis(vertex, joint.axes[k], driven(k), joint.bodies[k]);
  } else if (joint.type == JointType::spherical) {
    // Undriven, a ball has no directions; its driven freedoms turn about x, y, z.
    for (int k = 0; k < 3; ++k)
      if (driven(k)) add_axis(vertex, Vector3::Unit(k), true, joint.bodies[0]);
  } else if (joint.type != JointType::weld) {
    add_axis(vertex, joint.axes[0], false, -1);
  }
}

// An axis is a line: it hangs on the azimuth of its upper half, on both when it
// lies level, on none when it is upright.
void Diagram::add_axis(int joint_vertex, const Vector3& direction, bool driven, int body) {
  const double rise = std::abs(direction.z());
  const int vertex = graph_.add({kAxis, driven, quantised(rise)});
  graph_.join(vertex, joint_vertex);
  if (body >= 0) graph_.join(vertex, vertex_of_body(body));
  for (const Vector3& half : {direction, Vector3(-direction)})
    if (rise <= kTolerance || half.z() > 0) hang(vertex, cylindrical(half));
}

// The ring of azimuths. Between neighbours stand two vertices, the first joined
// to "counterclockwise" and the second to "clockwise", so that left and right
// can be told apart where something (a screw thread) depends on them.
void Diagram::add_ring() {
  if (azimuths_.empty()) return;
  std::sort(azimuths_.begin(), azimuths_.end());
  constexpr double kTurn = 2 * std::numbers::pi;
  // Start after a gap, so that no azimuth is cut in two where the angle jumps by 2π.
  std::size_t start = 0;
  for (std::size_t i = 1; i < azimuths_.size() && start == 0; ++i)
    if (azimuths_[i].first - azimuths_[i - 1].first > kTolerance) start = i;
  for (std::size_t i = 0; i < start; ++i) azimuths_[i].first += kTurn;
  std::rotate(azimuths_.begin(), azimuths_.begin() + static_cast<std::ptrdiff_t>(start),
              azimuths_.end());

  std::vector<std::pair<double, int>> rays;
  double last = -kTurn;
  for (const auto& [azimuth, vertex] : azimuths_) {
    if (azimuth - last > kTolerance) rays.emplace_back(azimuth, graph_.add({kRay}));
    graph_.join(vertex, rays.back().second);
    last = azimuth;
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool closing = i + 1 == rays.size();
    const auto& next = rays[closing ? 0 : i + 1];
    const double gap = next.first + (closing ? kTurn : 0.0) - rays[i].first;
    const int first = graph_.add({kGap, quantised(gap)});
    const int second = graph_.add({kGap, quantised(gap)});
    graph_.join(rays[i].second, first);
    graph_.join(first, second);
    graph_.join(second, next.second);
    graph_.join(first, kCounterclockwise);
    graph_.join(second, kClockwise);
  }
}

}  // namespace

CanonicalForm canonical_form(const Mechanism& mechanism) {
  return Diagram(mechanism).graph().canonical();
}

std::string short_id(const CanonicalForm& form) { return content_hash(form.code).substr(0, 12); }

}  // namespace polyglide
