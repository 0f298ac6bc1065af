// Every catalog entry moves as the literature says: tests/truth/catalog.json holds the published
// motion, written down from the sources before the program was asked.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cases.hpp"
#include "catalog/json_file.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

const nlohmann::json& published() {
  static const nlohmann::json kRecords =
      read_json(POLYGLIDE_SOURCE_DIR "/tests/truth/catalog.json");
  return kRecords;
}

class CatalogOfRecord : public testing::TestWithParam<std::string> {};

TEST_P(CatalogOfRecord, MovesAsPublished) {
  ASSERT_TRUE(published().contains(GetParam())) << "tests/truth/catalog.json has no record of it";
  const nlohmann::json& expected = published()[GetParam()];
  const Mechanism mechanism = expand(find_layout(GetParam()));
  const nlohmann::json found = to_json(analyse_mobility(compile(mechanism)), mechanism);
  EXPECT_EQ(found["platform"]["dof"], expected.at("dof"));
  EXPECT_EQ(found["drives"]["count"], expected.at("drives"));
  const auto agrees = [&](const char* key, const nlohmann::json& value) {
    if (expected.contains(key)) {
      EXPECT_EQ(value, expected[key]) << key << " " << found["reasons"];
    }
  };
  agrees("translations", found["platform"]["translations"]);
  agrees("rotations", found["platform"]["rotations"]);
  agrees("axes", found["platform"]["axes"]);
  agrees("mobility", found["mobility"]["finite"]);
  agrees("redundant", found["mobility"]["redundant_constraints"]);
  agrees("verdict", found["verdict"]);
}

INSTANTIATE_TEST_SUITE_P(Catalog, CatalogOfRecord, testing::ValuesIn(catalog_names()), test_name);

TEST(CatalogTruth, HasARecordWithSourceForEveryEntryAndForNothingElse) {
  const auto names = catalog_names();
  EXPECT_GE(names.size(), 70u);
  std::vector<std::string> recorded;
  for (const auto& [name, record] : published().items()) {
    recorded.push_back(name);
    EXPECT_FALSE(record.value("source", "").empty()) << name;
    EXPECT_TRUE(record.contains("dof") && record.contains("drives")) << name;
  }
  EXPECT_EQ(recorded, names);
}

}  // namespace
}  // namespace polyglide
