#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "support/run_program.hpp"

namespace polyglide::test {
namespace {

using nlohmann::json;

/// Wrong input must end with status 1, say so on stderr and print no result.
void expect_refused(const ProgramResult& result, const std::string& message) {
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(has(result.err, message)) << result.err;
  EXPECT_FALSE(has(result.err, "internal error")) << result.err;
}

TEST(CommandLine, HelpListsCommandsOnStandardOutput) {
  const ProgramResult dut = run_polyglide({"--help"});
  EXPECT_EQ(dut.status, 0);
  EXPECT_EQ(dut.err, "");
  EXPECT_TRUE(has(dut.out, "catalog"));
  EXPECT_EQ(run_polyglide({"help"}).out, dut.out);
}

TEST(CommandLine, VersionIsOneLine) {
  const ProgramResult dut = run_polyglide({"--version"});
  EXPECT_EQ(dut.status, 0);
  EXPECT_TRUE(std::regex_match(dut.out, std::regex(R"(polyglide \d+\.\d+\.\d+\n)"))) << dut.out;
}

TEST(CommandLine, NothingTypedShowsTheHelpAndFails) {
  const ProgramResult dut = run_polyglide({});
  expect_refused(dut, "Usage: polyglide COMMAND");
}

TEST(CommandLine, AnUnknownCommandIsAnsweredWithTheNearest) {
  expect_refused(run_polyglide({"catalgo"}), "did you mean catalog?");
  expect_refused(run_polyglide({"zzzzzzzz"}), "has no such command");
}

TEST(CommandLine, AllUnknownOptionsAreNamedAtOnceWithTheNearest) {
  const ProgramResult dut = run_polyglide({"catalog", "--jsn", "--thread=2"});
  expect_refused(dut, "did you mean --json?");
  expect_refused(dut, "did you mean --threads?");
}

TEST(CommandLine, AMissingArgumentIsNamedBesideAnUnknownOption) {
  const ProgramResult dut = run_polyglide({"export", "four-bar", "--qiet"});
  expect_refused(dut, "--as is required");
  expect_refused(dut, "did you mean --quiet?");
}

TEST(CommandLine, CommonOptionsRefuseWhatIsNotOfTheirKind) {
  expect_refused(run_polyglide({"catalog", "--threads", "0"}), "--threads");
  expect_refused(run_polyglide({"catalog", "--threads", "many"}), "--threads");
  expect_refused(run_polyglide({"catalog", "--seed", "-1"}), "--seed");
}

TEST(CommandLine, AResultThatCannotBePrintedIsNoSuccess) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
  EXPECT_EQ(run_polyglide({"--help"}, "/dev/full").status, 1);
}

// The README shows every command there is, and no other.
TEST(CommandLine, ReadmeHasAnExampleOfEveryCommand) {
  std::set<std::string> listed, shown;
  std::istringstream help(run_polyglide({"--help"}).out);
  for (std::string line; std::getline(help, line);) {
    std::smatch match;
    if (std::regex_search(line, match, std::regex("^  ([a-z]+)  "))) listed.insert(match[1]);
  }
  std::ifstream readme(POLYGLIDE_SOURCE_DIR "/README.md");
  for (std::string line; std::getline(readme, line);) {
    std::smatch match;
    if (std::regex_search(line, match, std::regex("^polyglide ([a-z]+)"))) shown.insert(match[1]);
  }
  EXPECT_EQ(listed, shown);
}

TEST(CatalogCommand, ListsEveryEntryWithDrivesAndParameters) {
  const ProgramResult dut = run_polyglide({"catalog", "--json"});
  ASSERT_EQ(dut.status, 0) << dut.err;
  const json list = json::parse(dut.out);
  ASSERT_TRUE(list.is_array());
  std::set<std::string> names;
  for (const json& entry : list) {
    names.insert(entry.at("name"));
    EXPECT_NE(entry.at("source"), "") << entry.at("name");
    EXPECT_GT(entry.at("drives").at("count"), 0) << entry.at("name");
    EXPECT_TRUE(entry.at("parameters").is_array());
  }
  for (const char* name : {"table1-1", "table1-2", "table1-3", "table1-4", "table1-5", "table1-6",
                           "delta-1", "tripod-70", "hexapod-6ups", "3-prp", "3-rps",
                           "hybrid-3prp-3rps", "four-bar", "bennett", "sarrus"}) {
    EXPECT_TRUE(names.contains(name)) << name;
    EXPECT_TRUE(has(run_polyglide({"catalog"}).out, name)) << name;
  }
}

TEST(CatalogCommand, OneNameGivesAnObjectSeveralGiveAnArrayInTheirOrder) {
  const json one = json::parse(run_polyglide({"catalog", "four-bar", "--json"}).out);
  EXPECT_EQ(one.at("name"), "four-bar");
  const json two = json::parse(run_polyglide({"catalog", "sarrus", "bennett", "--json"}).out);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].at("name"), "sarrus");
  EXPECT_EQ(two[1].at("name"), "bennett");
}

TEST(CatalogCommand, MistakesInSeveralNamesAreReportedTogether) {
  const ProgramResult dut = run_polyglide({"catalog", "delta1", "four-bra", "--set", "a"});
  expect_refused(dut, "delta-1");
  expect_refused(dut, "four-bar");
  expect_refused(dut, "--set takes parameter=value");
}

TEST(ExportCommand, WritesAMechanismThatReadsBackAsItself) {
  const ProgramResult exported = run_polyglide({"export", "delta-1", "--as", "mechanism"});
  ASSERT_EQ(exported.status, 0) << exported.err;
  EXPECT_EQ(json::parse(exported.out).at("format"), "polyglide/mechanism/1");
  const TemporaryFolder folder;
  const std::string file = folder.write("copy.json", exported.out);
  EXPECT_EQ(run_polyglide({"export", file, "--as", "mechanism"}).out, exported.out);
}

