#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "catalog/draft.hpp"
#include "catalog/mesh.hpp"
#include "catalog/shape_words.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

constexpr double kFlat = 1e-6;  // of a plate's size: corners farther from its plane are out of it

/// What the word of a shape may mean: a body, or a slide.
struct Bearer {
  std::string name;
  int body = -1, slide = -1;  // one of them
};

std::vector<Bearer> bearers(const Mechanism& mechanism) {
  std::vector<Bearer> result;
  for (std::size_t i = 0; i < mechanism.bodies.size(); ++i)
    result.push_back({mechanism.bodies[i], static_cast<int>(i), -1});
  for (std::size_t i = 0; i < mechanism.joints.size(); ++i)
    if (mechanism.joints[i].type == JointType::prismatic)
      result.push_back({mechanism.joints[i].name, -1, static_cast<int>(i)});
  return result;
}

/// A part of the machine and what can be said of it: direction and plane of a set of points.
struct Spread {
  double size = 0;  ///< distance of the first point from the farthest
  Vector3 along = Vector3::Zero(), normal = Vector3::Zero();  ///< zero where there is none
};

Spread spread_of(const std::vector<Vector3>& points) {
  Spread spread;
  for (const Vector3& point : points) {
    const Vector3 way = point - points.front();
    if (way.norm() <= spread.size) continue;
    spread.size = way.norm();
    spread.along = way / spread.size;
  }
  double width = kFlat * spread.size;
  for (const Vector3& point : points) {
    const Vector3 across = spread.along.cross(point - points.front());
    if (across.norm() <= width) continue;
    width = across.norm();
    spread.normal = across / width;
  }
  return spread;
}

/// The corners of the convex hull of points in one plane, in order around it (Andrew's chain).
std::vector<Vector3> hull(std::vector<Vector3> points, const Spread& spread) {
  const Vector3 u = spread.along, v = spread.normal.cross(u);
  std::ranges::sort(points, [&](const Vector3& a, const Vector3& b) {
    return a.dot(u) != b.dot(u) ? a.dot(u) < b.dot(u) : a.dot(v) < b.dot(v);
  });
  const auto turns_left = [&](const Vector3& a, const Vector3& b, const Vector3& c) {
    return spread.normal.dot((b - a).cross(c - b)) > 0;
  };
  std::vector<Vector3> chain;
  for (int half = 0; half < 2; ++half) {
    const std::size_t start = chain.size();
    for (const Vector3& point : points) {
      while (chain.size() >= start + 2 && !turns_left(chain[chain.size() - 2], chain.back(), point))
        chain.pop_back();
      chain.push_back(point);
    }
    chain.pop_back();
    std::ranges::reverse(points);
  }
  return chain;
}

/// One entry of `shapes` being read.
class ShapeReader {
 public:
  ShapeReader(const json& value, const Reader& reader, Mechanism& mechanism,
              const std::filesystem::path& folder)
      : value_(value), reader_(reader), mechanism_(mechanism), folder_(folder) {}

  void read() {
    const json& of = member(value_, "of");
    const auto all = bearers(mechanism_);
    std::vector<Bearer> meant;
    std::ranges::copy_if(all, std::back_inserter(meant),
                         [&](const Bearer& bearer) { return means(text(of), bearer.name); });
    if (meant.empty()) return tell_nearest(of, all);
    for (const char* word : {"points", "mesh"})
      if (meant.size() > 1 && value_.contains(word)) {
        problem(value_[word], fmt::format("can be given for one body only, and \"{}\" means {}",
                                          text(of), meant.size()));
        return;
      }
    const json& diameter = member(value_, "diameter");
    const double width = diameter.is_null() ? 0 : reader_.length(diameter);
    if (width < 0) problem(diameter, "a diameter must not be negative");
    for (const Bearer& bearer : meant) {
      BodyShape shape;
      shape.name = bearer.name;
      shape.radius = width / 2;
      if (value_.contains("mesh") ? read_surface(bearer, shape) : read_points(bearer, shape))
        mechanism_.shapes.push_back(std::move(shape));
    }
  }

