// `check` as users and scripts meet it: every truth case, and the page a person reads.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/run_program.hpp"

namespace polyglide::test {
namespace {

using nlohmann::json;

const std::filesystem::path kTruth = std::filesystem::path(POLYGLIDE_SOURCE_DIR) / "tests/truth";

json expected(const std::string& set) {
  std::ifstream file(kTruth / set / "expected.json");
  return json::parse(file);
}

/// Checks all mechanisms of a truth set in one call.
json check_all(const std::string& set, const json& cases) {
  std::vector<std::string> words{"check", "--json"};
  for (const auto& entry : cases.items())
    words.push_back((kTruth / set / "mechanisms" / (entry.key() + ".json")).string());
  const ProgramResult result = run_polyglide(words);
  EXPECT_EQ(result.status, 0) << result.err;
  return json::parse(result.out);
}

TEST(Check, AgreesWithEveryPublishedMechanism) {
  const json cases = expected("mobility"), found = check_all("mobility", cases);
  ASSERT_EQ(found.size(), cases.size());
  std::size_t i = 0;
  for (const auto& [name, wanted] : cases.items()) {
    const json& report = found[i++];
    if (wanted.contains("verdict")) {
      EXPECT_EQ(report["verdict"], wanted["verdict"]) << name;
    }
    for (const char* group : {"mobility", "platform", "drives"}) {
      const json fields = wanted.value(group, json::object());
      for (const auto& [field, value] : fields.items())
        EXPECT_EQ(report[group][field], value) << name << " " << group << "." << field;
    }
    EXPECT_GE(report["rank_gap"], 1e3) << name;
  }
}

TEST(Check, AgreesWithEveryDatabaseMachine) {
  const json cases = expected("parroblib"), found = check_all("parroblib", cases);
  ASSERT_EQ(found.size(), cases.size());
  std::size_t i = 0;
  for (const auto& [name, wanted] : cases.items()) {
    const json& report = found[i++];
    EXPECT_EQ(report["platform"]["dof"], wanted["expected_platform_dof"]) << name;
    EXPECT_EQ(report["platform"]["translations"], wanted["expected_translations"]) << name;
    EXPECT_EQ(report["platform"]["rotations"], wanted["expected_rotations"]) << name;
    EXPECT_EQ(report["drives"]["locked_platform"], wanted["expected_locked_platform_dof"]) << name;
    EXPECT_EQ(report["drives"]["locked_mobility"], wanted["locked_mobility"]) << name;
    EXPECT_EQ(report["mobility"]["finite"], wanted["mobility"]) << name;
    EXPECT_EQ(report["mobility"]["redundant_constraints"], wanted["redundant_constraints"]) << name;
  }
}

void expect_lines(const std::string& name, const std::vector<std::string>& lines) {
  const ProgramResult result = run_polyglide({"check", name});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const std::string& line : lines)
    EXPECT_NE(result.out.find(line), std::string::npos) << line << "\nnot in\n" << result.out;
}

TEST(Check, PrintsOnePageWithItsEvidence) {
  expect_lines("table1-1", {"table1-1: determinate", "Schoenflies motion", "Redundant constraints",
                            "What each limb bears", "couple about", "force along"});
  expect_lines("table1-2", {"uncertain", "Freedoms that are left", "with drives held at home: "});
  expect_lines("table1-3", {"constraint singularity", "Motion branches that meet at home"});
  expect_lines("3-prp", {"= d(n − g − 1) + Σf + υ − ζ = 3(8 − 9 − 1) + 9 + 0 − 0"});
}

TEST(Check, SaysToWhatPrecisionADrawingWasTaken) {
  // Sarrus: two hinge directions, one of them with nine digits after a turn of 10 degrees.
  std::ifstream file(kTruth / "mobility/mechanisms/sarrus_6R.json");
  json mechanism = json::parse(file);
  for (json& joint : mechanism["joints"]) {
    const double x = joint["axis"][0], y = joint["axis"][1], c = 0.984807753, s = 0.173648178;
    joint["axis"] = {c * x - s * y, s * x + c * y, joint["axis"][2]};
    const double px = joint["at"][0], py = joint["at"][1];
    joint["at"] = {c * px - s * py, s * px + c * py, joint["at"][2]};
  }
  mechanism["joints"][0]["axis"][2] = 2e-9;
  const auto drawn = std::filesystem::temp_directory_path() / "polyglide_drawn_sarrus.json";
  std::ofstream(drawn) << mechanism;
  const ProgramResult result = run_polyglide({"check", "--json", drawn.string()});
  std::filesystem::remove(drawn);
  ASSERT_EQ(result.status, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(report["mobility"]["finite"], 1);
  EXPECT_GT(report["closure"]["noise"], 1e-11);
  EXPECT_LT(report["closure"]["noise"], 1e-7);
  EXPECT_NE(result.out.find("The drawing holds to about"), std::string::npos);
}

}  // namespace
}  // namespace polyglide::test