TEST(ExportCommand, ASettingChangesTheMachine) {
  const auto with = [](const std::string& setting) {
    return run_polyglide({"export", "delta-1", "--as", "mechanism", "--set", setting});
  };
  EXPECT_EQ(with("a=256").status, 0) << with("a=256").err;
  EXPECT_NE(with("a=256").out, with("a=260").out);
  expect_refused(with("no_such_dimension=1"), "no_such_dimension");
  expect_refused(with("a=wide"), "finite number");
}

TEST(ExportCommand, WritesIntoAFileAndPrintsNothingElse) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "deeper" / "four-bar.json").string();
  const ProgramResult dut = run_polyglide({"export", "four-bar", "--as", "mechanism", "-o", file});
  EXPECT_EQ(dut.status, 0) << dut.err;
  EXPECT_EQ(dut.out, "");
  EXPECT_TRUE(has(dut.err, file));
  std::ifstream stream(file);
  EXPECT_EQ(json::parse(stream).at("name"), "four-bar");
}

TEST(ExportCommand, AnUnknownFormatIsAnsweredWithTheKnownOnes) {
  expect_refused(run_polyglide({"export", "four-bar", "--as", "mechansm"}),
                 "did you mean mechanism?");
}

TEST(ExportCommand, MjcfIsPrintedAsXmlOrWrappedInJson) {
  const ProgramResult xml = run_polyglide({"export", "four-bar", "--as", "mjcf"});
  EXPECT_EQ(xml.status, 0) << xml.err;
  EXPECT_TRUE(has(xml.out, "<mujoco model=\"four-bar\">"));
  const ProgramResult wrapped = run_polyglide({"export", "four-bar", "--as", "mjcf", "--json"});
  EXPECT_EQ(json::parse(wrapped.out), (json{{"mjcf", xml.out}}));
}

TEST(ExportCommand, SeveralMachinesFitIntoJsonButNotIntoOneXmlText) {
  const ProgramResult dut =
      run_polyglide({"export", "four-bar", "bennett", "--as", "mjcf", "--json"});
  EXPECT_EQ(dut.status, 0) << dut.err;
  ASSERT_EQ(json::parse(dut.out).size(), 2u);
  EXPECT_TRUE(has(json::parse(dut.out)[1].at("mjcf"), "bennett"));
  expect_refused(run_polyglide({"export", "four-bar", "bennett", "--as", "mjcf"}),
                 "one machine at a time");
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "two.xml").string();
  expect_refused(run_polyglide({"export", "four-bar", "bennett", "--as", "mjcf", "-o", file}),
                 "one machine at a time");
  EXPECT_FALSE(std::ifstream(file));
}

TEST(ExportCommand, UrdfGoesIntoAFileWithItsLoopsBesideIt) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "robot.urdf").string();
  const ProgramResult dut = run_polyglide({"export", "delta-1", "--as", "urdf", "-o", file});
  EXPECT_EQ(dut.status, 0) << dut.err;
  EXPECT_EQ(dut.out, "");
  EXPECT_TRUE(has(dut.err, "robot.yaml"));
  const auto text = [](const std::string& path) {
    std::ifstream stream(path);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const std::string yaml = (folder.path() / "robot.yaml").string();
  const json wrapped =
      json::parse(run_polyglide({"export", "delta-1", "--as", "urdf", "--json"}).out);
  EXPECT_EQ(wrapped, (json{{"urdf", text(file)}, {"yaml", text(yaml)}}));
  EXPECT_TRUE(has(text(yaml), "name_mot: ['leg1.guide', 'leg2.guide', 'leg3.guide']"));
  EXPECT_EQ(
      json::parse(run_polyglide({"export", "delta-1", "--as", "urdf", "-o", file, "--json"}).out),
      (json{{"written", file}, {"beside", yaml}}));
}

TEST(ExportCommand, UrdfOnStandardOutputSaysThatTheLoopsAreMissing) {
  const ProgramResult dut = run_polyglide({"export", "delta-1", "--as", "urdf"});
  EXPECT_EQ(dut.status, 0);
  EXPECT_TRUE(has(dut.out, "<robot name=\"delta-1\">"));
  EXPECT_TRUE(has(dut.err, "with -o FILE the closed loops"));
  EXPECT_EQ(run_polyglide({"export", "delta-1", "--as", "urdf", "--quiet"}).err, "");
}

TEST(ExportCommand, ThePlaceOfTheLoopsIsNotGivenToTheTree) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "robot.yaml").string();
  expect_refused(run_polyglide({"export", "delta-1", "--as", "urdf", "-o", file}), ".yaml");
  EXPECT_FALSE(std::ifstream(file));
}

TEST(BadFile, IsRefusedWithItsNameAndStatusOne) {
  const TemporaryFolder folder;
  const auto refuse = [&](const std::string& text, const std::string& message) {
    const std::string file = folder.write("bad.json", text);
    const ProgramResult result = run_polyglide({"catalog", file});
    expect_refused(result, message);
    expect_refused(result, file);
  };
  refuse("", "empty");
  refuse("this is not JSON", "JSON");
  refuse(R"({"format": "polyglide/mechanism/1", "format": "polyglide/layout/1"})", "format");
  refuse(std::string(50'000'000, '['), "deep");
  refuse(R"({"format": "polyglide/mechansim/1"})", "polyglide/mechanism/1");
  expect_refused(run_polyglide({"catalog", (folder.path() / "absent.json").string()}),
                 "absent.json");
  expect_refused(run_polyglide({"catalog", folder.path().string() + "/"}), folder.path().string());
}

}  // namespace
}  // namespace polyglide::test
