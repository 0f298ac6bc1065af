#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace polyglide {

using Vector3 = Eigen::Vector3d;

/// The joint kinds of the mechanism format. See docs/conventions.md.
enum class JointType {
  revolute,
  prismatic,
  helical,
  cylindrical,
  universal,
  spherical,
  planar,
  weld
};

/// Number of freedoms of a joint kind: 1 1 1 2 2 3 3 0.
[[nodiscard]] int freedoms(JointType type);

/// Is freedom `index` of the kind a translation (coordinate in metres, else
/// radians)? Cylindrical: rotation, then translation. Planar: two translations,
/// then the rotation. Helical counts as a rotation.
[[nodiscard]] bool is_translation(JointType type, int index);

/// The word of the mechanism format: "revolute", "prismatic", …
[[nodiscard]] std::string to_string(JointType type);

/// The joint kind of a word of the format; nullopt for any other word.
[[nodiscard]] std::optional<JointType> joint_type(std::string_view word);

/// All words, in the order of the enumeration.
[[nodiscard]] const std::vector<std::string>& joint_words();

/// Closed interval of a joint coordinate, measured from home [m or rad].
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// A joint between two bodies. Points [m] and unit directions are in the base
/// frame at home, the assembled posture in which the mechanism is described.
struct Joint {
  std::string name;
  JointType type = JointType::revolute;
  std::array<int, 2> bodies{};   ///< indices into Mechanism::bodies
  Vector3 at = Vector3::Zero();  ///< a point on the axis, or the centre [m]
  std::array<Vector3, 2> axes{Vector3::UnitZ(), Vector3::UnitX()};
  ///< unit; [0] the axis or normal; [1] only for universal, fixed in bodies[1].
  double pitch = 0;                     ///< helical: advance per radian [m/rad]
  std::vector<int> driven;              ///< driven freedom indices, ascending
  std::vector<Range> range;             ///< one per freedom; empty = unlimited
  std::optional<double> cone;           ///< largest deflection of cone_axis [rad]
  Vector3 cone_axis = Vector3::Zero();  ///< unit; set whenever cone is
};

/// Points of one body that must stay on the inner side of planes fixed in the
/// base: normal · point <= offset. Carries, for example, Delta 1's triangle check.
struct HalfSpaceLimit {
  struct Plane {
    Vector3 normal;     ///< unit, base frame
    double offset = 0;  ///< [m]
  };
  std::string name;
  int body = 0;
  std::vector<Vector3> points;  ///< base frame at home [m], fixed in the body
  std::vector<Plane> planes;
};

/// A point fixed in a body.
struct BodyPoint {
  int body = 0;
  Vector3 at = Vector3::Zero();  ///< base frame at home [m]
};

struct Mesh;

/// The room that a body takes, for clearances: a line, a flat convex plate or a surface, thickened
/// all round by a radius. A shape bears the name of its body; that of a rail (fixed in the body
/// that guides) or of a telescope (whose two ends are on two bodies) bears the slide's name.
struct BodyShape {
  enum class Form { line, plate, mesh };
  std::string name;
  Form form = Form::line;
  std::vector<BodyPoint> points;  ///< line: its two ends (a ball: one); plate: corners around it
  double radius = 0;              ///< [m], 0 or more
  int rail = -1;                  ///< joint that slides along it, -1 when it is no rail
  int body = 0;                   ///< mesh: the body that carries it
  std::string mesh_file;          ///< mesh: where it was read
  double mesh_turn = 0;           ///< mesh: about base z [rad], before it is moved
  Vector3 mesh_at = Vector3::Zero();  ///< mesh: where its origin is, base frame at home [m]
  std::shared_ptr<const Mesh> mesh;   ///< in the base frame at home; set for meshes
};

/// Pairs of shapes that must keep a distance from each other.
struct ClearanceLimit {
  std::string name;
  double distance = 0;                      ///< [m], between surfaces, 0 or more
  std::array<std::string, 2> between;       ///< words for the shapes, as written; empty: all
  bool joined = false;                      ///< pairs that a joint connects count, too
  std::vector<std::array<int, 2>> pairs{};  ///< indices into Mechanism::shapes, the smaller first
};

/// min <= expression <= max, over x y z (tool displacement), a b c (rotation) and q1 q2 … (drives),
/// all from home and in the units of the file.
struct ExpressionLimit {
  std::string name;
  std::string expression;  ///< parameters and joint names replaced
  Range range;
};

/// Units of a file, kept so that people read back what they wrote.
struct Units {
  std::string length = "mm";
  std::string angle = "deg";
  double metres = 1e-3;                   ///< one file length unit in metres
  double radians = 0.017453292519943295;  ///< one file angle unit in radians
};

/// A closed-loop mechanism: bodies joined by joints, in numbers. Pure value,
/// SI units. Body 0.. are named; `base` is fixed, `platform` carries the tool.
struct Mechanism {
  std::string name, title, source, about;
  Units units;  ///< of the file it came from; the numbers here are SI
  std::vector<std::string> bodies;
  int base = 0;
  int platform = 0;
  Vector3 tool = Vector3::Zero();  ///< tool point at home, base frame [m]
  std::vector<Joint> joints;
  std::vector<HalfSpaceLimit> limits;
  std::vector<ExpressionLimit> expressions;
  std::vector<BodyShape> shapes;
  std::vector<ClearanceLimit> clearances;
};

/// "clearance leg1.rod leg2.rod": how the limit of one pair of shapes is called.
[[nodiscard]] std::string clearance_name(const Mechanism& mechanism,
                                         const std::array<int, 2>& pair);

/// Names of the limits that a file lists under `limits`.
[[nodiscard]] std::vector<std::string> listed_limits(const Mechanism& mechanism);

}  // namespace polyglide
