// `polyglide catalog` as a search: by motion, drives, limb and words.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "support/run_program.hpp"

namespace polyglide::test {
namespace {

using nlohmann::json;

std::set<std::string> found(std::vector<std::string> words) {
  words.insert(words.begin(), "catalog");
  words.emplace_back("--json");
  const ProgramResult result = run_polyglide(words);
  EXPECT_EQ(result.status, 0) << result.err;
  std::set<std::string> names;
  for (const json& entry : json::parse(result.out)) names.insert(entry.at("name"));
  return names;
}

TEST(CatalogSearch, FindsMachinesByPattern) {
  const auto names = found({"--motion", "3T1R"});
  for (const char* name : {"table1-1", "table1-6", "h4", "par4", "quadrupteron"})
    EXPECT_TRUE(names.contains(name)) << name;
  for (const char* name : {"delta", "tricept", "hexa"}) EXPECT_FALSE(names.contains(name)) << name;
  EXPECT_EQ(found({"--motion", "3t1r"}), names);
}

TEST(CatalogSearch, FindsMachinesByLettersWhicheverTheHorizontalAxis) {
  const auto names = found({"--motion", "XYZA"});
  EXPECT_TRUE(names.contains("table1-1"));  // turns about x
  EXPECT_TRUE(names.contains("table1-6"));  // turns about y in its file
  EXPECT_FALSE(names.contains("par4"));     // turns about z
  EXPECT_EQ(found({"--motion", "AZYX"}), names);
  EXPECT_TRUE(found({"--motion", "XYZC"}).contains("par4"));
}

TEST(CatalogSearch, FindsMachinesByDrives) {
  for (const std::string& name : found({"--drives", "4", "--drive-type", "prismatic"})) {
    const json entry = json::parse(run_polyglide({"catalog", name, "--json"}).out);
    EXPECT_EQ(entry.at("drives").at("count"), 4) << name;
    for (const json& kind : entry.at("drives").at("kinds")) EXPECT_EQ(kind, "prismatic") << name;
  }
  EXPECT_TRUE(found({"--drives", "4", "--drive-type", "prismatic"}).contains("table1-6"));
  EXPECT_TRUE(found({"--drives", "4", "--drive-type", "revolute"}).contains("h4"));
  EXPECT_FALSE(found({"--drives", "4", "--drive-type", "prismatic"}).contains("h4"));
}

TEST(CatalogSearch, FindsMachinesByAWholeLimb) {
  const auto names = found({"--limb", "ups"});
  EXPECT_TRUE(names.contains("tricept"));
  EXPECT_TRUE(names.contains("gough-platform"));
  EXPECT_FALSE(names.contains("3-upu-tsai"));
  EXPECT_TRUE(found({"--limb", "UP"}).contains("tricept"));
  EXPECT_FALSE(found({"--limb", "UP"}).contains("gough-platform"));  // only as part of UPS
}

TEST(CatalogSearch, FindsMachinesByWordsInAnyOrderOfTheirText) {
  EXPECT_EQ(found({"--search", "adept QUATTRO"}), (std::set<std::string>{"par4", "quattro"}));
  EXPECT_EQ(found({"--search", "gosselin agile"}), std::set<std::string>{"agile-eye"});
}

TEST(CatalogSearch, HoldsAllConditionsTogether) {
  EXPECT_EQ(found({"--motion", "ZAB", "--limb", "PRS"}),
            (std::set<std::string>{"3-prs", "sprint-z3"}));
}

TEST(CatalogSearch, SaysWhatFitsNothingWithTheNearestWordAndIsDone) {
  const ProgramResult word = run_polyglide({"catalog", "--search", "exechn"});
  EXPECT_EQ(word.status, 0);
  EXPECT_EQ(word.out, "");
  EXPECT_TRUE(has(word.err, "--search exechn")) << word.err;
  EXPECT_TRUE(has(word.err, "exechon")) << word.err;
  const ProgramResult limb = run_polyglide({"catalog", "--limb", "UPRS", "--json"});
  EXPECT_EQ(limb.status, 0);
  EXPECT_EQ(json::parse(limb.out), json::array());
  EXPECT_TRUE(has(limb.err, "did you mean")) << limb.err;
  const ProgramResult both = run_polyglide({"catalog", "--motion", "3T1R", "--drives", "3"});
  EXPECT_EQ(both.status, 0);
  EXPECT_TRUE(has(both.err, "together")) << both.err;
  EXPECT_EQ(run_polyglide({"catalog", "--drives", "99", "--quiet"}).err, "");
}

TEST(CatalogSearch, RefusesWordsThatCanFitNoMachineAllAtOnce) {
  const ProgramResult dut = run_polyglide({"catalog", "--motion", "3T1", "--drive-type", "prismatc",
                                           "--limb", "PQR", "--drives", "-1"});
  EXPECT_EQ(dut.status, 1);
  EXPECT_EQ(dut.out, "");
  for (const char* part : {"3T1R", "did you mean prismatic", "--limb", "--drives"})
    EXPECT_TRUE(has(dut.err, part)) << dut.err;
  EXPECT_EQ(run_polyglide({"catalog", "--motion", "XX"}).status, 1);
  EXPECT_EQ(run_polyglide({"catalog", "--drives", "four"}).status, 1);
}

TEST(CatalogSearch, TellsMotionAndArchitectureOfEveryEntry) {
  const json list = json::parse(run_polyglide({"catalog", "--json"}).out);
  for (const json& entry : list) {
    EXPECT_EQ(entry.at("motion").get<std::string>().size(), 4u) << entry.at("name");
    EXPECT_FALSE(entry.at("architecture").get<std::string>().empty()) << entry.at("name");
    EXPECT_FALSE(entry.at("axes").get<std::string>().empty()) << entry.at("name");
    EXPECT_EQ(entry.at("drives").at("kinds").size(), entry.at("drives").at("count"));
  }
  const std::string table = run_polyglide({"catalog"}).out;
  for (const char* heading : {"NAME", "MOTION", "DRIVES", "ARCHITECTURE", "TITLE"})
    EXPECT_TRUE(has(table.substr(0, table.find('\n')), heading));
  EXPECT_EQ(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')),
            list.size() + 1);
}

TEST(CatalogSearch, IsTheSameForAnyNumberOfThreads) {
  EXPECT_EQ(run_polyglide({"catalog", "--json", "--threads", "1"}).out,
            run_polyglide({"catalog", "--json"}).out);
}

}  // namespace
}  // namespace polyglide::test
