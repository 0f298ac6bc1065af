// What no machine can do, asked of every machine of the catalog: a clear answer, in time.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/run_program.hpp"

namespace polyglide::test {
namespace {

using nlohmann::json;

const json& catalog() {
  static const json entries = json::parse(run_polyglide({"catalog", "--json"}).out);
  return entries;
}

/// A command over all machines of the catalog.
std::vector<std::string> for_all(const std::string& command, const std::vector<std::string>& rest) {
  std::vector<std::string> words{command};
  for (const json& entry : catalog()) words.push_back(entry.at("name"));
  words.insert(words.end(), rest.begin(), rest.end());
  return words;
}

/// The same drive position for every drive of a machine.
std::string drives_at(const json& entry, const std::string& position) {
  std::string text = position;
  for (int i = 1; i < entry.at("drives").at("count"); ++i) text += "," + position;
  return text;
}

void expect_refused(const std::vector<std::string>& words, const std::string& message) {
  const ProgramResult result = run_polyglide(words);
  EXPECT_EQ(result.status, 1) << words[0] << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(has(result.err, message)) << message << " not in " << result.err;
  EXPECT_FALSE(has(result.err, "internal error")) << result.err;
}

TEST(BadInput, IsRefusedWithItsRuleWhateverTheMachine) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> table{
      {for_all("pose", {"--ik", "nan,0,0"}), "--ik takes finite numbers"},
      {for_all("pose", {"--ik", "1e400,0,0"}), "--ik takes finite numbers"},
      {for_all("pose", {"--ik", "1,2"}), "--ik takes x,y,z or x,y,z,a,b,c"},
      {for_all("pose", {"--ik", "0,0,0", "--to", "inf,0,0"}), "--to takes finite numbers"},
      {for_all("pose", {"--fk", "1,2,3,4,5,6,7,8,9"}), "--fk takes one number per drive"},
      {for_all("pose", {}), "pose needs --ik x,y,z[,a,b,c] or --fk q1,q2"},
      {for_all("workspace", {"--certify"}), "--certify needs --box"},
      {for_all("workspace", {"--box", "0,1,1"}), "--box takes 3 positive lengths"},
      {for_all("workspace", {"--accuracy", "1e-20"}),
       "\"1e-20\" — --accuracy takes a number from 1e-12 to 0.1"},
      {for_all("check", {"--set", "no-such=1"}), "has no parameter of this name"},
      {for_all("check", {"--set", "a=nan"}), "--set takes one finite number"},
      {for_all("check", {"--seed", "-3"}), "\"-3\" — --seed takes a whole number from 0 on"},
      {for_all("check", {"--threads", "0"}),
       "\"0\" — --threads takes a whole number from 1 to 4096"},
      {for_all("check", {"--threads"}), "--threads takes a value"},
      {for_all("export", {"--as", "step"}), "--as takes one of: mechanism, mjcf, urdf"},
      {{"catalog", "--drives", "x"}, "\"x\" — --drives takes a whole number from 0 on"},
      {{"catalog", "--json=x"}, "\"x\" — no value for --json"},
      {{"check", "delta-1", "--set", "no-such=1"}, "; it has "},
  };
  for (const auto& [words, message] : table) expect_refused(words, message);
}

TEST(BadInput, AFarPoseIsOutOfReachAndTheSearchForItEnds) {
  for (const char* far : {"1e6,1e6,1e6", "1e300,0,0"}) {
    const ProgramResult result = run_polyglide(for_all("pose", {"--ik", far, "--json"}));
    ASSERT_EQ(result.status, 0) << result.err;
    for (const json& answer : json::parse(result.out)) {
      // Machines that command less than three translations keep them dependent.
      const bool there = std::abs(answer.at("pose").at("position")[0].get<double>()) > 1;
      EXPECT_TRUE(!answer.at("reachable") || answer.at("limit").is_null()) << answer.at("name");
      if (!answer.at("reachable")) {
        EXPECT_NE(answer.at("limit"), "") << answer.at("name") << there;
      }
    }
  }
}

TEST(BadInput, FarDrivesFindNothingAndTheSearchForThemEnds) {
  for (const json& entry : catalog()) {
    const ProgramResult result =
        run_polyglide({"pose", entry.at("name"), "--fk", drives_at(entry, "1e300"), "--json"});
    EXPECT_EQ(result.status, 0) << entry.at("name") << result.err;
    EXPECT_EQ(json::parse(result.out).at("count"), 0) << entry.at("name");
  }
}

TEST(BadInput, DrivesBeyondTheirStrokeAreSaidToBe) {
  const ProgramResult page = run_polyglide({"pose", "delta-1", "--fk", "500,0,0"});
  EXPECT_EQ(page.status, 0);
  EXPECT_TRUE(has(page.out, "beyond stroke leg1.guide max")) << page.out;
  EXPECT_TRUE(has(page.out, "0 assembly modes")) << page.out;  // it would have to turn
  const json within =
      json::parse(run_polyglide({"pose", "delta-1", "--fk", "5,0,0", "--json"}).out);
  EXPECT_TRUE(within.at("limit").is_null());
  EXPECT_EQ(within.at("count"), 1);
}

TEST(BadInput, CoordinatesThatCannotBeCommandedAreNamed) {
  const ProgramResult result = run_polyglide({"pose", "2-ups-u", "--ik", "10,0,0"});
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(has(result.out, "X cannot be commanded here")) << result.out;
}

TEST(BadInput, AMisspeltLimitIsRemarkedOn) {
  const ProgramResult result =
      run_polyglide({"pose", "delta-1", "--ik", "0,0,0", "--ignore-limits", "strok"});
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(has(result.err, "delta-1 has no limit strok")) << result.err;
}

/// A joint of a file as text.
std::string joint(const std::string& name, const std::string& type, const std::string& between,
                  const std::string& more) {
  return R"({"name":")" + name + R"(","type":")" + type + R"(","between":)" + between + more + "}";
}

std::string machine(const std::string& joints) {
  return R"({"format":"polyglide/mechanism/1","name":"still","base":"g","platform":"p",)"
         R"("joints":[)" +
         joints + "]}";
}

TEST(BadInput, MachinesThatCannotMoveAreStillAnswered) {
  const std::string line = R"(,"axis":[0,0,1],"at":)";
  const std::vector<std::string> files{
      machine(joint("a", "weld", R"(["g","p"])", "")),
      machine(joint("a", "revolute", R"(["g","x"])", line + R"([0,0,0],"drive":true)") + "," +
              joint("b", "revolute", R"(["x","p"])", line + "[0,40,0]") + "," +
              joint("c", "revolute", R"(["p","g"])", line + "[50,0,0]"))};
  for (const std::string& text : files) {
    const TemporaryFolder folder;
    const std::string file = folder.write("still.json", text);
    const ProgramResult checked = run_polyglide({"check", file, "--json"});
    ASSERT_EQ(checked.status, 0) << checked.err;
    EXPECT_EQ(json::parse(checked.out).at("verdict"), "rigid");
    const ProgramResult posed = run_polyglide({"pose", file, "--ik", "0,0,0", "--json"});
    ASSERT_EQ(posed.status, 0) << posed.err;
    EXPECT_EQ(json::parse(posed.out).at("reachable"), true);
    const ProgramResult away = run_polyglide({"pose", file, "--ik", "1,0,0", "--json"});
    EXPECT_EQ(json::parse(away.out).at("reachable"), false);
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"check", file},
          {"workspace", file},
          {"workspace", file, "--certify", "--box", "1,1,1"},
          {"export", file, "--as", "mjcf"},
          {"export", file, "--as", "urdf"},
          {"catalog", file}})
      EXPECT_EQ(run_polyglide(words).status, 0) << words[0] << run_polyglide(words).err;
  }
}

}  // namespace
}  // namespace polyglide::test
