#include "optimizer/stability.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace polyglide {
namespace {

RankedMeasures design(const std::string& id, double workspace, double conditioning) {
  RankedMeasures one{id, id, {}};
  one.measures.coverage = one.measures.credit = 1;
  one.measures.workspace = workspace;
  one.measures.conditioning = one.measures.worst_conditioning = conditioning;
  one.measures.compactness = 0.1;
  return one;
}

const std::vector<std::pair<std::string, double>> kBoth{{"workspace", 1}, {"conditioning", 1}};

TEST(Stability, KendallsTauIsOneForEqualAndMinusOneForReversedOrders) {
  EXPECT_EQ(kendall_tau({1, 2, 3, 4}, {1, 2, 3, 4}), 1);
  EXPECT_EQ(kendall_tau({1, 2, 3, 4}, {4, 3, 2, 1}), -1);
  EXPECT_NEAR(kendall_tau({1, 2, 3}, {1, 3, 2}), 1.0 / 3, 1e-12);
  EXPECT_EQ(kendall_tau({1}, {1}), 1);
}

TEST(Stability, SchemesBeginWithTheStatedWeightsAndHoldEachIndexAlone) {
  const auto schemes = schemes_for({{"workspace", 2}, {"conditioning", 1}});
  EXPECT_EQ(schemes.front().weights.front().second, 2);
  for (const std::string& key : objective_words())
    EXPECT_TRUE(std::ranges::any_of(schemes, [&](const Scheme& scheme) {
      return scheme.weights.size() == 1 && scheme.weights[0].first == key;
    })) << key;
}

TEST(Stability, SchemesThatWeighAlikeAreListedOnce) {
  const auto schemes = schemes_for({{"workspace", 3}});
  EXPECT_EQ(schemes.size(), objective_words().size());
}

TEST(Stability, RanksChangeWithTheWeights) {
  const auto document = stability_json({design("wide", 0.5, 0.3), design("firm", 0.1, 0.9)}, kBoth);
  const auto& schemes = document["schemes"];
  for (std::size_t s = 0; s < schemes.size(); ++s) {
    const std::string label = schemes[s]["label"];
    if (label.starts_with("Mean conditioning")) {
      EXPECT_EQ(document["ranks"]["firm"][s], 1);
      EXPECT_EQ(document["ranks"]["wide"][s], 2);
    }
  }
  EXPECT_NE(document["statement"].get<std::string>().find("firm is first with"), std::string::npos);
}

TEST(Stability, FewerThanTwoLayoutsHaveNoOrder) {
  EXPECT_NE(stability_json({}, kBoth)["statement"], "");
  EXPECT_EQ(stability_json({design("one", 0.5, 0.5)}, kBoth)["ranks"]["one"][0], 1);
}

}  // namespace
}  // namespace polyglide
