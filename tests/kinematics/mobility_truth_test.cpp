// Verdicts and counts of machines settled outside the project, one test per case.
// tests/truth/mobility: textbook and published mechanisms; tests/truth/parroblib:
// rebuilt from the public LUH database of parallel robots (MIT licence).

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cases.hpp"
#include "catalog/json_file.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

nlohmann::json checked(const std::string& set, const std::string& name) {
  const Mechanism mechanism = expand(load_layout(kTruth / set / "mechanisms" / (name + ".json")));
  return to_json(analyse_mobility(compile(mechanism)), mechanism);
}

std::vector<std::string> cases(const std::string& set) {
  std::vector<std::string> names;
  const nlohmann::json expected = read_json(kTruth / set / "expected.json");
  for (const auto& entry : expected.items()) names.push_back(entry.key());
  return names;
}

class PublishedMechanism : public testing::TestWithParam<std::string> {};

TEST_P(PublishedMechanism, HasTheExpectedCountsAndVerdict) {
  const nlohmann::json expected = read_json(kTruth / "mobility/expected.json")[GetParam()];
  const nlohmann::json found = checked("mobility", GetParam());
  EXPECT_EQ(found["verdict"], expected["verdict"]) << found["reasons"];
  for (const char* group : {"mobility", "platform", "drives"}) {
    const nlohmann::json fields = expected.value(group, nlohmann::json::object());
    for (const auto& [field, value] : fields.items())
      EXPECT_EQ(found[group][field], value) << group << "." << field;
  }
}

INSTANTIATE_TEST_SUITE_P(Truth, PublishedMechanism, testing::ValuesIn(cases("mobility")),
                         test_name);

class DatabaseMachine : public testing::TestWithParam<std::string> {};

TEST_P(DatabaseMachine, HasTheExpectedFreedomsWithDrivesFreeAndHeld) {
  const nlohmann::json expected = read_json(kTruth / "parroblib/expected.json")[GetParam()];
  const nlohmann::json found = checked("parroblib", GetParam());
  EXPECT_EQ(found["platform"]["dof"], expected["expected_platform_dof"]);
  EXPECT_EQ(found["platform"]["translations"], expected["expected_translations"]);
  EXPECT_EQ(found["platform"]["rotations"], expected["expected_rotations"]);
  EXPECT_EQ(found["drives"]["locked_platform"], expected["expected_locked_platform_dof"]);
  EXPECT_EQ(found["mobility"]["finite"], expected["mobility"]);
  EXPECT_EQ(found["mobility"]["redundant_constraints"], expected["redundant_constraints"]);
}

INSTANTIATE_TEST_SUITE_P(Truth, DatabaseMachine, testing::ValuesIn(cases("parroblib")), test_name);

}  // namespace
}  // namespace polyglide
