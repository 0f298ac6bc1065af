// Thickness of bodies, clearances and expressions in files: what they mean, and what people get
// wrong in them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "catalog/catalog.hpp"
#include "catalog/json_file.hpp"
#include "catalog/mesh.hpp"
#include "catalog/shape_words.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

json document(const std::string& name, const char* additions) {
  json result = find_layout(name).document;
  const json added = json::parse(additions);
  for (const auto& [key, values] : added.items())
    for (const json& value : values) result[key].push_back(value);
  return result;
}

Mechanism machine(const std::string& name, const char* additions) {
  return expand(parse_layout(document(name, additions), "f"));
}

const BodyShape& shape(const Mechanism& mechanism, const std::string& name) {
  return *std::ranges::find(mechanism.shapes, name, &BodyShape::name);
}

std::vector<std::string> pair_names(const Mechanism& mechanism) {
  std::vector<std::string> names;
  for (const ClearanceLimit& limit : mechanism.clearances)
    for (const auto& pair : limit.pairs) names.push_back(clearance_name(mechanism, pair));
  return names;
}

TEST(ShapeWords, MeanNamesPatternsAndLimbs) {
  for (const char* word : {"leg1.rod", "leg*.rod", "leg?.ro*", "leg1", "leg", "*", "l*g"})
    EXPECT_TRUE(means(word, "leg1.rod")) << word;
  for (const char* word : {"leg1.ro", "leg2", "eg", "rod", "", "leg?.rods"})
    EXPECT_FALSE(means(word, "leg1.rod")) << word;
  EXPECT_FALSE(means("plat", "platform"));
  // Many stars take no longer than few.
  EXPECT_FALSE(means(std::string(200, '*') + "a", std::string(5000, 'b')));
}

TEST(Shapes, OfRodsRailsTelescopesAndPlatesFollowTheJoints) {
  const Mechanism delta = machine("delta-1", R"({"shapes": [
    {"of": "leg*.rod_*", "diameter": 12, "trim": "c/7"}, {"of": "leg1.guide", "diameter": 30},
    {"of": "platform"}]})");
  ASSERT_EQ(delta.shapes.size(), 8u);
  const BodyShape& rod = shape(delta, "leg2.rod_a");
  EXPECT_NEAR((rod.points[1].at - rod.points[0].at).norm(), 0.256 - 0.020, 1e-12);
  EXPECT_DOUBLE_EQ(rod.radius, 0.006);
  const BodyShape& rail = shape(delta, "leg1.guide");
  EXPECT_NEAR(rail.points[0].at.z(), 0.516 - 0.365 - 0.090, 1e-12);
  EXPECT_NEAR(rail.points[1].at.z(), 0.516 - 0.090, 1e-12);
  EXPECT_EQ(rail.points[0].body, delta.base);
  EXPECT_EQ(shape(delta, "platform").form, BodyShape::Form::plate);
  EXPECT_EQ(shape(delta, "platform").points.size(), 6u);

  const Mechanism hexapod = machine("hexapod-6ups", R"({"shapes": [{"of": "strut*.strut"}]})");
  ASSERT_EQ(hexapod.shapes.size(), 6u);
  EXPECT_EQ(hexapod.bodies[hexapod.shapes[0].points[0].body], "strut1.lower");
  EXPECT_EQ(hexapod.bodies[hexapod.shapes[0].points[1].body], "strut1.upper");
}

TEST(Clearances, LeaveOutWhatJointsConnect) {
  const char* additions = R"({"shapes": [{"of": "leg*.rod_*", "diameter": 12},
    {"of": "leg*.guide", "diameter": 30}, {"of": "platform"}],
    "limits": [{"name": "all", "clearance": 3}]})";
  const auto pairs = pair_names(machine("delta-1", additions));
  // 15 pairs of rods, and every rod with the two rails on which it does not ride. Rods are joined
  // to the platform, and rails cannot move against each other; the platform is not joined to rails.
  EXPECT_EQ(pairs.size(), 15u + 12u + 3u);
  EXPECT_EQ(std::ranges::count(pairs, "clearance leg1.rod_a leg1.rod_b"), 1);
  EXPECT_EQ(std::ranges::count(pairs, "clearance leg1.rod_a leg1.guide"), 0);
  EXPECT_EQ(std::ranges::count(pairs, "clearance leg1.rod_a leg2.guide"), 1);
  EXPECT_EQ(std::ranges::count(pairs, "clearance leg1.rod_a platform"), 0);
  // Two struts on one ball are joined there.
  const auto struts = pair_names(machine("hexapod-6ups", R"({"shapes": [{"of": "strut*.strut"}],
    "limits": [{"name": "all", "clearance": 3}]})"));
  EXPECT_EQ(struts.size(), 15u - 3u);
}

