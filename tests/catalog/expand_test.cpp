// Layouts against dimensions worked out by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "catalog/catalog.hpp"
#include "catalog/fixtures_path.hpp"

namespace polyglide {
namespace {

using test::fixture;

const Joint& joint(const Mechanism& mechanism, const std::string& name) {
  for (const Joint& candidate : mechanism.joints)
    if (candidate.name == name) return candidate;
  throw std::out_of_range(name);
}

void expect_near(const Vector3& a, const Vector3& b, double tolerance = 1e-12) {
  EXPECT_LT((a - b).norm(), tolerance) << a.transpose() << " against " << b.transpose();
}

/// One vertical guide at x = 300 mm, a rod of 500 mm to (0, 0, 0).
nlohmann::json one_leg() {
  return nlohmann::json::parse(R"({"format": "polyglide/layout/1", "name": "leg",
    "parameters": {"rod": {"value": 500, "min": 400, "max": 900, "unit": "length", "about": "rod"}},
    "limbs": [{"name": "leg", "guide": {"through": [300, 0, 0], "direction": "z", "stroke": [100, 600]},
      "rods": {"length": "rod", "carriage": {"joint": "universal", "axis": "y", "cone": 30},
               "platform": {"joint": "universal", "axis": "x", "at": [0, 0, 0]}}}]})");
}

TEST(Expand, PlacesACarriageARodLengthFromItsPlatformJoint) {
  const Mechanism leg = expand(parse_layout(one_leg(), "f"));
  expect_near(joint(leg, "leg.guide").at, {0.3, 0, 0.4});  // 3-4-5
  expect_near(joint(leg, "leg.top").at, {0.3, 0, 0.4});
  expect_near(joint(leg, "leg.bottom").at, {0, 0, 0});
  const Joint& guide = joint(leg, "leg.guide");
  EXPECT_EQ(guide.driven, std::vector<int>{0});
  EXPECT_NEAR(guide.range[0].min, 0.1 - 0.4, 1e-15);
  EXPECT_NEAR(guide.range[0].max, 0.6 - 0.4, 1e-15);
}

TEST(Expand, PlacesItAtTheNearerPlaceWhenAsked) {
  nlohmann::json document = one_leg();
  document["limbs"][0]["guide"]["side"] = "near";
  expect_near(joint(expand(parse_layout(document, "f")), "leg.guide").at, {0.3, 0, -0.4});
}

TEST(Expand, FixesTheNamedAxisInCarriageAndPlatform) {
  const Mechanism leg = expand(parse_layout(one_leg(), "f"));
  const Joint& top = joint(leg, "leg.top");
  const Joint& bottom = joint(leg, "leg.bottom");
  EXPECT_EQ(leg.bodies[top.bodies[0]], "leg.carriage");
  EXPECT_EQ(leg.bodies[top.bodies[1]], "leg.rod");
  EXPECT_EQ(leg.bodies[bottom.bodies[1]], "platform");
  const Vector3 rod(-0.6, 0, -0.8);
  expect_near(top.axes[0], Vector3::UnitY());
  EXPECT_NEAR(top.axes[1].dot(Vector3::UnitY()), 0, 1e-15);
  EXPECT_NEAR(top.axes[1].dot(rod), 0, 1e-15);
  expect_near(bottom.axes[1], Vector3::UnitX());
  EXPECT_NEAR(bottom.axes[0].dot(rod), 0, 1e-15);
  EXPECT_NEAR(*top.cone, std::numbers::pi / 6, 1e-15);
  expect_near(top.cone_axis, rod);
}

TEST(Expand, FollowsAnOverriddenParameter) {
  const Layout layout = parse_layout(one_leg(), "f");
  expect_near(joint(expand(layout, {{"rod", std::hypot(300., 300.)}}), "leg.guide").at,
              {0.3, 0, 0.3});
  expect_near(joint(expand(layout), "leg.guide").at, {0.3, 0, 0.4});
}

TEST(Expand, TurnsCopiesAboutTheVerticalAndNumbersThem) {
  nlohmann::json document = one_leg();
  document["limbs"][0]["copies"] = {{"j", {0, 1}}, {"k", {0, 1}}};
  document["limbs"][0]["turn"] = "180*j + 90*k";
  const Mechanism legs = expand(parse_layout(document, "f"));
  expect_near(joint(legs, "leg1.guide").at, {0.3, 0, 0.4});
  expect_near(joint(legs, "leg2.guide").at, {0, 0.3, 0.4});
  expect_near(joint(legs, "leg3.guide").at, {-0.3, 0, 0.4});
  expect_near(joint(legs, "leg4.guide").at, {0, -0.3, 0.4});
}

TEST(Expand, LeansAGuideToTheHorizontal) {
  nlohmann::json document = one_leg();
  document["limbs"][0]["turn"] = 90;
  document["limbs"][0]["guide"]["direction"] = {{"lean", 60}, {"toward", "-radial"}};
  const Vector3 direction = joint(expand(parse_layout(document, "f")), "leg.guide").axes[0];
  expect_near(direction, {0, -0.5, std::sqrt(0.75)});
}

TEST(Expand, MeasuresDelta1AsPrinted) {
  const Mechanism delta = expand(find_layout("delta-1"));
  const Vector3 centre(0.184, 0.368 * std::sqrt(3) / 6, delta.tool.z());
  expect_near(delta.tool, centre);
  EXPECT_NEAR(delta.tool.z(), 0.018694, 1e-6);  // 243.5 − √(256² − 122.468²) mm
  const std::array corners = {Vector3(0, 0, 0), Vector3(0.184, 0.184 * std::sqrt(3), 0),
                              Vector3(0.368, 0, 0)};
  for (int i = 0; i < 3; ++i) {
    const std::string leg = "leg" + std::to_string(i + 1);
    const Joint& guide = joint(delta, leg + ".guide");
    expect_near(guide.at, corners[i] + Vector3(0, 0, 0.2435));
    EXPECT_NEAR(guide.range[0].min, -0.1825, 1e-12);
    EXPECT_NEAR(guide.range[0].max, 0.1825, 1e-12);
    const Vector3 a = joint(delta, leg + ".bottom_a").at, b = joint(delta, leg + ".bottom_b").at;
    const Vector3 middle = (a + b) / 2;
    EXPECT_NEAR((a - b).norm(), 0.070, 1e-12);
    EXPECT_NEAR((middle - centre).norm(), 0.089997, 5e-7);  // (1)
    EXPECT_NEAR((guide.at - centre).head<2>().norm(), 0.212465, 5e-7);
    EXPECT_NEAR((middle - guide.at).norm(), 0.256, 1e-12);
    expect_near(delta.limits[0].points[i], middle, 1e-9);  // (1) gives the rods' places
  }
}

TEST(Expand, KeepsDelta1InsideTheTriangleOfItsChecks) {
  const Mechanism delta = expand(find_layout("delta-1"));
  ASSERT_EQ(delta.limits.size(), 2u);
  EXPECT_EQ(delta.limits[0].name, "triangle");
  const auto keeps = [&](double x, double y) {
    for (const auto& plane : delta.limits[0].planes)
      if (plane.normal.dot(Vector3(x, y, 0)) > plane.offset) return false;
    return true;
  };
  const auto printed = [](double x, double y) {  // (6) in metres
    constexpr double c = 0.070, d = 0.368;
    const double s = std::sqrt(3.0);
    return y <= d * s / 2 && y >= x * -s - (0 + c / 4) * -s + 0 - c * s / 4 &&
           y >= x * s - (d - c / 4) * s + 0 - c * s / 4;
  };
  for (double x = -0.1005; x < 0.5; x += 0.01)
    for (double y = -0.1005; y < 0.5; y += 0.01)
      EXPECT_EQ(keeps(x, y), printed(x, y)) << x << ' ' << y;
}

TEST(Expand, MeetsTwoStrutsAtEachBallOfTheHexapod) {
  const Mechanism hexapod = expand(find_layout("hexapod-6ups"));
  std::vector<Vector3> balls, tops;
  for (int m = 1; m <= 6; ++m) {
    balls.push_back(joint(hexapod, "strut" + std::to_string(m) + ".platform").at);
    tops.push_back(joint(hexapod, "strut" + std::to_string(m) + ".base").at);
  }
  for (int m = 0; m < 6; m += 2) expect_near(balls[m], balls[m + 1]);
  EXPECT_GT((balls[0] - balls[2]).norm(), 0.1);
  const double length =
      std::sqrt(std::pow(600 * std::cos(42 * std::numbers::pi / 180) - 200, 2) +
                std::pow(600 * std::sin(42 * std::numbers::pi / 180), 2) + 900 * 900.) /
      1000;
  EXPECT_NEAR((balls[0] - tops[0]).norm(), length, 1e-12);
  EXPECT_NEAR(joint(hexapod, "strut1.strut").range[0].max, 1.3 - length, 1e-12);
}

TEST(Expand, PutsFacingCarriagesOfTable1OnOneLevel) {
  for (const char* name :
       {"table1-1", "table1-2", "table1-3", "table1-4", "table1-5", "table1-6"}) {
    const Mechanism machine = expand(find_layout(name));
    for (const char* limb : {"a", "b"}) {
      const Vector3 first = joint(machine, limb + std::string("1.guide")).at;
      const Vector3 second = joint(machine, limb + std::string("2.guide")).at;
      EXPECT_NEAR(first.z(), second.z(), 1e-12) << name;
    }
    const double height = joint(machine, "a1.guide").at.z();
    EXPECT_NEAR(height, joint(machine, "b1.guide").at.z(), 1e-12) << name;
  }
}

TEST(Expand, GivesTheSameMachineWhateverTheUnitsOfItsFile) {
  const Mechanism mm = expand(load_layout(fixture("millimetres.json")));
  const Mechanism m = expand(load_layout(fixture("metres.json")));
  ASSERT_EQ(mm.joints.size(), m.joints.size());
  EXPECT_EQ(mm.bodies, m.bodies);
  expect_near(mm.tool, m.tool);
  for (std::size_t i = 0; i < m.joints.size(); ++i) {
    const Joint &a = mm.joints[i], &b = m.joints[i];
    expect_near(a.at, b.at);
    expect_near(a.axes[0], b.axes[0]);
    expect_near(a.axes[1], b.axes[1]);
    expect_near(a.cone_axis, b.cone_axis);
    EXPECT_NEAR(a.pitch, b.pitch, 1e-15);
    EXPECT_NEAR(a.cone.value_or(0), b.cone.value_or(0), 1e-12);
    ASSERT_EQ(a.range.size(), b.range.size());
    for (std::size_t k = 0; k < a.range.size(); ++k) {
      EXPECT_NEAR(a.range[k].min, b.range[k].min, 1e-12);
      EXPECT_EQ(std::isfinite(a.range[k].max), std::isfinite(b.range[k].max));
      if (!std::isfinite(b.range[k].max)) continue;
      EXPECT_NEAR(a.range[k].max, b.range[k].max, 1e-12);
    }
  }
  EXPECT_NEAR(mm.joints.back().pitch, 0.005 / (2 * std::numbers::pi), 1e-15);
}

TEST(Expand, FindsTheRodForAConeWithoutAxis) {
  const auto mechanism = [](const char* joints) {
    return expand(parse_layout(
        nlohmann::json::parse(
            std::string(
                R"({"format": "polyglide/mechanism/1", "name": "x", "base": "b", "platform": "p", "joints": [)") +
            joints + "]}"),
        "f"));
  };
  // Guide, rod: towards the rod's other end, not along the guide.
  const Mechanism rod = mechanism(
      R"({"name": "g", "type": "prismatic", "between": ["b", "c"], "axis": "z"},
         {"name": "t", "type": "universal", "between": ["c", "r"], "at": [0, 0, 9], "axes": ["x", "y"], "cone": 10},
         {"name": "s", "type": "spherical", "between": ["r", "p"], "at": [9, 0, 9], "cone": 10})");
  expect_near(rod.joints[1].cone_axis, Vector3::UnitX());
  expect_near(rod.joints[2].cone_axis, -Vector3::UnitX());
  expect_near(rod.joints[0].at, {0, 0, 0.009});  // a slide is drawn at its neighbour
  // Strut: along its slide.
  const Mechanism strut = mechanism(
      R"({"name": "t", "type": "universal", "between": ["b", "l"], "at": [0, 0, 9], "axes": ["x", "y"], "cone": 10},
         {"name": "g", "type": "prismatic", "between": ["l", "u"], "axis": "-z"},
         {"name": "s", "type": "spherical", "between": ["u", "p"], "at": [0, 0, 0], "cone": 10})");
  expect_near(strut.joints[0].cone_axis, -Vector3::UnitZ());
}

/// An arm of 250 mm about y at (200, 0, 600) and a rod to (50, 0, 0).
nlohmann::json one_arm() {
  return nlohmann::json::parse(R"({"format": "polyglide/layout/1", "name": "arm",
    "parameters": {"rod": {"value": 600, "min": 100, "max": 900, "unit": "length", "about": "rod"}},
    "limbs": [{"name": "leg", "crank": {"at": [200, 0, 600], "length": 250, "range": [-30, 60]},
      "rods": {"form": "parallelogram", "spacing": 80, "length": "rod",
               "carriage": {"joint": "universal"}, "platform": {"joint": "spherical", "at": [50, 0, 0]}}}]})");
}

