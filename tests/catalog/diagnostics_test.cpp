#include "catalog/diagnostics.hpp"

#include <gtest/gtest.h>

#include "catalog/counted.hpp"

namespace polyglide {
namespace {

TEST(Diagnostics, SayPlaceValueRuleAndHintInOneLine) {
  const Diagnostic diagnostic{"a.json", "/joints/3/type", "\"revolut\"", "must be a joint",
                              "did you mean \"revolute\"?"};
  EXPECT_EQ(to_string(diagnostic),
            "a.json:/joints/3/type: \"revolut\" — must be a joint; did you mean \"revolute\"?");
}

TEST(Diagnostics, OfTheCommandLineHaveNoPlace) {
  EXPECT_EQ(to_string({"", "", "\"x\"", "must be a number", ""}), "\"x\" — must be a number");
}

TEST(Diagnostics, AreAllInTheMessageOfAnInputError) {
  const InputError error({{"f", "/a", "1", "first", ""}, {"f", "/b", "2", "second", ""}});
  EXPECT_STREQ(error.what(), "f:/a: 1 — first\nf:/b: 2 — second");
  EXPECT_EQ(error.diagnostics().size(), 2u);
}

TEST(Counted, TakesTheSingularForOneOnly) {
  EXPECT_EQ(counted(0, "freedom"), "0 freedoms");
  EXPECT_EQ(counted(1, "freedom"), "1 freedom");
  EXPECT_EQ(counted(std::size_t{6}, "freedom"), "6 freedoms");
  EXPECT_EQ(counted(1, "family", "families"), "1 family");
  EXPECT_EQ(counted(20, "family", "families"), "20 families");
}

TEST(NearestWord, ForgivesALetterLeftOutReplacedOrSwapped) {
  const std::vector<std::string> words = {"revolute", "prismatic", "spherical"};
  EXPECT_EQ(nearest_word("revolut", words), "revolute");
  EXPECT_EQ(nearest_word("prosmatic", words), "prismatic");
  EXPECT_EQ(nearest_word("shperical", words), "spherical");
  EXPECT_EQ(nearest_word("Spherical", words), "spherical");
}

TEST(NearestWord, IsNoneWhenMoreThanAThirdOfTheLettersDiffer) {
  EXPECT_EQ(nearest_word("rotary", {"revolute", "prismatic"}), "");
  EXPECT_EQ(nearest_word("", {"revolute"}), "");
  EXPECT_EQ(nearest_word(std::string(1000, 'x'), {std::string(1000, 'x')}), "");
}

}  // namespace
}  // namespace polyglide