 private:
  void problem(const json& at, const std::string& rule, const std::string& hint = "") {
    reader_.problems().add(at.is_null() ? value_ : at, rule, hint);
  }

  void tell_nearest(const json& of, const std::vector<Bearer>& all) {
    std::vector<std::string> names;
    for (const Bearer& bearer : all) names.push_back(bearer.name);
    problem(of, "must mean a body or a slide of this machine", did_you_mean(text(of), names));
  }

  bool read_surface(const Bearer& bearer, BodyShape& shape) {
    const json& name = value_["mesh"];
    for (const char* word : {"points", "form", "trim"})
      if (value_.contains(word)) problem(value_[word], "has no meaning beside a mesh");
    if (bearer.body < 0) {
      problem(name, "a mesh is carried by a body, and \"" + bearer.name + "\" is a slide");
      return false;
    }
    shape.form = BodyShape::Form::mesh;
    shape.body = bearer.body;
    shape.mesh_file = std::filesystem::absolute(folder_ / text(name)).lexically_normal().string();
    const json& turn = member(value_, "turn");
    if (!turn.is_null()) shape.mesh_turn = reader_.angle(turn);
    shape.mesh_at = reader_.offset(member(value_, "at"), Compass{});
    std::string error;
    const auto mesh = read_mesh(shape.mesh_file, error);
    if (!mesh) {
      problem(name, error);
      return false;
    }
    if (!shape.mesh_at.allFinite() || !std::isfinite(shape.mesh_turn)) return false;
    shape.mesh = std::make_shared<const Mesh>(
        placed(*mesh, reader_.units().metres, shape.mesh_turn, shape.mesh_at));
    return true;
  }

  bool read_points(const Bearer& bearer, BodyShape& shape) {
    for (const char* word : {"at", "turn"})
      if (value_.contains(word)) problem(value_[word], "has a meaning for meshes only");
    std::vector<Vector3> written;
    for (const json& point : member(value_, "points"))
      written.push_back(reader_.point(point, Compass{}));
    if (std::ranges::any_of(written, [](const Vector3& p) { return !p.allFinite(); })) return false;
    if (bearer.slide >= 0) return read_slide(bearer, written, shape);
    if (written.empty()) written = joint_points(mechanism_, bearer.body);
    if (written.empty()) {
      problem(member(value_, "of"), fmt::format("\"{}\" has no joint whose place is a point of it: "
                                                "give \"points\"",
                                                bearer.name));
      return false;
    }
    if (!form(shape, written)) return false;
    for (const Vector3& point : written) shape.points.push_back({bearer.body, point});
    return trim(shape);
  }

  /// Line or plate, as written or as the points lie; leaves the corners in `points`.
  bool form(BodyShape& shape, std::vector<Vector3>& points) {
    const Spread spread = spread_of(points);
    const json& word = member(value_, "form");
    const bool plate = word.is_null() ? !spread.normal.isZero() : word == "plate";
    if (plate && spread.normal.isZero()) {
      problem(word, "the corners of a plate must not lie on one line");
      return false;
    }
    if (!plate && !spread.normal.isZero()) {
      problem(word, "the points of a line must lie on one line; \"plate\" is their flat hull");
      return false;
    }
    shape.form = plate ? BodyShape::Form::plate : BodyShape::Form::line;
    if (plate) {
      const double most = kFlat * spread.size;
      if (std::ranges::any_of(points, [&](const Vector3& point) {
            return std::abs(spread.normal.dot(point - points.front())) > most;
          })) {
        problem(member(value_, "points"), fmt::format("the corners of the plate \"{}\" must lie in "
                                                      "one plane; give points that do, or a mesh",
                                                      shape.name));
        return false;
      }
      points = hull(points, spread);
    } else if (points.size() > 2) {
      const auto [first, last] = std::ranges::minmax_element(
          points, {}, [&](const Vector3& point) { return spread.along.dot(point); });
      points = {*first, *last};
    }
    return true;
  }

