#include "synthesis/space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "catalog/diagnostics.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

using testing::end;
using testing::Json;
using testing::limb;
using testing::option;

Json space_of(Json limbs, Json choices = Json::object()) {
  return {{"format", "polyglide/space/1"},
          {"name", "test"},
          {"limbs", std::move(limbs)},
          {"choices", std::move(choices)}};
}

Json choice(const std::string& name) { return {{"choose", name}}; }

Json choice_of(std::initializer_list<const char*> ends) {
  Json options = Json::array();
  for (const char* word : ends) options.push_back(option(word, end(word)));
  return {{"options", options}};
}

std::string mistakes(const Json& document) {
  try {
    (void)parse_space(document, "test.json");
  } catch (const InputError& error) {
    std::string all;
    for (const Diagnostic& diagnostic : error.diagnostics()) all += to_string(diagnostic) + "\n";
    return all;
  }
  return "";
}

TEST(Space, WithoutChoicesHoldsOneLayout) {
  const Space space = parse_space(space_of({limb("a", 0, end("tangential"))}), "test.json");
  EXPECT_EQ(raw_count(space), 1);
  const RawCandidate only = raw_candidate(space, 0);
  EXPECT_TRUE(only.choices.empty());
  EXPECT_EQ(only.layout.at("format"), "polyglide/layout/1");
  EXPECT_FALSE(only.layout.contains("choices"));
  EXPECT_THROW((void)raw_candidate(space, 1), std::out_of_range);
}

TEST(Space, CountsIndependentChoicesAsAProduct) {
  const Json document = space_of(
      {limb("a", 0, choice("one")), limb("b", 90, choice("two")), limb("c", 180, choice("three"))},
      {{"one", choice_of({"x", "y"})},
       {"two", choice_of({"x", "y", "z"})},
       {"three", choice_of({"x", "y", "z", "spherical"})}});
  EXPECT_EQ(raw_count(parse_space(document, "test.json")), 2 * 3 * 4);
}

TEST(Space, CountsANameChosenTwiceOnce) {
  const Json document = space_of({limb("a", 0, choice("ends")), limb("b", 90, choice("ends"))},
                                 {{"ends", choice_of({"x", "y", "z"})}});
  const Space space = parse_space(document, "test.json");
  ASSERT_EQ(raw_count(space), 3);
  for (std::uint64_t i = 0; i < 3; ++i) {
    const Json limbs = raw_candidate(space, i).layout.at("limbs");
    EXPECT_EQ(limbs[0]["rods"]["carriage"], limbs[1]["rods"]["carriage"]);
  }
}

TEST(Space, CountsAChoiceInsideAnOptionOnlyWhereItIsTaken) {
  // outer: spherical (1 way) or universal with an axis of three; limb b has two: (1 + 3)·2.
  Json outer{{"options",
              {option("ball", end("spherical")),
               option("cross", {{"joint", "universal"}, {"axis", choice("axis")}})}}};
  Json axis{{"options", {option("x", "x"), option("y", "y"), option("z", "z")}}};
  const Json document =
      space_of({limb("a", 0, choice("outer")), limb("b", 90, choice("other"))},
               {{"outer", outer}, {"axis", axis}, {"other", choice_of({"x", "z"})}});
  const Space space = parse_space(document, "test.json");
  ASSERT_EQ(raw_count(space), (1 + 3) * 2);
  for (std::uint64_t i = 0; i < raw_count(space); ++i) {
    const auto taken = raw_candidate(space, i).choices;
    EXPECT_EQ(taken.contains("axis"), taken.at("outer") == "cross");
  }
}