/// The middle between the two rods' ends at the arm.
Vector3 elbow(const Mechanism& machine) {
  return (joint(machine, "leg.top_a").at + joint(machine, "leg.top_b").at) / 2;
}

TEST(Expand, TurnsAnArmSoThatItsRodsHaveTheirLength) {
  const Mechanism machine = expand(parse_layout(one_arm(), "f"));
  const Joint& crank = joint(machine, "leg.crank");
  EXPECT_EQ(machine.bodies[crank.bodies[1]], "leg.arm");
  EXPECT_EQ(crank.driven, std::vector<int>{0});
  expect_near(crank.axes[0], Vector3::UnitY());
  EXPECT_NEAR(crank.range[0].min, -std::numbers::pi / 6, 1e-15);
  EXPECT_NEAR(crank.range[0].max, std::numbers::pi / 3, 1e-15);
  EXPECT_NEAR((elbow(machine) - Vector3(0.2, 0, 0.6)).norm(), 0.25, 1e-12);
  for (const char* rod : {"a", "b"})
    EXPECT_NEAR((joint(machine, std::string("leg.top_") + rod).at -
                 joint(machine, std::string("leg.bottom_") + rod).at)
                    .norm(),
                0.6, 1e-12);
  EXPECT_NEAR(elbow(machine).y(), 0, 1e-15);
}

