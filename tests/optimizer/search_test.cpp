#include "optimizer/search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <thread>

namespace polyglide {
namespace {

SearchProblem rosenbrock() {
  SearchProblem problem;
  problem.lower = {-2, -2};
  problem.upper = {2, 2};
  problem.start = {-1.2, 1};
  problem.value = [](const std::vector<double>& x) {
    return -100 * std::pow(x[1] - x[0] * x[0], 2) - std::pow(1 - x[0], 2);
  };
  return problem;
}

/// Rastrigin's function: one summit of height 0 at (0.5, 0.5, 0.5) among many lower ones.
SearchProblem rastrigin() {
  SearchProblem problem;
  problem.lower = {-4, -4, -4};
  problem.upper = {5, 5, 5};
  problem.start = {3.4, -2.4, 4.3};
  problem.value = [](const std::vector<double>& x) {
    double sum = 0;
    for (const double xi : x) {
      const double d = xi - 0.5;
      sum -= d * d - 10 * std::cos(2 * std::numbers::pi * d) + 10;
    }
    return sum;
  };
  return problem;
}

TEST(Search, ClimbsRosenbrocksValley) {
  const SearchSummary found = maximise(rosenbrock(), {.evaluations = 3000});
  EXPECT_NEAR(found.best[0], 1, 1e-2);
  EXPECT_NEAR(found.best[1], 1, 1e-2);
  EXPECT_GT(found.value, -1e-4);
  EXPECT_TRUE(found.usable);
}

TEST(Search, FindsTheHighestOfManySummits) {
  const SearchSummary found = maximise(rastrigin(), {.evaluations = 6000, .global_share = 0.8});
  for (const double x : found.best) EXPECT_NEAR(x, 0.5, 1e-2);
}

TEST(Search, TheSameSeedGivesTheSameBitsAndAnotherSeedAnotherWay) {
  const SearchSummary a = maximise(rastrigin(), {.evaluations = 400, .seed = 7});
  const SearchSummary b = maximise(rastrigin(), {.evaluations = 400, .seed = 7});
  const SearchSummary c = maximise(rastrigin(), {.evaluations = 400, .seed = 8});
  EXPECT_EQ(a.best, b.best);
  EXPECT_EQ(a.history, b.history);
  EXPECT_NE(a.history, c.history);
}

// The generator of the global stage must belong to the thread: searches that run at
// the same time must not draw from each other.
TEST(Search, SearchesOnSeveralThreadsAreTheSameAsOneAfterTheOther) {
  constexpr int kSearches = 24;
  const auto one = [](int i) {
    return maximise(rastrigin(), {.evaluations = 500, .seed = static_cast<std::uint64_t>(i)});
  };
  std::vector<SearchSummary> serial(kSearches), parallel(kSearches);
  for (int i = 0; i < kSearches; ++i) serial[i] = one(i);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = t; i < kSearches; i += 4) parallel[i] = one(i);
    });
  for (std::thread& thread : threads) thread.join();
  for (int i = 0; i < kSearches; ++i) EXPECT_EQ(serial[i].history, parallel[i].history) << i;
}

TEST(Search, NeverEndsBelowTheStart) {
  SearchProblem problem = rastrigin();
  problem.start = {0.5, 0.5, 0.5};
  for (int evaluations : {1, 2, 10, 100}) {
    const SearchSummary found = maximise(problem, {.evaluations = evaluations});
    EXPECT_EQ(found.best, problem.start);
    EXPECT_EQ(found.value, 0);
  }
}

TEST(Search, KeepsTheBudgetWhateverItIs) {
  for (int budget : {1, 2, 3, 7, 20, 50, 333}) {
    int calls = 0;
    SearchProblem problem = rastrigin();
    const auto value = problem.value;
    problem.value = [&](const std::vector<double>& x) {
      ++calls;
      return value(x);
    };
    const SearchSummary found = maximise(problem, {.evaluations = budget});
    EXPECT_LE(calls, budget);
    EXPECT_EQ(calls, found.evaluations);
  }
}

TEST(Search, StaysInsideTheBoundsAndLeavesFixedVariablesAlone) {
  SearchProblem problem = rosenbrock();
  problem.lower[1] = problem.upper[1] = problem.start[1] = 0.25;
  const auto value = problem.value;
  problem.value = [&](const std::vector<double>& x) {
    EXPECT_EQ(x[1], 0.25);
    EXPECT_GE(x[0], -2);
    EXPECT_LE(x[0], 2);
    return value(x);
  };
  EXPECT_NEAR(maximise(problem, {.evaluations = 300}).best[0], 0.504, 2e-2);
}

TEST(Search, WithNothingToTurnOnlyTheStartIsLookedAt) {
  SearchProblem problem = rosenbrock();
  problem.lower = problem.upper = problem.start;
  const SearchSummary found = maximise(problem);
  EXPECT_EQ(found.evaluations, 1);
  EXPECT_EQ(found.stopped, "nothing to turn");
}

TEST(Search, ValuesThatAreNoNumbersAreWorstOfAll) {
  SearchProblem problem = rosenbrock();
  const auto value = problem.value;
  problem.value = [&](const std::vector<double>& x) {
    return x[0] < 0 ? std::numeric_limits<double>::quiet_NaN() : value(x);
  };
  const SearchSummary found = maximise(problem, {.evaluations = 1000});
  EXPECT_TRUE(found.usable);
  EXPECT_GE(found.best[0], 0);

  problem.value = [](const std::vector<double>&) {
    return -std::numeric_limits<double>::infinity();
  };
  EXPECT_FALSE(maximise(problem, {.evaluations = 50}).usable);
}

TEST(Search, HistoryRisesToTheValueFound) {
  const SearchSummary found = maximise(rosenbrock(), {.evaluations = 500});
  ASSERT_FALSE(found.history.empty());
  for (std::size_t i = 1; i < found.history.size(); ++i) {
    EXPECT_GT(found.history[i].first, found.history[i - 1].first);
    EXPECT_GT(found.history[i].second, found.history[i - 1].second);
  }
  EXPECT_EQ(found.history.back().second, found.value);
}

TEST(Search, RefusesBoundsThatDoNotFit) {
  SearchProblem problem = rosenbrock();
  problem.lower[0] = 3;
  EXPECT_THROW((void)maximise(problem), std::invalid_argument);
  problem = rosenbrock();
  problem.start.pop_back();
  EXPECT_THROW((void)maximise(problem), std::invalid_argument);
}

TEST(Search, AnErrorOfTheFunctionIsPassedOn) {
  SearchProblem problem = rosenbrock();
  problem.value = [](const std::vector<double>&) -> double { throw std::domain_error("broken"); };
  EXPECT_THROW((void)maximise(problem), std::domain_error);
}

}  // namespace
}  // namespace polyglide
