#include "report/summary.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "sample.hpp"

namespace polyglide {
namespace {

using fixtures::sample;

TEST(Summary, ShowsTheRankingInTheUnitsPeopleSee) {
  const nlohmann::json run = nlohmann::json::parse(R"({
    "title": "T", "indices": [{"key": "v", "label": "Volume", "unit": "dm³", "scale": 1000}],
    "ranking": [{"rank": 1, "layout": "ab", "known_as": "delta-1", "title": "A | B", "score": 0.123456,
                 "objectives": {"v": 0.0100074}}]})");
  EXPECT_EQ(summary_markdown(run),
            "# T\n\n## Ranking\n\n| rank | layout | id | score | Volume [dm³] |\n"
            "| --- | --- | --- | --- | --- |\n| 1 | A \\| B (delta-1) | `ab` | 0.1235 | 10.01 |\n");
}

TEST(Summary, HoldsEveryPartOfARunButNoTimes) {
  const std::string text = summary_markdown(sample());
  for (const char* words :
       {"## What was asked", "## Counts", "## Ranking", "## Dimensions", "rejected", "## Stability",
        "## leaning guides against vertical guides", "Seed 1."}) {
    EXPECT_NE(text.find(words), std::string::npos) << words;
  }
  for (const char* words : {"12.4", "2026-01-05", "2 cores"}) {
    EXPECT_EQ(text.find(words), std::string::npos) << words;
  }
}

TEST(Summary, TheJsonHasFourDigitsAndNoTimes) {
  const auto out = summary_json(sample());
  EXPECT_EQ(out["format"], "polyglide/summary/1");
  EXPECT_FALSE(out.contains("provenance"));
  EXPECT_EQ(out["ranking"].size(), 4u);
  for (const auto& [key, value] : out["ranking"][0]["objectives"].items()) {
    EXPECT_DOUBLE_EQ(value.get<double>(), std::stod(fmt::format("{:.4g}", value.get<double>())))
        << key;
  }
  EXPECT_FALSE(out["rejected"][0]["examples"][0].contains("scene"));
}

TEST(Summary, AnEmptyRunGivesAnEmptySummary) {
  EXPECT_EQ(summary_markdown(nlohmann::json::object()), "# \n");
  EXPECT_TRUE(summary_json(nlohmann::json::object())["ranking"].empty());
}

}  // namespace
}  // namespace polyglide
