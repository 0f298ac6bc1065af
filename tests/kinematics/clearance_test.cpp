#include "kinematics/clearance.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "catalog/catalog.hpp"
#include "catalog/json_file.hpp"
#include "kinematics/certify.hpp"
#include "kinematics/limits.hpp"
#include "kinematics/mesh_tree.hpp"
#include "kinematics/workspace.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;
using Piece = pieces::Piece<double>;

Piece piece(const std::vector<Vector3>& corners) {
  Piece result;
  result.corners = static_cast<int>(corners.size());
  for (std::size_t k = 0; k < corners.size(); ++k)
    result.corner[k] = {corners[k].x(), corners[k].y(), corners[k].z()};
  return result;
}

double apart(const std::vector<Vector3>& a, const std::vector<Vector3>& b) {
  return std::sqrt(pieces::squared_distance(piece(a), piece(b)));
}

TEST(PieceDistance, OfSkewSegmentsIsTheirCommonNormal) {
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}, {1, 0, 0}}, {{0.5, -1, 2}, {0.5, 1, 2}}), 2);
  // Beyond its end the nearest point is the end.
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}, {1, 0, 0}}, {{4, -1, 4}, {4, 1, 4}}), 5);
}

TEST(PieceDistance, KnowsParallelAndShrunkenSegmentsAndPoints) {
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}, {2, 0, 0}}, {{1, 3, 0}, {5, 3, 0}}), 3);
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}, {1, 0, 0}}, {{3, 0, 0}, {7, 0, 0}}), 2);
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}, {1, 0, 0}}, {{1, 0, 0}, {0, 0, 0}}), 0);
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}, {0, 0, 0}}, {{3, 4, 0}, {3, 4, 0}}), 5);
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}}, {{-1, 2, 0}, {1, 2, 0}}), 2);
}

