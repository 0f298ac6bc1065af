#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "kinematics/mesh_tree.hpp"
#include "late_limits.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

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

}  // namespace
}  // namespace polyglide
