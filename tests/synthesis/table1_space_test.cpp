#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "catalog/catalog.hpp"
#include "kinematics/mobility.hpp"
#include "synthesis/enumerate.hpp"

namespace polyglide {
namespace {

Space example() {
  return load_space(std::filesystem::path(POLYGLIDE_SOURCE_DIR) / "examples/spaces/table1.json");
}

TEST(Table1Space, HoldsAtLeastTenThousandCombinations) {
  // Cross: 8 legs in 4 places, 3 guides. T: 8 legs for 2 pairs, 3 guides for each. One and two
  // guides: 8 legs for 2 pairs.
  EXPECT_EQ(raw_count(example()), 8 * 8 * 8 * 8 * 3 + 8 * 8 * 3 * 3 + 8 * 8);
  EXPECT_GE(raw_count(example()), 10'000);
}

// What there is to say about the enumerated space, which takes seconds to enumerate.
struct Expectations {
  Space space;
  Enumeration all;

  const Candidate& known(const std::string& name) const {
    const auto found = std::ranges::find(all.candidates, name, &Candidate::known_as);
    if (found == all.candidates.end()) throw std::runtime_error(name + " is not in the space");
    return *found;
  }
  const Candidate& one_and_two_guides(const std::string& pair_a, const std::string& pair_b) const {
    return *std::ranges::find_if(all.candidates, [&](const Candidate& candidate) {
      const auto& taken = candidate.choices;
      return taken.at("arrangement") == "one and two guides" && taken.at("pair a") == pair_a &&
             taken.at("pair b") == pair_b;
    });
  }

  void as_many_distinct_layouts_as_burnside_counts() const {
    // Only the cross has motions that exchange legs chosen on their own: the square's eight.
    const int cross = (8 * 8 * 8 * 8 + 2 * 8 * 8 * 8 + 3 * 8 * 8 + 2 * 8) / 8;
    EXPECT_EQ(all.candidates.size(), cross * 3 + 8 * 8 * 3 * 3 + 8 * 8);
    EXPECT_TRUE(all.unbuildable.empty());
  }
  void the_six_layouts_as_checked_from_the_catalog() const {
    for (const std::string& name : space.known) {
      ASSERT_TRUE(all.known.contains(name)) << name;
      const MobilityReport report = analyse_mobility(compile(expand(find_layout(name))));
      EXPECT_EQ(known(name).verdict(), to_string(report.verdict)) << name;
      EXPECT_EQ(known(name).axes(), report.axes) << name;
      EXPECT_EQ(known(name).id, all.known.at(name));
    }
  }
  void the_verdicts_of_table_1() const {
    EXPECT_EQ(known("table1-1").verdict(), "determinate");
    EXPECT_EQ(known("table1-1").axes(), "XYZA");
    std::set<std::string> reasons;
    for (const char* name : {"table1-2", "table1-3", "table1-4"}) {
      EXPECT_EQ(known(name).verdict(), "uncertain") << name;
      reasons.insert(known(name).reason());
    }
    EXPECT_EQ(reasons.size(), 3) << "uncertain for three different reasons";
    EXPECT_EQ(known("table1-5").axes(), "XYZ");
    EXPECT_EQ(known("table1-6").verdict(), "determinate");
    EXPECT_EQ(known("table1-6").pattern(), "3T1R");
  }
  void layout_1_told_from_its_singular_twin() const {
    // The same guides with all axes across instead of along: then every mirror-symmetric
    // posture is an actuation singularity.
    EXPECT_EQ(one_and_two_guides("rod, cardans radial", "rod, cardans tangential").known_as,
              "table1-1");
    const Candidate& twin = one_and_two_guides("rod, cardans tangential", "rod, cardans radial");
    EXPECT_NE(twin.verdict(), "determinate");
    EXPECT_EQ(twin.check.at("platform").at("axes"), "XYZB");
    EXPECT_GT(twin.check.at("drives").at("home_locked_platform"), 0);
  }
  void known_layouts_with_the_parameters_of_the_catalog() const {
    const auto names = [](const Layout& layout) {
      std::set<std::string> result;
      for (const Parameter& parameter : layout.parameters) result.insert(parameter.name);
      return result;
    };
    for (const std::string& name : space.known)
      EXPECT_EQ(names(candidate_layout(space, known(name).raw_index, known(name).id)),
                names(find_layout(name)))
          << name;
  }
};

TEST(Table1Space, ContainsTheSixLayoutsAndGivesThemTheirVerdicts) {
  Expectations expect{example(), {}};
  expect.all = enumerate(expect.space);
  expect.as_many_distinct_layouts_as_burnside_counts();
  expect.the_six_layouts_as_checked_from_the_catalog();
  expect.the_verdicts_of_table_1();
  expect.layout_1_told_from_its_singular_twin();
  expect.known_layouts_with_the_parameters_of_the_catalog();
}

// Homes of these layouts are singular beyond second order: chance decides which ways out are found,
// but not the verdict. 12921 can move with its drives held, mostly by spinning rods.
TEST(Table1Space, VerdictsDoNotDependOnTheSeedWhereChanceIsNeeded) {
  const Space space = example();
  for (const std::size_t raw : {1953, 1954, 5271, 5272, 5273, 12921}) {
    const Model model = compile(expand(candidate_layout(space, raw, "doubtful")));
    for (std::uint64_t seed = 1; seed <= 8; ++seed)
      for (MobilityOptions options : {screening_options(seed), MobilityOptions{seed}})
        EXPECT_EQ(analyse_mobility(model, options).verdict, Verdict::uncertain)
            << raw << " with seed " << seed << " in " << options.walks << " walks";
  }
}

}  // namespace
}  // namespace polyglide