TEST(Expand, PutsTheArmsEndFurtherOutOrNearer) {
  nlohmann::json document = one_arm();
  const Vector3 far = elbow(expand(parse_layout(document, "f")));
  document["limbs"][0]["crank"]["side"] = "near";
  const Vector3 near = elbow(expand(parse_layout(document, "f")));
  EXPECT_GT(far.x(), near.x());
  EXPECT_NEAR((near - Vector3(0.05, 0, 0)).norm(), (far - Vector3(0.05, 0, 0)).norm(), 1e-12);
  // Turned by 90°, radially outwards is along y.
  document["limbs"][0]["turn"] = 90;
  document["limbs"][0]["crank"].erase("side");
  expect_near(elbow(expand(parse_layout(document, "f"))), {0, far.x(), far.z()});
}

TEST(Expand, StretchesArmAndRodJustToTheirReachAndNoFurther) {
  const double apart = std::hypot(150, 600);
  const Layout layout = parse_layout(one_arm(), "f");
  const Vector3 end = elbow(expand(layout, {{"rod", apart - 250 + 1e-9}}));
  expect_near(end, Vector3(0.2, 0, 0.6) + 0.25 * Vector3(-150, 0, -600).normalized(), 1e-5);
  try {
    static_cast<void>(expand(layout, {{"rod", apart - 250 - 1e-3}}));
    FAIL() << "an arm that does not reach was accepted";
  } catch (const InputError& error) {
    const std::string message = error.what();
    for (const char* part :
         {"/limbs/0/rods/length", "does not close", "arm of 250 mm", "618.466 mm"})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST(Expand, PutsValuesOfCopyVariablesIntoBodyNames) {
  nlohmann::json document = one_arm();
  document["limbs"][0]["copies"] = {{"k", {0, 90}}};
  document["limbs"][0]["turn"] = "k";
  document["limbs"][0]["between"] = {"base", "bar{k}"};
  document["limbs"].push_back(nlohmann::json::parse(
      R"({"name": "hinge", "copies": {"k": [90, 0]}, "between": ["bar{k}", "platform"],
          "chain": [{"type": "revolute", "at": [0, 0, 0], "axis": "z"}]})"));
  const Mechanism machine = expand(parse_layout(document, "f"));
  EXPECT_EQ(machine.bodies[joint(machine, "leg1.bottom_a").bodies[1]], "bar0");
  EXPECT_EQ(machine.bodies[joint(machine, "leg2.bottom_a").bodies[1]], "bar90");
  EXPECT_EQ(machine.bodies[joint(machine, "hinge1.joint1").bodies[0]], "bar90");
  // A name in braces that is no variable stays as it is.
  document["limbs"][1]["between"] = {"bar{q}", "platform"};
  EXPECT_THROW(static_cast<void>(parse_layout(document, "f")), InputError);
}

TEST(Layout, KeepsItsParametersInTheOrderOfTheFile) {
  const Layout delta = find_layout("delta-1");
  std::string names;
  for (const Parameter& parameter : delta.parameters) names += parameter.name;
  EXPECT_EQ(names, "abcdLne");
  EXPECT_EQ(delta.parameters[0].value, 256);
  EXPECT_EQ(delta.parameters[0].quantity, Quantity::length);
  EXPECT_EQ(delta.parameters[4].min, delta.parameters[4].max);
}

TEST(UsedNames, AreThoseOfExpressionsNotOfWords) {
  const auto document =
      nlohmann::json::parse(R"json({"name": "w", "limbs": [{"name": "gap", "copies": {"k": [1]},
    "turn": "90*k", "guide": {"through": ["R", 0, "-H/2"], "direction": {"lean": "lean", "toward": "radial"}},
    "rods": {"length": "rod", "along": "tangential", "carriage": {"joint": "universal", "axis": ["x0", 0, 1]},
             "platform": {"axis": "x", "at": ["max(r, 3)", 0, 0]}}, "chain": [{"axes": ["y", ["u", 0, 0]]}]}]})json");
  EXPECT_EQ(used_names(document),
            (std::set<std::string>{"H", "R", "k", "lean", "r", "rod", "u", "x0"}));
}

}  // namespace
}  // namespace polyglide
