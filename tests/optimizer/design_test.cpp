#include "optimizer/design.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include "catalog/json_file.hpp"
#include "optimizer/families.hpp"
#include "optimizer/screening.hpp"

namespace polyglide {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Layout 6 of Table 1 and its neighbours: 2 × 3 × 2 = 12 combinations.
const char* const kSpace = R"json({
  "format": "polyglide/space/1", "name": "small",
  "parameters": {
    "R": {"value": 500, "min": 300, "max": 800, "unit": "length"},
    "r": {"value": 120, "min": 60, "max": 300, "unit": "length"},
    "rod": {"value": 800, "min": 500, "max": 1400, "unit": "length"},
    "w": {"value": 150, "min": 60, "max": 300, "unit": "length"},
    "gap": {"value": 160, "min": 60, "max": 300, "unit": "length"},
    "travel": {"value": 350, "unit": "length"},
    "cone": {"value": 50, "unit": "angle"}},
  "known": ["table1-6"],
  "tool": [0, 0, 0],
  "limbs": [
    {"name": "a", "copies": {"k": [0, 1]}, "turn": "180*k",
     "guide": {"through": ["R", 0, 0], "direction": {"choose": "guides"}, "travel": "travel"},
     "rods": {"form": "parallelogram", "spacing": "gap", "along": "tangential", "length": "rod",
       "carriage": {"joint": "universal", "axis": "tangential", "cone": "cone"},
       "platform": {"choose": "platform a"}}},
    {"name": "b", "copies": {"side": [-1, 1]},
     "guide": {"through": ["side*w", "R", 0], "direction": "z", "travel": "travel"},
     "rods": {"length": "rod", "carriage": {"choose": "carriage b"},
       "platform": {"joint": "spherical", "at": ["side*w", "r", 0], "cone": "cone"}}}],
  "choices": {
    "guides": {"options": [
      {"label": "vertical", "value": "z"},
      {"label": "leaning", "value": {"lean": 80, "toward": "radial"}}]},
    "platform a": {"options": [
      {"label": "spherical", "value": {"joint": "spherical", "at": ["r", 0, 0], "cone": "cone"}},
      {"label": "hinge", "value": {"joint": "revolute", "axis": "z", "at": ["r", 0, 0], "cone": "cone"}}]},
    "carriage b": {"options": [
      {"label": "universal x", "value": {"joint": "universal", "axis": "x", "cone": "cone"}},
      {"label": "universal z", "value": {"joint": "universal", "axis": "z", "cone": "cone"}},
      {"label": "spherical", "value": {"joint": "spherical", "cone": "cone"}}]}}
})json";

json brief_document() {
  return {{"format", "polyglide/brief/1"},
          {"name", "small-mill"},
          {"space", "space.json"},
          {"motion", "XYZA"},
          {"zone", {{"size", {120, 120, 80}}, {"tilt", 10}}},
          {"limits", {{"condition", 20}}},
          {"objectives", {{"workspace", 1}, {"conditioning", 1}, {"compactness", 1}}},
          {"tune", {{"candidates", 2}, {"evaluations", 60}}},
          {"report", {{"layouts", 1}}}};
}

