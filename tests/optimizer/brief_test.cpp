#include "optimizer/brief.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "optimizer/study.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

json good_brief() {
  return {{"format", "polyglide/brief/1"},
          {"name", "mill"},
          {"space", "table1.json"},
          {"motion", "XYZA"},
          {"zone", {{"size", {300, 200, 100}}, {"tilt", 20}}},
          {"objectives", {{"workspace", 1}, {"conditioning", 2}}}};
}

json good_study() {
  return {{"format", "polyglide/study/1"},
          {"name", "better"},
          {"machine", "delta-1"},
          {"turn", {"a", "b"}},
          {"zone", {{"cylinder", {{"diameter", 100}, {"height", 50}}}}},
          {"objective", {{"workspace", 1}}}};
}

/// All messages of the mistakes in a document.
template <typename Parse>
std::string mistakes(const Parse& parse) {
  try {
    parse();
  } catch (const InputError& error) {
    std::string text;
    for (const Diagnostic& one : error.diagnostics()) text += to_string(one) + '\n';
    return text;
  }
  return "";
}

std::string brief_mistakes(const json& document) {
  return mistakes([&] { (void)parse_brief(document, "folder/brief.json"); });
}

std::string study_mistakes(const json& document) {
  return mistakes([&] { (void)parse_study(document, "study.json"); });
}

void expect_all(const std::string& text, std::initializer_list<const char*> parts) {
  for (const char* part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nin: " << text;
}

TEST(Brief, IsReadInSiUnits) {
  const Brief brief = parse_brief(good_brief(), "folder/brief.json");
  EXPECT_EQ(brief.requirements.zone.size, Vector3(0.3, 0.2, 0.1));
  EXPECT_NEAR(brief.requirements.zone.tilt, std::numbers::pi / 9, 1e-12);
  EXPECT_EQ(brief.drives, 4);
  EXPECT_EQ(brief.translations, 3);
  EXPECT_EQ(brief.rotations, 1);
  EXPECT_EQ(brief.space, std::filesystem::path("folder/table1.json"));
  EXPECT_EQ(motion_text(brief), "3T1R about a horizontal axis (XYZA)");
}

TEST(Brief, AnUnknownObjectiveNamesTheNearestWord) {
  json document = good_brief();
  document["objectives"] = {{"worksapce", 1}, {"conditioning", 1}};
  expect_all(brief_mistakes(document),
             {"folder/brief.json:/objectives/worksapce", "did you mean \"workspace\"?"});
}

TEST(Brief, AMotionMustBeLettersInOrder) {
  for (const char* motion : {"XYZQ", "AXYZ", "XXYZ", "xyza"}) {
    json document = good_brief();
    document["motion"] = motion;
    expect_all(brief_mistakes(document), {"/motion", "letters of XYZABC"});
  }
}

TEST(Brief, AllMistakesComeAtOnce) {
  json document = good_brief();
  document["motion"] = "XYZQ";
  document["objectives"] = {{"beauty", 1}};
  document["zone"] = {{"tilt", 5}};
  document["name"] = "../up";
  expect_all(brief_mistakes(document),
             {"/motion", "/objectives/beauty", "either \"size\" or \"cylinder\"", "/name"});
}

TEST(Brief, AZoneMustBeGivenAndATiltNeedsARotation) {
  json document = good_brief();
  document.erase("zone");
  expect_all(brief_mistakes(document), {"\"zone\" must be given"});
  document = good_brief();
  document["motion"] = "XYZ";
  expect_all(brief_mistakes(document), {"/zone/tilt", "no rotation"});
}

TEST(Brief, WeightsMustNotAllBeZero) {
  json document = good_brief();
  document["objectives"] = {{"workspace", 0}};
  expect_all(brief_mistakes(document), {"/objectives", "greater than zero"});
}

TEST(Study, ParametersOfTheMachineAreChecked) {
  json document = good_study();
  document["turn"] = {"a", "bb", "L"};
  expect_all(study_mistakes(document), {"/turn/1", "no parameter \"bb\"", "/turn/2", "no room"});
}

TEST(Study, ErrorsInConstraintsAreFoundWithTheirPlace) {
  json document = good_study();
  document["constraints"] = {{{"expression", "a + q"}, {"max", 3}},
                             {{"expression", "a"}, {"min", 5}, {"max", 1}}};
  expect_all(study_mistakes(document), {"/constraints/0/expression", "/constraints/1"});
}

TEST(Study, AnUnknownMachineNamesTheNearest) {
  json document = good_study();
  document["machine"] = "delta1";
  expect_all(study_mistakes(document), {"delta-1"});
}

}  // namespace
}  // namespace polyglide