TEST(PieceDistance, OfATriangleCountsItsInsideAndWhatPiercesIt) {
  const std::vector<Vector3> triangle{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  EXPECT_DOUBLE_EQ(apart(triangle, {{1, 1, 3}}), 3);
  EXPECT_DOUBLE_EQ(apart(triangle, {{1, 1, 3}, {1, 1, -3}}), 0);
  EXPECT_DOUBLE_EQ(apart({{1, 1, 2}, {9, 9, 2}}, triangle), 2);
  EXPECT_DOUBLE_EQ(apart(triangle, {{4, 4, 0}, {9, 9, 0}}), std::sqrt(8));
  EXPECT_DOUBLE_EQ(apart(triangle, {{0, 0, 5}, {4, 0, 5}, {0, 4, 6}}), 5);
}

/// Corners of a random piece, at times degenerate or parallel to the x axis.
std::vector<Vector3> random_corners(Uniform& random) {
  const int corners = 1 + static_cast<int>(1.5 * (random() + 1));
  std::vector<Vector3> result;
  for (int k = 0; k < corners; ++k) result.push_back(random.vector());
  if (corners == 2 && random() > 0.5) result[1] = result[0] + Vector3::UnitX() * random();
  if (corners == 2 && random() > 0.8) result[1] = result[0];
  return result;
}

Mesh mesh_of(const std::vector<Vector3>& corners) {
  Mesh mesh;
  for (std::size_t k = 0; k < 3; ++k)
    mesh.vertices.push_back(corners[std::min(k, corners.size() - 1)]);
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// Least distance of points spread over both pieces, and how far that may be above the truth.
double sampled(const std::vector<Vector3>& a, const std::vector<Vector3>& b, int steps) {
  const auto spread = [steps](const std::vector<Vector3>& corners) {
    std::vector<Vector3> points;
    const Vector3 &p = corners[0], &q = corners[std::min<std::size_t>(1, corners.size() - 1)],
                  &r = corners.back();
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j <= (corners.size() == 3 ? steps - i : 0); ++j)
        points.push_back(p + (q - p) * i / steps +
                         (corners.size() == 3 ? 1 : 0) * (r - p) * j / steps);
    return points;
  };
  double least = 1e9;
  for (const Vector3& one : spread(a))
    for (const Vector3& other : spread(b)) least = std::min(least, (one - other).norm());
  return least;
}

TEST(PieceDistance, AgreesWithSamplingAndWithFcl) {
  Uniform random;
  for (int round = 0; round < 3000; ++round) {
    const auto a = random_corners(random), b = random_corners(random);
    const double found = apart(a, b);
    EXPECT_EQ(found, std::sqrt(pieces::squared_distance(piece(a), piece(b))));
    EXPECT_NEAR(found, apart(b, a), 1e-12);
    if (round < 200) {
      constexpr int kSteps = 24;
      const double rough = sampled(a, b, kSteps);
      EXPECT_LE(found, rough + 1e-12);
      EXPECT_GE(found, rough - 8.0 / kSteps);  // edges are up to 2√3 long
    }
    if (!knows_meshes()) continue;
    const MeshTree tree(mesh_of(a));
    const double theirs = tree.distance(Transform::Identity(), {piece(b)});
    EXPECT_NEAR(found, theirs, 1e-9) << round;
  }
}

/// A layout of the catalog with shapes and limits put in.
Machine with(const std::string& name, const char* additions) {
  nlohmann::json document = find_layout(name).document;
  const auto added = nlohmann::json::parse(additions);
  for (const char* key : {"shapes", "limits"})
    for (const auto& value : added.value(key, nlohmann::json::array()))
      document[key].push_back(value);
  return prepare(expand(parse_layout(document, "f")));
}

/// Random poses about home; turned where the machine can turn.
PoseBatch some_poses(const Machine& machine, double reach, double tilt, int count) {
  Uniform random;
  PoseBatch poses;
  poses.wanted = Wanted::condition | Wanted::drives;
  const auto has = [&](int axis) { return std::ranges::count(machine.task.axes, axis) > 0; };
  for (int i = 0; i < count; ++i) {
    poses.x.push_back(has(0) ? reach * random() : 0);
    poses.y.push_back(has(1) ? reach * random() : 0);
    poses.z.push_back(has(2) ? reach * random() : 0);
    if (machine.task.rotations > 0)
      for (int k = 0; k < 3; ++k) poses.angles[k].push_back(has(3 + k) ? tilt * random() : 0);
  }
  return poses;
}

/// Late limits of the closed form against bodies moved by the general solver.
void expect_same_as_general(const Machine& machine, double reach, double tilt) {
  const Evaluator evaluator(machine);
  ASSERT_TRUE(evaluator.closed_form());
  PoseBatch poses = some_poses(machine, reach, tilt, 300);
  const auto late = late_limit_names(machine.model.mechanism);
  int stopped = 0, reached = 0;
  for (const char* instructions : {"scalar", ""}) {
    poses.instructions = instructions;
    BatchResult result;
    evaluator.evaluate(poses, result);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const std::string name = result.limit[i] < 0 ? "" : evaluator.limit_names()[result.limit[i]];
      if (!name.empty() && std::ranges::count(late, name) == 0) continue;
      Posture posture = home(machine.model);
      ASSERT_TRUE(solve_inverse_general(machine, pose_at(poses, i), posture).reachable);
      EXPECT_EQ(broken_limit(machine.model, posture), name) << i;
      EXPECT_EQ(result.inverse_condition[i] == 0, !name.empty());
      ++(name.empty() ? reached : stopped);
    }
  }
  EXPECT_GT(stopped, 20);
  EXPECT_GT(reached, 20);
}

TEST(Clearances, InClosedFormAreThoseOfTheGeneralWay) {
  expect_same_as_general(with("delta-1", R"({
    "shapes": [{"of": "leg*.rod_*", "diameter": 12, "trim": 10}, {"of": "leg*.guide", "diameter": 60},
               {"of": "platform", "diameter": 6}],
    "limits": [{"name": "apart", "clearance": 20},
               {"name": "plate", "clearance": 0, "between": ["leg", "platform"], "joined": true}]})"),
                         0.12, 0);
}

TEST(Clearances, KnowArmsThatTurn) {
  expect_same_as_general(with("delta", R"({
    "shapes": [{"of": "*.rod*", "diameter": 10}, {"of": "*.arm", "diameter": 20},
               {"of": "base", "points": [[0, 0, 0]], "diameter": 100}],
    "limits": [{"name": "apart", "clearance": 30}]})"),
                         0.25, 0);
}