class Design : public testing::Test {
 protected:
  Design() {
    std::string name = (fs::temp_directory_path() / "polyglide-design-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    std::ofstream(folder_ / "space.json") << kSpace;
  }
  ~Design() override { fs::remove_all(folder_); }

  Brief brief(const json& document = brief_document()) const {
    return parse_brief(document, (folder_ / "brief.json").string());
  }

  /// The job in one go on all cores, done once for all tests.
  const DesignResult& uninterrupted() const {
    static const DesignResult result = run_design(brief());
    return result;
  }

  fs::path folder_;
};

std::string without_provenance(DesignResult result) {
  result.run.erase("provenance");
  return result.run.dump();
}

TEST_F(Design, RanksWhatDoesTheJobAndRejectsTheRestWithReasons) {
  const DesignResult& result = uninterrupted();
  const auto& run = result.run;
  ASSERT_TRUE(result.satisfied);
  EXPECT_EQ(run["format"], "polyglide/run/1");

  double last = 1;
  std::uint64_t accounted = 0;
  for (const auto& entry : run["ranking"]) {
    EXPECT_LE(entry["score"].get<double>(), last);
    last = entry["score"];
    EXPECT_GT(last, 0);
    EXPECT_GE(last, entry["initial_score"].get<double>());
    EXPECT_EQ(entry["objectives"]["coverage"], 1);
    accounted += entry["variants"].get<std::uint64_t>();
  }
  for (const auto& [reason, count] : run["counts"]["rejected"].items())
    if (!reason.starts_with("does not assemble")) accounted += count.get<std::uint64_t>();
  EXPECT_EQ(accounted, run["counts"]["distinct"].get<std::uint64_t>());
  EXPECT_EQ(run["counts"]["raw"], 12);
}

TEST_F(Design, ShowsTheBestLayoutsInFull) {
  const auto& run = uninterrupted().run;
  ASSERT_EQ(run["layouts"].size(), 1u);
  const auto& layout = run["layouts"][0];
  EXPECT_EQ(layout["id"], run["ranking"][0]["layout"]);
  EXPECT_EQ(layout["check"]["verdict"], "determinate");
  EXPECT_EQ(layout["check"]["platform"]["pattern"], "3T1R");
  EXPECT_GT(layout["workspace"]["volume"].get<double>(), 0);
  EXPECT_FALSE(layout["workspace"]["slices"].empty());
  EXPECT_FALSE(layout["scene"]["segments"].empty());
  EXPECT_FALSE(layout["convergence"].empty());
  for (const auto& parameter : layout["parameters"]) {
    EXPECT_GE(parameter["value"], parameter["min"]);
    EXPECT_LE(parameter["value"], parameter["max"]);
  }
  EXPECT_EQ(run["stability"]["ranks"].size(), run["ranking"].size());
}

TEST_F(Design, EveryRankedLayoutHasAPicture) {
  const auto& run = uninterrupted().run;
  ASSERT_GT(run["ranking"].size(), 1u);
  EXPECT_FALSE(run["ranking"][0].contains("scene")) << "it is among the layouts";
  for (std::size_t i = 1; i < run["ranking"].size(); ++i) {
    const auto& scene = run["ranking"][i].at("scene");
    EXPECT_FALSE(scene.at("segments").empty());
    EXPECT_FALSE(scene.contains("poses")) << "nothing but what the picture needs";
  }
}

TEST_F(Design, KnownLayoutsAreAlwaysTuned) {
  json document = brief_document();
  document["tune"]["candidates"] = 1;
  const auto run = run_design(brief(document)).run;
  bool found = false;
  for (const auto& entry : run["ranking"]) found = found || entry["known_as"] == "table1-6";
  EXPECT_TRUE(found);
}

TEST_F(Design, IsTheSameForAnyNumberOfThreads) {
  RunOptions one;
  one.threads = 1;
  EXPECT_EQ(without_provenance(run_design(brief(), one)), without_provenance(uninterrupted()));
}

TEST_F(Design, AnInterruptedRunGoesOnWhereItStoppedAndEndsTheSame) {
  const std::string whole = without_provenance(uninterrupted());
  RunOptions options;
  options.out = folder_ / "run";
  options.threads = 1;
  int tuned = 0;
  options.progress = [&](const RunProgress& progress) {
    if (progress.stage == "tune" && ++tuned == 1) throw std::runtime_error("stopped");
  };
  EXPECT_THROW((void)run_design(brief(), options), std::runtime_error);

  double tune_steps = 0;
  options.progress = [&](const RunProgress& progress) {
    if (progress.stage == "check") ADD_FAILURE() << "a verdict was computed again";
    if (progress.stage == "tune") tune_steps = progress.total;
  };
  EXPECT_EQ(without_provenance(run_design(brief(), options)), whole);
  EXPECT_GE(tune_steps, 2);
}

TEST_F(Design, WhenNothingSatisfiesTheNearestMissesAreNamed) {
  json document = brief_document();
  document["zone"] = {{"size", {3000, 3000, 2000}}};
  document["tune"] = {{"candidates", 1}, {"evaluations", 20}};
  const DesignResult result = run_design(brief(document));
  EXPECT_FALSE(result.satisfied);
  EXPECT_TRUE(result.run["ranking"].empty());
  EXPECT_FALSE(result.run["nearest"].empty());
  EXPECT_LT(result.run["nearest"][0]["score"].get<double>(), 0);
  EXPECT_TRUE(result.run["counts"]["rejected"].contains("tuned: the work zone is not covered"));
}

TEST_F(Design, AMotionThatNoLayoutHasLeavesOnlyRejectedOnes) {
  json document = brief_document();
  document["motion"] = "XYZC";
  const DesignResult result = run_design(brief(document));
  EXPECT_FALSE(result.satisfied);
  EXPECT_TRUE(result.run["layouts"].empty());
  EXPECT_FALSE(result.run["rejected"].empty());
}

TEST_F(Design, AMissingSpaceIsNamed) {
  json document = brief_document();
  document["space"] = "nowhere.json";
  try {
    (void)run_design(brief(document));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere.json"), std::string::npos) << error.what();
  }
}

TEST_F(Design, ADuelNamesLayoutsAndChoicesOfTheSpace) {
  json document = brief_document();
  document["duel"] = {{"between", {"table1-6", "table1-1"}}, {"by", {"guide"}}};
  try {
    (void)run_design(brief(document));
    FAIL();
  } catch (const InputError& error) {
    ASSERT_EQ(error.diagnostics().size(), 2u);
    EXPECT_EQ(error.diagnostics()[0].pointer, "/duel/between/1");
    EXPECT_EQ(error.diagnostics()[1].hint, "did you mean \"guides\"?");
  }
}

TEST_F(Design, TwinsHaveEqualSignaturesAndOthersDoNot) {
  const Space space = load_space(folder_ / "space.json");
  std::vector<Eligible> eligible;
  const Enumeration all = enumerate(space);
  for (const Candidate& candidate : all.candidates) {
    if (candidate.pattern() != "3T1R") continue;
    Layout layout = candidate_layout(space, candidate.raw_index, candidate.id);
    TaskSpace task = prepare(expand(layout)).task;
    eligible.push_back({&candidate, std::move(layout), task});
  }
  ASSERT_GT(eligible.size(), 1u);
  std::set<std::string> signatures;
  for (const Eligible& one : eligible) signatures.insert(kinematic_signature(one));
  EXPECT_LT(signatures.size(), eligible.size());  // universal and spherical ends of a rod are twins
  EXPECT_GT(signatures.size(), 1u);               // vertical and leaning guides are not
  const std::size_t expected = signatures.size();
  EXPECT_EQ(group_twins(std::move(eligible)).size(), expected);
}

}  // namespace
}  // namespace polyglide
