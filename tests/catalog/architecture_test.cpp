#include "catalog/architecture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "catalog/catalog.hpp"

namespace polyglide {
namespace {

std::string of_entry(const std::string& name) { return architecture(expand(find_layout(name))); }

/// Bodies 0 (base), 1 (platform), 2 …, joined by joints of the given kinds.
struct Link {
  JointType type;
  int from, to;
};
Mechanism graph(const std::vector<Link>& links) {
  Mechanism mechanism;
  mechanism.platform = 1;
  for (const Link& link : links) {
    Joint joint;
    joint.type = link.type;
    joint.bodies = {link.from, link.to};
    mechanism.joints.push_back(joint);
    const auto bodies = static_cast<std::size_t>(std::max(link.from, link.to)) + 1;
    if (bodies > mechanism.bodies.size()) mechanism.bodies.resize(bodies);
  }
  return mechanism;
}

TEST(Architecture, CountsEqualLimbs) {
  EXPECT_EQ(of_entry("gough-platform"), "6-UPS");
  EXPECT_EQ(of_entry("3-rps"), "3-RPS");
  EXPECT_EQ(of_entry("sprint-z3"), "3-PRS");
  EXPECT_EQ(of_entry("tripteron"), "3-PRRR");
}

TEST(Architecture, JoinsUnlikeLimbsTheMostFrequentFirst) {
  EXPECT_EQ(of_entry("tricept"), "3-UPS+UP");
  EXPECT_EQ(of_entry("exechon"), "2-UPR+SPR");
  EXPECT_EQ(of_entry("metrom-pentapod"), "4-UPS+UPU");
}

TEST(Architecture, PutsRodsSideBySideInBrackets) {
  EXPECT_EQ(of_entry("delta-1"), "3-P(2-US)");
  EXPECT_EQ(of_entry("delta"), "3-R(2-US)");
  EXPECT_EQ(of_entry("table1-6"), "2-P(2-US)+2-PUS");
}

TEST(Architecture, NamesHybridsStageByStage) {
  EXPECT_EQ(of_entry("hybrid-3prp-3rps"), "(3-PRP)(3-RPS)");
  EXPECT_EQ(of_entry("tricept-head"), "(3-UPS+UP)RR");
  EXPECT_EQ(of_entry("trimule"), "(R(2-RPS+RP)+UPS)RR");
}

TEST(Architecture, NamesASingleLoopByItsJoints) {
  EXPECT_EQ(of_entry("four-bar"), "4R");
  EXPECT_EQ(of_entry("bennett"), "4R");
  EXPECT_EQ(of_entry("sarrus"), "6R");
  EXPECT_EQ(of_entry("rssr"), "RSSR");
  EXPECT_EQ(of_entry("slider-crank"), "RRRP");
}

TEST(Architecture, ListsChainsThatCrossInSquareBrackets) {
  // A bridge: two limbs with a joint between their middles.
  using enum JointType;
  EXPECT_EQ(architecture(graph({{revolute, 0, 2},
                                {revolute, 0, 3},
                                {prismatic, 2, 3},
                                {spherical, 2, 1},
                                {spherical, 3, 1}})),
            "[2-R+2-S+P]");
}

TEST(Architecture, ReadsAChainFromTheBaseWhicheverWayItsJointsAreWritten) {
  using enum JointType;
  EXPECT_EQ(architecture(graph({{universal, 2, 0}, {prismatic, 3, 2}, {spherical, 1, 3}})), "UPS");
}

TEST(Architecture, LeavesOutWhatHangsLoose) {
  using enum JointType;
  const std::vector<Link> arm{{universal, 0, 2}, {prismatic, 2, 1}};
  auto with_tail = arm;
  with_tail.push_back({revolute, 2, 3});
  with_tail.push_back({revolute, 3, 4});
  EXPECT_EQ(architecture(graph(with_tail)), "UP");
  auto with_loop = arm;
  for (const Link& link : {Link{revolute, 2, 3}, {revolute, 3, 4}, {revolute, 4, 2}})
    with_loop.push_back(link);
  EXPECT_EQ(architecture(graph(with_loop)), "UP");
}

TEST(Architecture, OfNothingIsEmpty) {
  Mechanism nothing;
  nothing.bodies = {"base", "platform"};
  nothing.platform = 1;
  EXPECT_EQ(architecture(nothing), "");
}

TEST(Architecture, DoesNotDependOnWhichBodyAJointNamesFirst) {
  std::mt19937_64 random(5);
  for (const std::string& name : catalog_names()) {
    Mechanism mechanism = expand(find_layout(name));
    const std::string before = architecture(mechanism);
    EXPECT_FALSE(before.empty()) << name;
    for (Joint& joint : mechanism.joints)
      if (random() % 2 != 0) std::swap(joint.bodies[0], joint.bodies[1]);
    EXPECT_EQ(architecture(mechanism), before) << name;
  }
}

TEST(LimbWords, AreTheLettersOnly) {
  EXPECT_EQ(limb_words("3-UPS+UP"), (std::vector<std::string>{"UPS", "UP"}));
  EXPECT_EQ(limb_words("2-P(2-US)+2-PUS"), (std::vector<std::string>{"P", "US", "PUS"}));
  EXPECT_TRUE(limb_words("").empty());
}

}  // namespace
}  // namespace polyglide