TEST(Clearances, KnowTelescopesAndTurnedPlatforms) {
  expect_same_as_general(with("hexapod-6ups", R"({
    "shapes": [{"of": "strut*.strut", "diameter": 40, "trim": 60}, {"of": "platform", "diameter": 80}],
    "limits": [{"name": "apart", "clearance": 290, "between": ["strut", "strut"]}]})"),
                         0.2, 0.3);
}

/// An almost Cartesian machine: the tool moves in a cube of 600 mm, a ball of 100 mm on the
/// platform meets a ball of 300 mm in the corner of the cube.
Mechanism balls(double clearance) {
  std::vector<HalfSpaceLimit::Plane> cube;
  for (int k = 0; k < 3; ++k)
    for (const double way : {-1.0, 1.0}) cube.push_back({way * Vector3::Unit(k), 0.3});
  Mechanism mechanism = orthoglide(50);
  mechanism.limits.push_back({"cube", 1, {Vector3::Zero()}, cube});
  BodyShape ball;
  ball.name = "platform";
  ball.points = {{1, Vector3::Zero()}};
  ball.radius = 0.05;
  mechanism.shapes.push_back(ball);
  ball.name = "base";
  ball.points = {{0, Vector3::Constant(0.3)}};
  ball.radius = 0.15;
  mechanism.shapes.push_back(ball);
  mechanism.clearances.push_back({"balls", clearance, {}, false, {{0, 1}}});
  return mechanism;
}

TEST(Clearances, LetShapesTouchAndNoMore) {
  const Machine machine = prepare(balls(0), task_of({0, 1, 2}));
  const Evaluator evaluator(machine);
  const double touching = 0.3 - 0.2;  // along x, at the height of the other ball
  PoseBatch poses;
  for (const double off : {-1e-7, 0.0, 1e-7}) {
    poses.x.push_back(touching + off);
    poses.y.push_back(0.3);
    poses.z.push_back(0.3);
  }
  BatchResult result;
  evaluator.evaluate(poses, result);
  EXPECT_EQ(result.limit[0], -1);
  EXPECT_EQ(result.limit[1], -1);
  ASSERT_GE(result.limit[2], 0);
  EXPECT_EQ(evaluator.limit_names()[result.limit[2]], "clearance platform base");
  Posture posture = home(machine.model);
  ASSERT_TRUE(solve_inverse_general(machine, pose_at(poses, 1), posture).reachable);
  EXPECT_NEAR(clearance_of(machine.model, posture, {0, 1}), 0, 1e-9);
}

TEST(Clearances, TakeFromAWorkspaceWhatTheBallTakes) {
  const double radius = 0.25, octant = M_PI / 6 * radius * radius * radius;
  const Workspace workspace = compute_workspace(prepare(balls(0.05), task_of({0, 1, 2})));
  EXPECT_NEAR(workspace.volume, 0.216 - octant, 1e-3 * 0.216);
  EXPECT_TRUE(workspace.certified);
  EXPECT_LE(workspace.volume_lower, 0.216 - octant);
  EXPECT_GE(workspace.volume_upper, 0.216 - octant);
  EXPECT_LE(workspace.volume_upper - workspace.volume_lower, 0.01 * 0.216);
  EXPECT_GT(workspace.limits_hit.at("clearance platform base"), 0.03);
}

TEST(Clearances, AreIgnoredByFullNameFirstWordOrTheNameOfTheirLimit) {
  const Machine machine = prepare(balls(0.05), task_of({0, 1, 2}));
  const Pose near{Vector3(0.2, 0.2, 0.2), Eigen::Quaterniond::Identity()};
  EXPECT_EQ(solve_inverse(machine, near).limit, "clearance platform base");
  for (const char* word : {"clearance platform base", "clearance", "balls"})
    EXPECT_TRUE(solve_inverse(machine, near, {word}).reachable) << word;
}

/// Least value between 0 and 1 of a convex function, by golden section.
template <typename Function>
double least_of(const Function& value) {
  double low = 0, high = 1;
  constexpr double kGolden = 0.6180339887498949;
  for (int i = 0; i < 80; ++i) {
    const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    (value(a) < value(b) ? high : low) = value(a) < value(b) ? b : a;
  }
  return std::min({value(low), value(0.0), value(1.0)});
}

using Line = std::array<Vector3, 2>;

