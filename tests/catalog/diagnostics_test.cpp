#include "catalog/diagnostics.hpp"

#include <gtest/gtest.h>

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