TEST(Space, CountsAChoiceReachedFromTwoOptionsOnceWhenBothAreTaken) {
  // Both outer choices may hold the same inner one of three:
  // neither 1, only one 3 + 3, both 3 (not 9).
  const Json cross{{"joint", "universal"}, {"axis", choice("axis")}};
  const Json outer{{"options", {option("ball", end("spherical")), option("cross", cross)}}};
  const Json axis{{"options", {option("x", "x"), option("y", "y"), option("z", "z")}}};
  const Json document =
      space_of({limb("a", 0, choice("outer a")), limb("b", 90, choice("outer b"))},
               {{"outer a", outer}, {"outer b", outer}, {"axis", axis}});
  EXPECT_EQ(raw_count(parse_space(document, "test.json")), 1 + 3 + 3 + 3);
}

TEST(Space, GivesEveryCandidateOnce) {
  const Space space = parse_space(testing::necklace(4, {"x", "z", "spherical"}), "test.json");
  ASSERT_EQ(raw_count(space), 81);
  std::set<std::string> layouts, labels;
  for (std::uint64_t i = 0; i < 81; ++i) {
    const RawCandidate candidate = raw_candidate(space, i);
    EXPECT_EQ(candidate.index, i);
    layouts.insert(candidate.layout.dump());
    labels.insert(Json(candidate.choices).dump());
    EXPECT_EQ(candidate.layout.dump().find("choose"), std::string::npos);
  }
  EXPECT_EQ(layouts.size(), 81);
  EXPECT_EQ(labels.size(), 81);
}

TEST(Space, NamesAChoiceWrittenInPlaceByItsPlace) {
  const Space space = parse_space(testing::necklace(1, {"x", "z"}), "test.json");
  ASSERT_EQ(space.choices.size(), 1);
  EXPECT_EQ(space.choices[0].name, "limbs/0/rods/carriage");
  EXPECT_EQ(raw_candidate(space, 1).choices.at("limbs/0/rods/carriage"), "z");
}

TEST(Space, DropsParametersACandidateDoesNotUse) {
  Json document = space_of({limb("a", 0, end("tangential"))});
  document["parameters"] = {{"lean", {{"value", 70}}}, {"rod", {{"value", 800}}}};
  document["limbs"][0]["rods"]["length"] = "rod";
  document["limbs"][0]["guide"]["direction"] = {
      {"choose",
       {option("vertical", "z"), option("leaning", {{"lean", "lean"}, {"toward", "radial"}})}}};
  const Space space = parse_space(document, "test.json");
  EXPECT_EQ(raw_candidate(space, 0).layout.at("parameters").size(), 1);
  EXPECT_EQ(raw_candidate(space, 1).layout.at("parameters").size(), 2);
}

TEST(Space, CountsMoreThanCouldEverBeListed) {
  const Space space = parse_space(testing::necklace(20, {"x", "y", "z", "spherical"}), "test.json");
  EXPECT_EQ(raw_count(space), std::uint64_t{1} << 40);
  EXPECT_NO_THROW((void)raw_candidate(space, raw_count(space) - 1));
}

TEST(SpaceMistakes, AnUnknownChoiceComesWithTheNearestName) {
  const std::string said =
      mistakes(space_of({limb("a", 0, choice("carrige"))}, {{"carriage", choice_of({"x"})}}));
  EXPECT_NE(said.find("/limbs/0/rods/carriage/choose"), std::string::npos) << said;
  EXPECT_NE(said.find("carriage"), std::string::npos) << said;
  EXPECT_NE(said.find("did you mean \"carriage\""), std::string::npos) << said;
}

TEST(SpaceMistakes, AllAreToldAtOnce) {
  Json twice = choice_of({"x", "x"});
  const Json document = space_of(
      {limb("a", 0, choice("none")), limb("b", 90, choice("twice")), limb("c", 0, choice("ring"))},
      {{"none", {{"options", Json::array()}}},
       {"twice", twice},
       {"ring", {{"options", {option("again", choice("ring"))}}}}});
  const std::string said = mistakes(document);
  EXPECT_NE(said.find("at least one option"), std::string::npos) << said;
  EXPECT_NE(said.find("same label"), std::string::npos) << said;
  EXPECT_NE(said.find("contain itself"), std::string::npos) << said;
}