TEST(Clearances, BetweenTwoWordsAndJoinedBodiesWhereAsked) {
  const auto pairs = pair_names(machine("delta-1", R"({"shapes": [
    {"of": "leg*.rod_*", "trim": 20}, {"of": "platform"}],
    "limits": [{"name": "flat", "clearance": 1, "between": ["leg2", "platform"], "joined": true}]})"));
  EXPECT_EQ(pairs, (std::vector<std::string>{"clearance leg2.rod_a platform",
                                             "clearance leg2.rod_b platform"}));
}

TEST(Expressions, NameDrivesByJointAndTakeParametersIn) {
  const Mechanism delta = machine("delta-1", R"({"limits": [
    {"name": "apart", "expression": "leg1.guide - q2 - sin(z) + d/2", "max": "n/2"}]
})");
  ASSERT_EQ(delta.expressions.size(), 1u);
  EXPECT_EQ(delta.expressions[0].expression, "q1 - q2 - sin(z) + (368)/2");
  EXPECT_DOUBLE_EQ(delta.expressions[0].range.max, 182.5);
  EXPECT_EQ(delta.expressions[0].range.min, Range{}.min);
}

TEST(WrittenMechanisms, CarryShapesClearancesAndExpressions) {
  const char* additions = R"({"shapes": [{"of": "leg*.rod_*", "diameter": 12, "trim": 20},
    {"of": "leg*.guide", "diameter": 30}, {"of": "platform", "diameter": 7}],
    "limits": [{"name": "all", "clearance": 3, "between": ["*", "platform"], "joined": true},
               {"name": "rods", "clearance": 3}, {"name": "e", "expression": "z + L", "min": -3}]})";
  const Mechanism before = machine("delta-1", additions);
  const json written = json::parse(to_json(before).dump());
  const Mechanism after = expand(parse_layout(written, "f"));
  ASSERT_EQ(after.shapes.size(), before.shapes.size());
  for (std::size_t i = 0; i < before.shapes.size(); ++i) {
    EXPECT_EQ(after.shapes[i].form, before.shapes[i].form);
    EXPECT_EQ(after.shapes[i].radius, before.shapes[i].radius);
    EXPECT_EQ(after.shapes[i].rail, before.shapes[i].rail);
    ASSERT_EQ(after.shapes[i].points.size(), before.shapes[i].points.size());
    double nearest = 1;  // a hull may start at another corner
    for (const BodyPoint& point : after.shapes[i].points)
      nearest = std::min(nearest, (point.at - before.shapes[i].points[0].at).norm());
    EXPECT_LT(nearest, 1e-15);
  }
  EXPECT_EQ(pair_names(after), pair_names(before));
  EXPECT_EQ(after.expressions[0].expression, before.expressions[0].expression);
  EXPECT_EQ(json::parse(to_json(after).dump()), written);
}

TEST(Meshes, AreReadFromBothFormsOfStlAndFromObj) {
  const auto folder = std::filesystem::temp_directory_path();
  const auto put = [&](const std::string& name, const std::string& content) {
    const auto path = folder / (std::to_string(getpid()) + name);
    std::ofstream(path, std::ios::binary) << content;
    return path;
  };
  std::string binary(84, '\0');
  binary[80] = 1;
  const float numbers[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2, 0};
  binary.append(reinterpret_cast<const char*>(numbers), sizeof numbers).append(2, '\0');
  for (const auto& path :
       {put("a.stl",
            "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 "
            "0\nendloop\nendfacet\nendsolid\n"),
        put("b.stl", binary), put("c.OBJ", "# one\nv 0 0 0\nv 1 0 0\nv 0 2 0\nf 1/1 2/1 -1/1\n")}) {
    std::string error;
    const auto mesh = read_mesh(path, error);
    ASSERT_TRUE(mesh) << path << error;
    ASSERT_EQ(mesh->triangles.size(), 1u);
    EXPECT_EQ(mesh->vertices[mesh->triangles[0][2]], Vector3(0, 2, 0));
    std::filesystem::remove(path);
  }
}

/// The diagnostics of a delta-1 with these shapes and limits added.
std::vector<Diagnostic> mistakes(const char* additions) {
  try {
    static_cast<void>(machine("delta-1", additions));
  } catch (const InputError& error) {
    return error.diagnostics();
  }
  return {};
}

struct Case {
  const char* additions;
  const char* pointer;
  const char* rule;
  const char* word;
};

