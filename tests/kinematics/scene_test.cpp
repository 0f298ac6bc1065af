#include "kinematics/scene.hpp"

#include <gtest/gtest.h>

#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;
using Json = nlohmann::ordered_json;

Vector3 vector_of(const Json& json) {
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

Transform transform_of(const Json& flat, std::size_t slot) {
  const auto at = [&](int i) { return flat[7 * slot + static_cast<std::size_t>(i)].get<double>(); };
  Transform transform = Transform::Identity();
  transform.linear() =
      Eigen::Quaterniond(at(0), at(1), at(2), at(3)).normalized().toRotationMatrix();
  transform.translation() = Vector3(at(4), at(5), at(6));
  return transform;
}

/// Every body of the scene at one node of the table.
std::vector<Transform> bodies_at(const Json& scene, std::size_t node) {
  std::vector<double> drives(scene["drives"].size());
  std::size_t rest = node;
  for (std::size_t d = drives.size(); d-- > 0;) {
    const Json& samples = scene["drives"][d]["samples"];
    drives[d] = samples[rest % samples.size()];
    rest /= samples.size();
  }
  std::vector<Transform> bodies;
  std::size_t slot = 0;
  for (const Json& body : scene["bodies"]) {
    Transform transform = Transform::Identity();
    if (body["motion"] == "table")
      transform = transform_of(scene["poses"][node], slot++);
    else if (body["motion"].is_object())
      transform.translation() = vector_of(body["motion"]["direction"]) *
                                drives[body["motion"]["drive"].get<std::size_t>()];
    bodies.push_back(transform);
  }
  return bodies;
}

TEST(Scene, DeltaOneHasCarriagesThatFollowDrivesAndAPlatformFromTheTable) {
  const Json scene = scene_of(catalog_machine("delta-1"));
  ASSERT_EQ(scene["bodies"].size(), 5u);
  EXPECT_EQ(scene["bodies"][0]["motion"], "fixed");
  EXPECT_EQ(scene["bodies"][1]["motion"]["drive"], 0);
  EXPECT_EQ(scene["bodies"][scene["platform"].get<std::size_t>()]["motion"], "table");
  std::map<std::string, int> roles;
  for (const Json& segment : scene["segments"]) ++roles[segment["role"].get<std::string>()];
  EXPECT_EQ(roles["guide"], 3);
  EXPECT_EQ(roles["rod"], 6);
  EXPECT_EQ(roles["platform"], 6);
  EXPECT_EQ(scene["joints"].size(), 15u);
}

TEST(Scene, APictureIsTheSceneWithoutWhatMovesIt) {
  const Machine machine = catalog_machine("table1-6");
  const Json scene = scene_of(machine), picture = picture_of(machine);
  EXPECT_EQ(picture.size(), 2u);
  for (const char* part : {"bodies", "segments"}) EXPECT_EQ(picture.at(part), scene.at(part));
}

TEST(Scene, RodsKeepTheirLengthInEveryTabulatedPose) {
  for (const char* name : {"delta-1", "table1-6", "four-bar", "3-prp", "bennett"}) {
    const Json scene = scene_of(catalog_machine(name), 200);
    int moved = 0;
    for (std::size_t node = 0; node < scene["poses"].size(); ++node) {
      if (scene["poses"][node].is_null()) continue;
      const std::vector<Transform> bodies = bodies_at(scene, node);
      for (const Json& segment : scene["segments"]) {
        if (segment["role"] == "strut") continue;
        const Vector3 a = vector_of(segment["from"]["at"]), b = vector_of(segment["to"]["at"]);
        const Vector3 a_now = bodies[segment["from"]["body"].get<std::size_t>()] * a;
        const Vector3 b_now = bodies[segment["to"]["body"].get<std::size_t>()] * b;
        EXPECT_NEAR((b_now - a_now).norm(), (b - a).norm(), 3e-6) << name << " " << segment["name"];
        ++moved;
      }
    }
    EXPECT_GT(moved, 0) << name;
  }
}

TEST(Scene, TheTableHasOnePosePerCombinationAndHomeIsUnmoved) {
  for (const char* name : {"tripod-70", "hexapod-6ups", "3-rps", "table1-1"}) {
    const Json scene = scene_of(catalog_machine(name), 800);
    std::size_t product = 1, home = 0;
    for (const Json& drive : scene["drives"]) {
      const auto samples = drive["samples"].get<std::vector<double>>();
      const auto zero = std::find(samples.begin(), samples.end(), 0.0);
      ASSERT_NE(zero, samples.end()) << name;
      product *= samples.size();
      home = home * samples.size() + static_cast<std::size_t>(zero - samples.begin());
    }
    EXPECT_LE(product, 800u) << name;
    ASSERT_EQ(scene["poses"].size(), product) << name;
    EXPECT_EQ(scene["poses"][home], Json({1, 0, 0, 0, 0, 0, 0})) << name;
  }
}

TEST(Scene, StrutsRunFromBaseToPlatformAndNameTheirDrive) {
  const Json scene = scene_of(catalog_machine("hexapod-6ups"), 64);
  int struts = 0;
  for (const Json& segment : scene["segments"]) {
    if (segment["role"] != "strut") continue;
    EXPECT_EQ(segment["from"]["body"], 0);
    EXPECT_EQ(segment["to"]["body"], scene["platform"]);
    EXPECT_EQ(segment["drive"], struts);
    ++struts;
  }
  EXPECT_EQ(struts, 6);
}

TEST(Scene, AModeAddsAFrameForEveryShownBody) {
  const Machine machine = catalog_machine("tripod-70");
  Json scene = scene_of(machine, 27);
  FreedomMode mode;
  mode.about = "test";
  mode.frames.assign(3, home(machine.model).bodies);
  add_mode(scene, mode, machine.model.mechanism);
  ASSERT_EQ(scene["mode"]["frames"].size(), 3u);
  EXPECT_EQ(scene["mode"]["frames"][0].size(), scene["bodies"].size());
  EXPECT_EQ(scene["mode"]["frames"][0][0], Json({1, 0, 0, 0, 0, 0, 0}));

  Mechanism other = machine.model.mechanism;
  other.bodies[1] = "stranger";
  EXPECT_THROW(add_mode(scene, mode, other), std::invalid_argument);
}

TEST(Scene, TheNumberOfNodesMustBePositive) {
  EXPECT_THROW(static_cast<void>(scene_of(catalog_machine("four-bar"), 0)), std::invalid_argument);
}

}  // namespace
}  // namespace polyglide
