#include "catalog/expression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace polyglide {
namespace {

const Scope kScope{true, {{"R", 500}, {"w", 150}, {"unknown_value", std::nan("")}}};

double value(const std::string& text, const Scope& scope = kScope) {
  const Evaluation result = evaluate(text, scope);
  EXPECT_EQ(result.error, "") << text;
  return result.value;
}

TEST(Expression, FollowsTheRulesOfArithmetic) {
  EXPECT_EQ(value("1 + 2*3 - 4/8"), 6.5);
  EXPECT_EQ(value("(1 + 2)*3"), 9);
  EXPECT_EQ(value("-2^2"), -4);
  EXPECT_EQ(value("2^3^2"), 512);
  EXPECT_EQ(value("1.5e2 + .5"), 150.5);
  EXPECT_EQ(value("-R + w"), -350);
}

TEST(Expression, TakesAnglesInTheUnitOfTheFile) {
  EXPECT_NEAR(value("R*cos(60)"), 250, 1e-12);
  EXPECT_NEAR(value("atan2(1, -1)"), 135, 1e-12);
  const Scope radians{false, {}};
  EXPECT_NEAR(value("sin(pi/6)", radians), 0.5, 1e-15);
  EXPECT_NEAR(value("acos(-1)", radians), std::numbers::pi, 1e-15);
  EXPECT_NEAR(value("asin(1) + acos(1) + atan(1) + tan(45)"), 136, 1e-12);
}

TEST(Expression, KnowsRootAbsoluteSmallestAndLargest) {
  EXPECT_EQ(value("sqrt(16) + abs(-3) + min(1, 2) + max(1, 2)"), 10);
}

TEST(Expression, GivesTheSameForOtherValuesOfTheSameNames) {
  Scope scope = kScope;
  for (int i = 0; i < 3; ++i) {
    scope.names[0].second = i;
    EXPECT_EQ(value("2*R", scope), 2 * i);
  }
}

TEST(Expression, WithAnUnknownNameIsToldWithTheNearestOne) {
  const Evaluation result = evaluate("2*sqr(R)", kScope);
  EXPECT_EQ(result.error, "\"sqr\" is neither a parameter nor a function");
  EXPECT_EQ(result.hint, "did you mean \"sqrt\"?");
  // Also when the text was compiled where the name is known.
  EXPECT_EQ(value("w + 1"), 151);
  EXPECT_NE(evaluate("w + 1", Scope{}).error, "");
}

TEST(Expression, HasNoAssignmentsComparisonsOrLists) {
  for (const char* text :
       {"R = 3", "R += 1", "R == 3", "R < 2", "1, 2", "R ? 1 : 2", "1; 2", "R\n"})
    EXPECT_NE(evaluate(text, kScope).error, "") << text;
  EXPECT_EQ(value("R"), 500);
}

TEST(Expression, WithAMistakeIsToldWhateverTheMistake) {
  for (const char* text : {"", " ", "1 +", "(1", "1)", "sin()", "sin(1, 2)", "min(1)", "2 3", "R R",
                           "1..2", "1e", "sin", "()", "^", "2**3", "1/0", "sqrt(-1)", "9^999"})
    EXPECT_NE(evaluate(text, kScope).error, "") << text;
  EXPECT_EQ(evaluate(std::string(501, '1'), kScope).error,
            "an expression must have at most 500 characters");
  EXPECT_NE(evaluate(std::string(500, '('), kScope).error, "");
}

TEST(Expression, OfAValueThatWasWrongBeforeIsNotToldAgain) {
  const Evaluation result = evaluate("2*unknown_value", kScope);
  EXPECT_TRUE(std::isnan(result.value));
  EXPECT_EQ(result.error, "");
}

TEST(Expression, NamesAreFoundWithoutFunctionsAndExponents) {
  EXPECT_EQ(names_in("R*cos(30) + 1e3 - 2.5e-1*w_2 + pi"), (std::vector<std::string>{"R", "w_2"}));
  EXPECT_TRUE(names_in("3.4").empty());
}

}  // namespace
}  // namespace polyglide