  bool read_slide(const Bearer& bearer, const std::vector<Vector3>& written, BodyShape& shape) {
    if (!written.empty() && written.size() != 2) {
      problem(value_["points"], "a rail or a telescope has two points, its ends");
      return false;
    }
    if (member(value_, "form") == "plate") {
      problem(value_["form"], "a rail or a telescope is a line");
      return false;
    }
    if (!telescope(bearer.slide, shape) && !rail(bearer.slide, written, shape)) return false;
    for (std::size_t i = 0; i < written.size(); ++i) shape.points[i].at = written[i];
    return trim(shape);
  }

  /// The joint that a body of two joints has beside its slide, -1 where there is none.
  int other_joint(int body, int slide) const {
    int other = -1, count = 0;
    for (int j = 0; j < static_cast<int>(mechanism_.joints.size()); ++j) {
      const Joint& joint = mechanism_.joints[j];
      if (joint.bodies[0] != body && joint.bodies[1] != body) continue;
      ++count;
      if (j != slide) other = j;
    }
    const bool fits = count == 2 && other >= 0 &&
                      mechanism_.joints[other].type != JointType::prismatic &&
                      body != mechanism_.base && body != mechanism_.platform;
    return fits ? other : -1;
  }

  /// A slide between two bodies with one more joint each: a line from the one joint to the other.
  bool telescope(int slide, BodyShape& shape) const {
    const auto& bodies = mechanism_.joints[slide].bodies;
    const int first = other_joint(bodies[0], slide), last = other_joint(bodies[1], slide);
    if (first < 0 || last < 0) return false;
    shape.points = {{bodies[0], mechanism_.joints[first].at},
                    {bodies[1], mechanism_.joints[last].at}};
    return true;
  }

  /// Any other slide: the way of its point, fixed in the body that guides it.
  bool rail(int slide, const std::vector<Vector3>& written, BodyShape& shape) {
    const Joint& joint = mechanism_.joints[slide];
    const bool backward = joint.bodies[1] == mechanism_.base;
    const int guiding = joint.bodies[backward ? 1 : 0];
    shape.rail = slide;
    Range range{0, 0};
    if (!joint.range.empty()) range = joint.range.front();
    if (written.empty() &&
        !(std::isfinite(range.min) && std::isfinite(range.max) && range.min < range.max)) {
      problem(member(value_, "of"),
              fmt::format("the slide \"{}\" has no stroke that would tell how "
                          "long its rail is: give \"points\"",
                          shape.name));
      return false;
    }
    for (const double q : {range.min, range.max})
      shape.points.push_back({guiding, joint.at + (backward ? -q : q) * joint.axes[0]});
    return true;
  }

  /// Takes off both ends of a line what belongs to its joints.
  bool trim(BodyShape& shape) {
    const json& word = member(value_, "trim");
    if (word.is_null()) return true;
    const double off = reader_.length(word);
    if (shape.form != BodyShape::Form::line || shape.points.size() != 2) {
      problem(word, "only lines have ends that can be trimmed");
      return false;
    }
    Vector3 &first = shape.points[0].at, &last = shape.points[1].at;
    const Vector3 way = last - first;
    if (off < 0 || 2 * off >= way.norm()) {
      problem(word, fmt::format("must be from 0 to half the length of \"{}\"", shape.name));
      return false;
    }
    first += off * way.normalized();
    last -= off * way.normalized();
    return true;
  }

  const json& value_;
  const Reader& reader_;
  Mechanism& mechanism_;
  const std::filesystem::path& folder_;
};

}  // namespace

void read_shapes(const Layout& layout, const Reader& reader, Mechanism& mechanism) {
  const std::filesystem::path folder = std::filesystem::path(layout.file).parent_path();
  for (const json& value : member(layout.document, "shapes"))
    if (value.is_object()) ShapeReader(value, reader, mechanism, folder).read();
}

}  // namespace polyglide
