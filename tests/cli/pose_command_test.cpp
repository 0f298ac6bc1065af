#include <cmath>

#include "answer.hpp"

// What `pose` says beside drives and poses, and what it refuses.
namespace polyglide::test {
namespace {

using nlohmann::json;

void expect_pose_refused(const std::vector<std::string>& words, const std::string& rule) {
  const ProgramResult dut = run_polyglide(words);
  EXPECT_EQ(dut.status, 1) << dut.out;
  EXPECT_TRUE(has(dut.err, rule)) << dut.err;
}

TEST(PoseCommand, InverseAndForwardAgreeAboutTheIndicesOfAPose) {
  for (const char* name : {"delta-1", "hexapod-6ups", "3-rps", "3-rrr-planar", "five-bar"}) {
    const bool vertical = std::string(name) != "five-bar" && std::string(name) != "3-rrr-planar";
    const json there = answer({"pose", name, vertical ? "--ik=0,0,5" : "--ik=5,3,0"});
    ASSERT_TRUE(there.at("reachable").get<bool>()) << name;
    std::string drives;
    const bool turning = !vertical;  // angles in degrees, lengths in mm
    for (const json& drive : there.at("drives"))
      drives += (drives.empty() ? "" : ",") +
                std::to_string(drive.get<double>() * (turning ? 180 / M_PI : 1000));
    const json back = answer({"pose", name, "--fk=" + drives}).at("solutions").at(0);
    for (const char* key : {"condition", "characteristic_length"})
      EXPECT_NEAR(back.at(key).get<double>() / there.at(key).get<double>(), 1, 1e-4)
          << name << " " << key;
    const json &a = back.at("stiffness").at("translation"),
               &b = there.at("stiffness").at("translation");
    EXPECT_EQ(a.at("unit"), "N/m");
    EXPECT_NEAR(a.at("min").get<double>() / b.at("min").get<double>(), 1, 1e-3) << name;
    EXPECT_LE(a.at("min").get<double>(), a.at("max").get<double>());
  }
}

TEST(PoseCommand, TellsPeopleHowStiffAMachineIs) {
  const ProgramResult plain = run_polyglide({"pose", "hexapod-6ups", "--ik", "0,0,5"});
  EXPECT_TRUE(has(plain.out, "condition number ")) << plain.out;
  EXPECT_FALSE(has(plain.out, "stiffness")) << plain.out;
  const ProgramResult stiff =
      run_polyglide({"pose", "hexapod-6ups", "--ik", "0,0,5", "--drive-stiffness", "2e7"});
  EXPECT_TRUE(has(stiff.out, "stiffness against forces ")) << stiff.out;
  EXPECT_TRUE(has(stiff.out, "stiffness against moments ")) << stiff.out;
}

TEST(PoseCommand, AFiveBarGoesWhereItsToolIsSent) {
  const json dut = answer({"pose", "five-bar", "--ik", "10,20,0"});
  EXPECT_EQ(dut.at("axes"), "XY");
  EXPECT_NEAR(dut.at("pose").at("position").at(0).get<double>(), 0.01, 1e-12);
  EXPECT_NEAR(dut.at("pose").at("position").at(1).get<double>(), 0.02, 1e-12);
  EXPECT_TRUE(dut.at("stiffness").at("rotation").is_null());
}

TEST(PoseCommand, ASingularPoseHasNoConditionNumber) {
  const json dut = answer({"pose", "griffis-duffy", "--ik", "0,0,0"});
  EXPECT_TRUE(dut.at("condition").is_null()) << dut.at("condition");
}

TEST(PoseCommand, RefusesSpringsThatDoNotFit) {
  expect_pose_refused({"pose", "delta-1", "--ik", "0,0,0", "--drive-stiffness", "nan"},
                      "--drive-stiffness takes a positive number");
  expect_pose_refused({"pose", "delta-1", "--ik", "0,0,0", "--drive-stiffness", "1,2"},
                      "delta-1 has 3");
  expect_pose_refused({"pose", "delta-1", "--ik", "0,0,0", "--rod-stiffness", "-1"},
                      "--rod-stiffness takes a positive number");
  expect_pose_refused({"pose", "3-rps", "--ik", "0,0,0", "--rod-stiffness", "1e7"},
                      "--rod-stiffness is for machines whose legs");
  expect_pose_refused({"pose", "delta-1", "--ik", "0,0,0", "--characteristic-length", "0"},
                      "--characteristic-length takes a positive number");
}

}  // namespace
}  // namespace polyglide::test