TEST(Mistakes, InShapesAndLimitsAreToldWithTheNearestWord) {
  const std::vector<Case> cases{
      {R"({"shapes": [{"of": "leg1.rod_c"}]})", "/shapes/0/of", "must mean a body or a slide",
       "leg1.rod_a"},
      {R"({"shapes": [{"of": "leg1.rod_a", "diamter": 3}]})", "/shapes/0/diamter",
       "has no meaning here", "diameter"},
      {R"({"shapes": [{"of": "leg1.rod_a", "diameter": -3}]})", "/shapes/0/diameter",
       "must not be negative", ""},
      {R"({"shapes": [{"of": "leg1.rod_a", "trim": 128}]})", "/shapes/0/trim",
       "half the length of \"leg1.rod_a\"", ""},
      {R"({"shapes": [{"of": "platform", "trim": 1}]})", "/shapes/0/trim", "only lines", ""},
      {R"({"shapes": [{"of": "leg", "points": [[0, 0, 0]]}]})", "/shapes/0/points",
       "can be given for one body only, and \"leg\" means 12", ""},
      {R"({"shapes": [{"of": "platform", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]}]})",
       "/shapes/0/points", "must lie in one plane", ""},
      {R"({"shapes": [{"of": "platform", "form": "line"}]})", "/shapes/0/form",
       "must lie on one line", ""},
      {R"({"shapes": [{"of": "leg1.rod_a", "form": "plate"}]})", "/shapes/0/form",
       "must not lie on one line", ""},
      {R"({"shapes": [{"of": "leg1.guide", "points": [[0, 0, 0]]}]})", "/shapes/0/points",
       "has two points", ""},
      {R"({"shapes": [{"of": "platform", "mesh": "none.stl"}]})", "/shapes/0/mesh",
       "there is no such file", ""},
      {R"({"shapes": [{"of": "platform", "mesh": "none.step"}]})", "/shapes/0/mesh",
       "must end in .stl or .obj", ""},
      {R"({"shapes": [{"of": "platform", "turn": 3}]})", "/shapes/0/turn", "for meshes only", ""},
      {R"({"limits": [{"name": "x", "clearance": 3}]})", "/limits/2", "give \"shapes\"", ""},
      {R"({"shapes": [{"of": "leg*.rod_*"}], "limits": [{"name": "x", "clearance": -3}]})",
       "/limits/2/clearance", "must not be negative", ""},
      {R"({"shapes": [{"of": "leg*.rod_*"}],
           "limits": [{"name": "x", "clearance": 3, "between": ["leg1.rud_a", "leg2"]}]})",
       "/limits/2/between/0", "must mean a body or a slide that has a shape", "leg1.rod_a"},
      {R"({"shapes": [{"of": "leg*.rod_*"}],
           "limits": [{"name": "x", "clearance": 3, "between": ["leg1", "platform"]}]})",
       "/limits/2/between/1", "has no shape: give it one under \"shapes\"", ""},
      {R"({"shapes": [{"of": "leg*.rod_*"}, {"of": "platform"}],
           "limits": [{"name": "x", "clearance": 3, "between": ["leg1", "platform"]}]})",
       "/limits/2/between", "joints connect them all", ""},
      {R"({"shapes": [{"of": "leg*.rod_*"}], "limits": [{"name": "x", "clearance": 3,
           "inside": [{"normal": [0, 0, 1], "offset": 0}]}]})",
       "/limits/2", "exactly one of these must be given: inside, clearance, expression", ""},
      {R"({"limits": [{"name": "x", "expression": "z", "max": 3, "body": "platform"}]})",
       "/limits/2/body", "has no meaning beside \"expression\"", ""},
      {R"({"limits": [{"name": "x", "expression": "leg1.guid + z", "max": 3}]})",
       "/limits/2/expression", "\"leg1.guid\" is neither a coordinate of the pose", "leg1.guide"},
      {R"({"limits": [{"name": "x", "expression": "q4", "max": 3}]})", "/limits/2/expression",
       "neither a coordinate of the pose", ""},
      {R"({"limits": [{"name": "x", "expression": "a + 1", "max": 3}]})", "/limits/2/expression",
       "\"a\" is a parameter or a joint and also a word for the pose", ""},
      {R"({"limits": [{"name": "x", "expression": "(z", "max": 3}]})", "/limits/2/expression",
       "Missing parenthesis", ""},
      {R"({"limits": [{"name": "x", "expression": "z"}]})", "/limits/2",
       "must have a \"min\", a \"max\" or both", ""},
      {R"({"limits": [{"name": "x", "expression": "z", "min": 3, "max": 2}]})", "/limits/2",
       "min must not be greater than max", ""},
      {R"({"limits": [{"name": "table", "expression": "z", "max": 2}]})", "/limits/2/name",
       "given twice", ""}};
  for (const Case& one : cases) {
    const auto told = mistakes(one.additions);
    const bool found = std::ranges::any_of(told, [&](const Diagnostic& mistake) {
      return mistake.file == "f" && mistake.pointer == one.pointer &&
             mistake.rule.find(one.rule) != std::string::npos &&
             (*one.word == 0 || mistake.hint == "did you mean \"" + std::string(one.word) + "\"?");
    });
    EXPECT_TRUE(found) << one.additions;
    if (!found)
      for (const Diagnostic& mistake : told) ADD_FAILURE() << to_string(mistake);
    EXPECT_EQ(told.size(), 1u) << one.additions;
  }
}

}  // namespace
}  // namespace polyglide