double from_line(const Vector3& point, const Line& line) {
  const Vector3 way = line[1] - line[0];
  const double part = std::clamp((point - line[0]).dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (point - line[0] - part * way).norm();
}

double between_lines(const Line& a, const Line& b) {
  return least_of([&](double part) { return from_line(a[0] + part * (a[1] - a[0]), b); });
}

/// Of a line from a level convex plate with these corners, counterclockwise.
double from_plate(const Line& line, const std::vector<Vector3>& corners) {
  return least_of([&](double part) {
    const Vector3 point = line[0] + part * (line[1] - line[0]);
    bool above = true;
    double edge = 1e9;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Vector3 &from = corners[k], &to = corners[(k + 1) % corners.size()];
      above = above && (to - from).cross(point - from).z() >= 0;
      edge = std::min(edge, from_line(point, {from, to}));
    }
    return above ? std::abs(point.z() - corners[0].z()) : edge;
  });
}

/// The machine of the example, placed by its own few lines: columns upright, so that a rod's upper
/// end is straight above or below where it was.
struct ByHand {
  std::vector<Line> rods, columns;  // at home
  std::vector<Vector3> plate;
  std::vector<int> leg;

  explicit ByHand(const Mechanism& mechanism) {
    std::map<std::string, Line> by_name;
    Vector3 centre = Vector3::Zero();
    for (const Joint& joint : mechanism.joints) {
      const std::string limb = joint.name.substr(0, 4), part = joint.name.substr(5);
      if (part == "guide")
        columns.push_back({joint.at + joint.range[0].min * Vector3::UnitZ(),
                           joint.at + joint.range[0].max * Vector3::UnitZ()});
      if (part.starts_with("top")) by_name[limb + part.substr(3)][0] = joint.at;
      if (!part.starts_with("bottom")) continue;
      by_name[limb + part.substr(6)][1] = joint.at;
      plate.push_back(joint.at);
      centre += joint.at / 6;
    }
    for (const auto& [name, rod] : by_name) {
      rods.push_back(rod);
      leg.push_back(name[3] - '1');
    }
    std::ranges::sort(plate, {}, [&](const Vector3& at) {
      return std::atan2(at.y() - centre.y(), at.x() - centre.x());
    });
  }

  /// How far the nearest are from their bounds: rods of 12 mm, trimmed by 20 mm, 3 mm from each
  /// other and from columns of 30 mm, 4 mm from a plate of 16 mm.
  [[nodiscard]] double room(const Vector3& t) const {
    std::vector<Line> now;
    for (const auto& [top, bottom] : rods) {
      const Vector3 end = bottom + t;
      const double length = (top - bottom).norm(), across = (end - top).head<2>().norm();
      const Vector3 start(top.x(), top.y(), end.z() + std::sqrt(length * length - across * across));
      const Vector3 off = 0.020 * (end - start).normalized();
      now.push_back({start + off, end - off});
    }
    std::vector<Vector3> corners = plate;
    for (Vector3& corner : corners) corner += t;
    double room = 1e9;
    for (std::size_t i = 0; i < now.size(); ++i) {
      room = std::min(room, from_plate(now[i], corners) - 0.018);
      for (std::size_t k = i + 1; k < now.size(); ++k)
        room = std::min(room, between_lines(now[i], now[k]) - 0.015);
      for (std::size_t k = 0; k < columns.size(); ++k)
        if (static_cast<int>(k) != leg[i])
          room = std::min(room, between_lines(now[i], columns[k]) - 0.024);
    }
    return room;
  }
};

TEST(Clearances, OfTheExampleMachineAreThoseOfABruteForceLoop) {
  const Machine machine =
      prepare(expand(find_layout(POLYGLIDE_SOURCE_DIR "/examples/machines/delta-1-rods.json")));
  const ByHand by_hand(machine.model.mechanism);
  const Evaluator bare(machine, {"lift", "clearance"}), evaluator(machine, {"lift"});
  PoseBatch poses;
  constexpr double kStep = 0.01;
  for (double z = -0.3; z < 0.3; z += kStep)
    for (double y = -0.2; y < 0.2; y += kStep)
      for (double x = -0.2; x < 0.2; x += kStep) {
        poses.x.push_back(x);
        poses.y.push_back(y);
        poses.z.push_back(z);
      }
  BatchResult without, result;
  bare.evaluate(poses, without);
  evaluator.evaluate(poses, result);
  int inside = 0, before = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (without.limit[i] >= 0) continue;
    const double room = by_hand.room({poses.x[i], poses.y[i], poses.z[i]});
    if (std::abs(room) > 1e-7) {
      EXPECT_EQ(result.limit[i] < 0, room > 0) << i << ": " << room;
    }
    ++before;
    inside += room > 0;
  }
  EXPECT_LT(inside, 0.95 * before);
  WorkspaceOptions options;
  options.volume_only = true;
  options.ignored = {"lift"};
  const double volume = compute_workspace(machine, options).volume;
  EXPECT_NEAR(volume, inside * kStep * kStep * kStep, 0.02 * volume);
  options.ignored = {"clearance", "lift"};
  EXPECT_NEAR(compute_workspace(machine, options).volume, 12.010e-3, 0.012e-3);
}

