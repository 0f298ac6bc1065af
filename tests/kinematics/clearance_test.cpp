#include "kinematics/clearance.hpp"

#include <gtest/gtest.h>

#include "kinematics/workspace.hpp"
#include "late_limits.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

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
      EXPECT_EQ(result.limit[i]<0, room> 0) << i << ": " << room;
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

}  // namespace
}  // namespace polyglide
