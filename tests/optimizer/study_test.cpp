#include "optimizer/study.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "catalog/catalog.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

const std::filesystem::path kSource = POLYGLIDE_SOURCE_DIR;

Study small_study() {
  Study study = load_study(kSource / "examples" / "studies" / "delta-1.json");
  study.evaluations = 250;
  return study;
}

TEST(Tune, FindsTheBestLeanOfRodsInClosedForm) {
  // With a tiny zone on the axis and conditioning alone, the best Delta has rods at
  // tan φ = √2, where 1/κ = 1.
  const Layout layout = find_layout("delta-1");
  const TaskSpace task = prepare(expand(layout)).task;
  Requirements requirements;
  requirements.zone.size = {1e-5, 1e-5, 1e-5};
  requirements.zone.center = Vector3::Zero();
  requirements.objectives = {{"conditioning", 1}};
  const TuneProblem problem{layout, task, requirements, {"a", "d"}, {}};
  const Tuned tuned = tune(problem, 400, 1);
  EXPECT_GT(tuned.best.score, 0.999);
  EXPECT_NEAR(tuned.initial.score, 0.3852, 1e-3);
}

TEST(Tune, ConstraintsAreKeptAndTheBestIsNeverWorseThanTheStart) {
  const Layout layout = find_layout("delta-1");
  const TaskSpace task = prepare(expand(layout)).task;
  Requirements requirements;
  requirements.zone.size = {0.1, 0.1, 0.05};
  requirements.objectives = {{"workspace", 1}};
  requirements.envelope = Vector3(0.74, 0.74, 0.594);
  const TuneProblem problem{
      layout, task, requirements, {"a", "b", "d"}, {{"keep the sum", "a + b + d", 700, 745}}};
  for (int evaluations : {1, 20, 120}) {
    const Tuned tuned = tune(problem, evaluations, 3);
    const double sum = evaluate(problem.constraints[0], layout, tuned.best.values);
    EXPECT_GE(sum, 700);
    EXPECT_LE(sum, 745);
    EXPECT_GE(tuned.best.score, tuned.initial.score);
  }
}

TEST(Tune, ADimensionThatLetsRodsNotReachIsNoMistake) {
  const Layout layout = find_layout("delta-1");
  const TaskSpace task = prepare(expand(layout)).task;
  Requirements requirements;
  requirements.zone.size = {0.05, 0.05, 0.05};
  requirements.objectives = {{"compactness", 1}};
  const TuneProblem problem{layout, task, requirements, turnable(layout), {}};
  EXPECT_GT(tune(problem, 150, 1).best.score, 0);
}

const StudyResult& small_result() {
  static const StudyResult result = run_study(small_study());
  return result;
}

TEST(Study, Delta1GetsBetterInsideItsEnvelope) {
  const Study study = small_study();
  const StudyResult& result = small_result();
  EXPECT_TRUE(result.satisfied);
  EXPECT_GT(result.tuned.best.score, result.tuned.initial.score);
  EXPECT_EQ(result.tuned.best.measures.coverage, 1);
  for (const Constraint& constraint : study.constraints) {
    const double value = evaluate(constraint, study.machine, result.tuned.best.values);
    EXPECT_LE(value, constraint.max) << constraint.expression;
    EXPECT_GE(value, constraint.min) << constraint.expression;
  }
  EXPECT_NEAR(result.tuned.initial.measures.volume, 0.010007, 1e-4);
}

TEST(Study, TheStoredRunHoldsBothMachines) {
  const auto& run = small_result().run;
  EXPECT_EQ(run["kind"], "study");
  ASSERT_EQ(run["ranking"].size(), 2u);
  ASSERT_EQ(run["layouts"].size(), 2u);
  EXPECT_EQ(run["layouts"][1]["id"], "delta-1");
  EXPECT_NEAR(run["layouts"][1]["workspace"]["volume"].get<double>(), 0.010007, 2e-5);
  for (const auto& row : run["requirements"]) EXPECT_EQ(row["verdict"], "met") << row.dump();
  const std::string statement = run["duel"]["statement"];
  EXPECT_FALSE(statement.empty());
  EXPECT_EQ(statement.find('_'), std::string::npos) << "keys are for programs: " << statement;
}

TEST(Study, IsTheSameForAnyNumberOfThreads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  auto alone = run_study(small_study()).run, together = small_result().run;
  alone.erase("provenance");
  together.erase("provenance");
  EXPECT_EQ(alone.dump(), together.dump());
}

}  // namespace
}  // namespace polyglide