/// Verdicts of small boxes against poses sampled in them.
void expect_honest_certificates(const Machine& machine, double reach, double edge, double tilt) {
  const Evaluator evaluator(machine);
  Uniform random;
  int certified = 0, failed = 0;
  for (int round = 0; round < 60; ++round) {
    const PoseRegion region{Vector3::Constant(edge), reach * random.vector(), tilt, 0};
    const BoxCertificate found = certify_box(machine, region, {}, 20000);
    if (found.verdict == CertifyVerdict::fails && found.limit.starts_with("clearance")) {
      EXPECT_EQ(solve_inverse(machine, *found.at).limit.substr(0, 9), "clearance");
      ++failed;
    }
    if (found.verdict != CertifyVerdict::certified) continue;
    ++certified;
    PoseBatch poses = some_poses(machine, edge / 2, tilt, 300);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses.x[i] += region.centre.x();
      poses.y[i] += region.centre.y();
      poses.z[i] += region.centre.z();
    }
    BatchResult result;
    evaluator.evaluate(poses, result);
    for (std::size_t i = 0; i < poses.size(); ++i) ASSERT_LT(result.limit[i], 0) << round;
  }
  EXPECT_GT(certified, 5);
  EXPECT_GT(failed, 5);
}

TEST(ClearanceCertificates, AreHonestForRodsRailsAndPlates) {
  expect_honest_certificates(with("delta-1", R"({
    "shapes": [{"of": "leg*.rod_*", "diameter": 12, "trim": 20}, {"of": "leg*.guide", "diameter": 60},
               {"of": "platform", "diameter": 26}],
    "limits": [{"name": "apart", "clearance": 20},
               {"name": "plate", "clearance": 0, "between": ["leg", "platform"], "joined": true}]})"),
                             0.12, 0.02, 0);
}

TEST(ClearanceCertificates, AreHonestForTelescopesOfATurnedPlatform) {
  expect_honest_certificates(with("hexapod-6ups", R"({
    "shapes": [{"of": "strut*.strut", "diameter": 40, "trim": 60}],
    "limits": [{"name": "apart", "clearance": 302}]})"),
                             0.2, 0.01, 0.01);
}

TEST(ClearanceCertificates, SayWhatTheyCannotEnclose) {
  const Machine machine = with("delta-1", R"({"limits": [
    {"name": "low", "expression": "z", "max": 1000}]})");
  const BoxCertificate found =
      certify_box(machine, {Vector3::Constant(0.01), Vector3::Zero(), 0, 0});
  EXPECT_EQ(found.verdict, CertifyVerdict::undecided);
  EXPECT_EQ(found.reason, "the expression of limit \"low\" cannot be enclosed by intervals");
  EXPECT_EQ(certify_box(machine, {Vector3::Constant(0.01), Vector3::Zero(), 0, 0}, {"low"}).verdict,
            CertifyVerdict::certified);
}

/// A file in the temporary folder that goes with the object.
struct ScratchFile {
  std::filesystem::path path;
  ScratchFile(const std::string& name, const std::string& content)
      : path(std::filesystem::temp_directory_path() / (std::to_string(getpid()) + "-" + name)) {
    std::ofstream(path) << content;
  }
  ~ScratchFile() { std::filesystem::remove(path); }
};

