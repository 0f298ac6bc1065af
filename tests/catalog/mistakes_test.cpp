// What people get wrong in machine files, and what they are told.
#include <gtest/gtest.h>

#include <algorithm>

#include "catalog/catalog.hpp"
#include "catalog/fixtures_path.hpp"
#include "catalog/json_file.hpp"

namespace polyglide {
namespace {

using test::fixture;
std::vector<Diagnostic> mistakes_of(const std::string& file) {
  try {
    static_cast<void>(find_layout(file));
  } catch (const InputError& error) {
    return error.diagnostics();
  }
  return {};
}

std::vector<Diagnostic> mistakes_in(const char* text) {
  try {
    static_cast<void>(parse_layout(parse_json(text, "f"), "f"));
  } catch (const InputError& error) {
    return error.diagnostics();
  }
  return {};
}

/// What is told: the place, the value (any when empty), part of the rule, the word meant.
struct Told {
  std::string pointer, value, rule, word;

  bool is(const Diagnostic& mistake) const {
    return mistake.pointer == pointer && (value.empty() || mistake.value == value) &&
           mistake.rule.find(rule) != std::string::npos &&
           mistake.hint == (word.empty() ? "" : "did you mean \"" + word + "\"?");
  }
};

Told mistake(const std::string& pointer, const std::string& value, const std::string& rule,
             const std::string& word = "") {
  return {pointer, value, rule, word};
}

Told place(const std::string& pointer, const std::string& rule) { return {pointer, "", rule, ""}; }

/// These mistakes and no others, in any order.
void expect_told(std::vector<Diagnostic> mistakes, const std::vector<Told>& expected) {
  for (const Told& told : expected) {
    const auto found = std::ranges::find_if(mistakes, [&](const auto& m) { return told.is(m); });
    if (found == mistakes.end())
      ADD_FAILURE() << "not told: " << told.pointer << ' ' << told.rule;
    else
      mistakes.erase(found);
  }
  for (const Diagnostic& surplus : mistakes) ADD_FAILURE() << "told, too: " << to_string(surplus);
}

TEST(Mistakes, OfEveryKindAreToldAtOnceEachAtItsPlace) {
  expect_told(
      mistakes_of(fixture("many_mistakes.json")),
      {mistake("/joints/0/type", "\"revolut\"", "must be one of revolute, prismatic", "revolute"),
       mistake("/joints/3/drve", "true", "has no meaning here", "drive"),
       mistake("/parameters/R/value", "900", "must lie in [100, 500]"),
       mistake("/joints/1/at/0", "\"R*cos(30\"", "Missing parenthesis"),
       mistake("/joints/2/axis", "[0,0,0]", "a direction must have a length greater than zero"),
       mistake("/joints/3/axis/0", "\"RR\"", "\"RR\" is neither a parameter nor a function"),
       mistake("/joints/2/name", "\"b\"", "the joint name \"b\" is given twice")});
}

TEST(Mistakes, ARodThatCannotReachItsGuideIsToldOnceWithBothLengths) {
  expect_told(mistakes_of(fixture("rod_too_short.json")),
              {mistake("/limbs/0/rods/length", "200",
                       "loop does not close at home: rod of 200 mm cannot span the 250 mm from its "
                       "platform joint to the guide")});
}

TEST(Mistakes, WrongWordsInALayoutAreToldWithTheNearestWord) {
  expect_told(mistakes_of(fixture("wrong_words.json")),
              {mistake("/limbs/0/guide/direction", "\"redial\"", "must be one of", "radial"),
               mistake("/limbs/0/rods/carriage/joint", "\"cardan\"", "must be one of universal"),
               mistake("/limbs/0/rods/form", "\"paralelogram\"", "must be one of", "parallelogram"),
               place("/limbs/0/rods/platform/at", "number of entries is 3"),
               mistake("/limbs/1/strut", "", "\"platform\" must be given"),
               place("/limbs/2", "exactly one of these must be given"),
               place("/limbs/3", "exactly one of these must be given"),
               mistake("/limbs/1/name", "\"leg\"", "given twice"),
               mistake("/limbs/0/turn", "\"120*k\"", "\"k\" is neither"),
               mistake("/limbs/0/guide/travel", "100", "either the stroke or the travel")});
}

TEST(Mistakes, JointsMustHaveWhatTheirKindNeeds) {
  expect_told(
      mistakes_of(fixture("joints_misused.json")),
      {place("/joints/0/axes", "must not be parallel"),
       place("/joints/0/drive", "list the driven ones"),
       place("/joints/1", "a helical joint needs \"pitch\""),
       place("/joints/1/drive/0", "counted from 0"), place("/joints/2/drive/1", "only once"),
       place("/joints/2/range", "a list of 2 pairs"),
       place("/joints/3/range", "smaller limit must come first"),
       place("/joints/3/cone", "only a spherical or universal"),
       place("/joints/4", "give \"cone_axis\""),
       place("/joints/5", "not connected to the base \"ground\""),
       place("/joints/6", "two different bodies")});
}

TEST(Mistakes, APlatformThatNoJointJoinsIsToldWithTheNearestBody) {
  expect_told(mistakes_of(fixture("unconnected_platform.json")),
              {mistake("/platform", "\"coupler\"", "some joint joins", "couppler")});
}

TEST(Mistakes, AnUnknownFormatIsToldWithTheNearestOne) {
  expect_told(
      mistakes_of(fixture("wrong_format.json")),
      {mistake("/format", "\"polyglide/mechansim/1\"", "must be", "polyglide/mechanism/1")});
}

TEST(Mistakes, ANameThatIsNotInTheCatalogIsToldWithTheNearestEntry) {
  expect_told(mistakes_of("table1-7"),
              {mistake("", "\"table1-7\"", "entry of the catalog", "table1-1")});
}

TEST(Mistakes, DocumentsOfTheWrongShapeAreRefusedNotCrashedOn) {
  for (
      const char* text :
      {"null", "1", "\"x\"", "[]", "{}", R"({"format": 3})",
       R"({"format": "polyglide/layout/1", "limbs": 5})",
       R"({"format": "polyglide/layout/1", "name": "x", "limbs": [3, [], {"name": 4, "guide": [], "rods": 1}]})",
       R"({"format": "polyglide/layout/1", "name": "x", "limbs": {"a": {"copies": {"k": 3}}}, "parameters": [1]})",
       R"({"format": "polyglide/layout/1", "name": "x", "limbs": [{"name": "a", "copies": {"k": []}, "chain": {}}]})",
       R"({"format": "polyglide/mechanism/1", "name": "x", "base": 1, "platform": [], "joints": [1, {"between": 3}, {"type": []}]})",
       R"({"format": "polyglide/mechanism/1", "name": "x", "base": "a", "platform": "a", "joints": [], "units": 3, "limits": [3]})"})
    EXPECT_FALSE(mistakes_in(text).empty()) << text;
}

TEST(Mistakes, ParametersAndDerivedDimensionsMustHaveFreeNames) {
  expect_told(mistakes_in(R"({"format": "polyglide/layout/1", "name": "x",
        "parameters": {"sin": 1, "a": {"value": 1, "min": 3, "max": 2}},
        "derived": {"a": "1", "b": "c + 1", "c": "2*b"},
        "limbs": [{"name": "l", "copies": {"a": [1]}, "chain": [{"type": "weld"}]}]})"),
              {place("/parameters/sin", "cannot name anything else"),
               place("/parameters/a", "min must not be greater than max"),
               place("/derived/a", "given twice"), place("/limbs/0/copies/a", "a parameter has it"),
               place("/limbs/0/copies/a", "a derived dimension has it"),
               place("/derived/b", "must not depend on itself"),
               place("/derived/c", "must not depend on itself")});
}

TEST(Mistakes, AnOverrideOutsideItsLimitsOrOfNoParameterIsTold) {
  const Layout layout = find_layout("table1-6");
  try {
    static_cast<void>(expand(layout, {{"rod", 2000}, {"rodd", 700}}));
    FAIL();
  } catch (const InputError& error) {
    expect_told(error.diagnostics(),
                {mistake("/parameters/rod", "2000", "must lie in [500, 1400]"),
                 mistake("/parameters", "\"rodd\"", "no parameter of this name", "rod")});
  }
}

TEST(Mistakes, AGuideCannotLeanTowardTheVertical) {
  expect_told(mistakes_in(R"({"format": "polyglide/layout/1", "name": "x", "limbs": [{"name": "l",
        "guide": {"through": [0, 0, 9], "direction": {"lean": 70, "toward": "z"}},
        "rods": {"length": 20, "carriage": {"joint": "spherical"}, "platform": {"joint": "spherical", "at": [0, 0, 0]}}}]})"),
              {place("/limbs/0/guide/direction/toward", "horizontal")});
}

TEST(Mistakes, AUniversalJointMayNotHaveItsAxisAlongTheRod) {
  expect_told(mistakes_in(R"({"format": "polyglide/layout/1", "name": "x", "limbs": [{"name": "l",
        "guide": {"through": [0, 0, 9], "direction": "z"},
        "rods": {"length": 20, "carriage": {"joint": "universal", "axis": "rod"}, "platform": {"joint": "spherical", "at": [0, 0, 0]}}}]})"),
              {place("/limbs/0/rods/carriage", "lies along the rod")});
}

}  // namespace
}  // namespace polyglide