TEST(SpaceMistakes, AChoiceMustNotContainItselfByWayOfAnother) {
  const std::string said = mistakes(space_of(
      {limb("a", 0, choice("one"))}, {{"one", {{"options", {option("to", choice("two"))}}}},
                                      {"two", {{"options", {option("fro", choice("one"))}}}}}));
  EXPECT_NE(said.find("contain itself"), std::string::npos) << said;
}

TEST(SpaceMistakes, AWrongWordInsideAnOptionIsFound) {
  const std::string said = mistakes(space_of(
      {limb("a", 0, choice("ends"))},
      {{"ends",
        {{"options", {option("good", end("x")), option("bad", {{"joint", "sphericl"}})}}}}}));
  EXPECT_NE(said.find("ends = bad"), std::string::npos) << said;
  EXPECT_NE(said.find("spherical"), std::string::npos) << said;
}

TEST(SpaceMistakes, AnUnknownKnownEntryIsFound) {
  Json document = space_of({limb("a", 0, end("x"))});
  document["known"] = {"table1-7"};
  EXPECT_NE(mistakes(document).find("/known/0"), std::string::npos) << mistakes(document);
}

TEST(SpaceMistakes, AnEndlessLayoutIsRefusedQuickly) {
  // 40 choices, each holding the next one twice: 2^40 values in a few kilobytes.
  Json choices = Json::object();
  for (int i = 0; i < 40; ++i) {
    const Json next = choice(fmt::format("c{}", i + 1));
    choices[fmt::format("c{}", i)] = {{"options", {option("both", Json{next, next})}}};
  }
  choices["c40"] = {{"options", {option("end", 1)}}};
  Json document = space_of({limb("a", 0, end("x"))}, choices);
  document["tool"] = choice("c0");
  EXPECT_NE(mistakes(document).find("at most 100000 values"), std::string::npos)
      << mistakes(document);
}

TEST(SpaceMistakes, WhatIsNotAnObjectIsRefused) {
  for (const Json& document :
       {Json(nullptr), Json(3), Json::array(), Json::object(), Json{{"choose", Json::array()}}})
    EXPECT_NE(mistakes(document), "") << document;
}

TEST(Space, TellsTheSameOptionsApartByTheNameAfterAs) {
  const auto leg = [](const char* as) { return Json{{"choose", "ends"}, {"as", as}}; };
  const Json document = space_of(
      {limb("a", 0, leg("leg a")), limb("b", 90, leg("leg b")), limb("c", 180, leg("leg a"))},
      {{"ends", choice_of({"x", "y", "z"})}});
  const Space space = parse_space(document, "test.json");
  ASSERT_EQ(raw_count(space), 9);
  std::set<std::pair<std::string, std::string>> pairs;
  for (std::uint64_t i = 0; i < 9; ++i) {
    const RawCandidate candidate = raw_candidate(space, i);
    pairs.emplace(candidate.choices.at("leg a"), candidate.choices.at("leg b"));
    const Json& limbs = candidate.layout.at("limbs");
    EXPECT_EQ(limbs[0]["rods"]["carriage"], limbs[2]["rods"]["carriage"]);
  }
  EXPECT_EQ(pairs.size(), 9);
}

TEST(SpaceMistakes, TwoChoicesOfOneNameAreRefused) {
  const auto as_same = [](const char* choose) { return Json{{"choose", choose}, {"as", "same"}}; };
  const std::string said =
      mistakes(space_of({limb("a", 0, as_same("one")), limb("b", 90, as_same("two"))},
                        {{"one", choice_of({"x"})}, {"two", choice_of({"y"})}}));
  EXPECT_NE(said.find("two choices must not both be called \"same\""), std::string::npos) << said;
}

TEST(SpaceMistakes, AChoiceHoldsNothingElse) {
  const std::string said = mistakes(
      space_of({limb("a", 0, {{"choose", "one"}, {"a", "leg a"}})}, {{"one", choice_of({"x"})}}));
  EXPECT_NE(said.find("beside \"choose\""), std::string::npos) << said;
}

}  // namespace
}  // namespace polyglide