TEST(Meshes, StopPosesAsThePlateOfTheSameFormDoes) {
  const ScratchFile square("square.obj",
                           "v 184 106 60\nv 384 106 60\nv 384 306 60\nv 184 306 60\nf 1 2 3 4\n");
  const auto machine_with = [](const std::string& body) {
    const std::string text = R"({"shapes": [{"of": "platform", "diameter": 40},
      {"of": "leg*.rod_*", "diameter": 20}, {"of": "base", "diameter": 10, )" +
                             body + R"(}],
      "limits": [{"name": "table-top", "clearance": 5}]})";
    return with("delta-1", text.c_str());
  };
  const std::string mesh = R"("mesh": ")" + square.path.string() + '"';
  if (!knows_meshes()) {
    EXPECT_THROW(static_cast<void>(machine_with(mesh)), InputError);
    GTEST_SKIP() << "built without FCL";
  }
  const Machine
      surface = machine_with(mesh),
      plate = machine_with(
          R"("points": [[184, 106, 60], [384, 106, 60], [384, 306, 60], [184, 306, 60]])");
  const Evaluator meshed(surface), closed(plate);
  ASSERT_TRUE(meshed.closed_form());
  const PoseBatch poses = some_poses(plate, 0.15, 0, 2000);
  BatchResult a, b;
  meshed.evaluate(poses, a);
  closed.evaluate(poses, b);
  int stopped = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(a.limit[i] < 0, b.limit[i] < 0) << i;
    stopped +=
        a.limit[i] >= 0 && meshed.limit_names()[a.limit[i]].starts_with("clearance platform base");
  }
  EXPECT_GT(stopped, 50);
}

TEST(Meshes, OnARodAreMovedTheGeneralWay) {
  if (!knows_meshes()) GTEST_SKIP() << "built without FCL";
  const ScratchFile fin("fin.stl",
                        "solid fin\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 50 0 0\n"
                        "vertex 0 50 0\nendloop\nendfacet\nendsolid\n");
  const std::string text = R"({"shapes": [{"of": "leg1.rod_a", "mesh": ")" + fin.path.string() +
                           R"("}, {"of": "leg2.rod_a", "diameter": 12}],
      "limits": [{"name": "fin", "clearance": 5}]})";
  const Machine machine = with("delta-1", text.c_str());
  EXPECT_FALSE(machine.legs.has_value());
  EXPECT_TRUE(solve_inverse(machine, Pose{}).reachable);
}

TEST(Expressions, BoundTheWorkspaceAsPlanesAndBallsDo) {
  Mechanism mechanism = balls(0);
  mechanism.clearances.clear();
  mechanism.shapes.clear();
  mechanism.expressions = {{"ball", "hypot(hypot(x, y), z)", {-1e9, 250}}, {"up", "q3", {0, 1e9}}};
  const Machine machine = prepare(mechanism, task_of({0, 1, 2}));
  const double radius = 0.25;
  const Workspace workspace = compute_workspace(machine);
  EXPECT_NEAR(workspace.volume, 2 * M_PI / 3 * std::pow(radius, 3), 2e-3 * workspace.volume);
  EXPECT_FALSE(workspace.certified);
  EXPECT_GT(workspace.limits_hit.at("ball"), 0.3);
  EXPECT_EQ(solve_inverse(machine, Pose{{0, 0, -0.01}, Eigen::Quaterniond::Identity()}).limit,
            "up");
  EXPECT_TRUE(solve_inverse(machine, Pose{{0, 0, -0.01}, Eigen::Quaterniond::Identity()}, {"up"})
                  .reachable);
}

TEST(Expressions, WithoutAValueStopAPose) {
  Mechanism mechanism = orthoglide(50);
  mechanism.expressions = {{"root", "sqrt(x)", {-1e9, 1e9}}};
  const Machine machine = prepare(mechanism, task_of({0, 1, 2}));
  EXPECT_TRUE(solve_inverse(machine, Pose{{0.01, 0, 0}, Eigen::Quaterniond::Identity()}).reachable);
  EXPECT_EQ(solve_inverse(machine, Pose{{-0.01, 0, 0}, Eigen::Quaterniond::Identity()}).limit,
            "root");
}

TEST(Expressions, KnowAnglesAndDrivesInTheUnitsOfTheFile) {
  expect_same_as_general(with("hexapod-6ups", R"({"limits": [
    {"name": "tilt", "expression": "abs(a) + abs(b) + 0", "max": 15},
    {"name": "sum", "expression": "strut1.strut + q2 + Rb/10", "min": -100, "max": 200}]
})"),
                         0.2, 0.3);
}

}  // namespace
}  // namespace polyglide
