// Laws of verdicts: the same machine written in another way gets the same answer. Every catalog
// entry and every truth case, several thousand seeded variations.

#include <gtest/gtest.h>

#include "cases.hpp"
#include "catalog/json_file.hpp"
#include "kinematics/branches.hpp"
#include "kinematics/limb_wrenches.hpp"
#include "kinematics/motion.hpp"
#include "variations.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

/// "name" of the catalog, or "set/name" of a truth case.
Mechanism machine(const std::string& name) {
  const std::size_t slash = name.find('/');
  if (slash == std::string::npos) return expand(find_layout(name));
  return expand(load_layout(kTruth / name.substr(0, slash) / "mechanisms" /
                            (name.substr(slash + 1) + ".json")));
}

std::vector<std::string> machines() {
  std::vector<std::string> names = catalog_names();
  for (const std::string set : {"mobility", "parroblib"}) {
    const nlohmann::json expected = read_json(kTruth / set / "expected.json");
    for (const auto& entry : expected.items()) names.push_back(set + "/" + entry.key());
  }
  return names;
}

MobilityReport briefly_checked(const Mechanism& mechanism, std::uint64_t seed = 1) {
  return analyse_mobility(compile(mechanism), {.seed = seed, .walks = 2, .evidence = false});
}

/// All that holds at any generic posture of the same branch.
void expect_same_motion(const MobilityReport& a, const MobilityReport& b) {
  EXPECT_EQ(a.finite, b.finite);
  EXPECT_EQ(a.kutzbach, b.kutzbach);
  EXPECT_EQ(a.redundant_constraints, b.redundant_constraints);
  EXPECT_EQ(a.idle, b.idle);
  EXPECT_EQ(a.platform_dof, b.platform_dof);
  EXPECT_EQ(a.pattern, b.pattern);
  EXPECT_EQ(a.locked_mobility, b.locked_mobility);
  EXPECT_EQ(a.locked_platform, b.locked_platform);
  EXPECT_EQ(a.surplus, b.surplus);
}

void expect_same_verdict(const MobilityReport& a, const MobilityReport& b) {
  EXPECT_EQ(to_string(a.verdict), to_string(b.verdict));
  EXPECT_EQ(a.home, b.home);
  EXPECT_EQ(a.platform_home_dof, b.platform_home_dof);
  EXPECT_EQ(a.home_locked_platform, b.home_locked_platform);
  expect_same_motion(a, b);
  EXPECT_GT(b.rank_gap, 1e3);
}

class VerdictOf : public testing::TestWithParam<std::string> {
 protected:
  Mechanism mechanism_ = machine(GetParam());
  MobilityReport reference_ = briefly_checked(mechanism_);
};

TEST_P(VerdictOf, DoesNotDependOnTheSeed) {
  for (std::uint64_t seed = 2; seed < 6; ++seed)
    expect_same_verdict(reference_, briefly_checked(mechanism_, seed));
}

TEST_P(VerdictOf, DoesNotDependOnUnitFrameOrderOrWhichBodyOfAJointComesFirst) {
  std::mt19937_64 random(7);
  for (const double scale : {1e-3, 0.0254, 1.0, 1e3}) {
    SCOPED_TRACE(testing::Message() << "scale " << scale);
    const Mechanism other = variations::swapped(variations::renumbered(mechanism_, random), random);
    expect_same_verdict(reference_, briefly_checked(variations::moved(
                                        other, variations::random_frame(random, scale), scale)));
  }
}

/// What a limb is and bears, without the order of its joints.
struct Limb {
  std::vector<std::string> joints;  ///< sorted
  int connectivity = 0;
  std::size_t constraints = 0, actuations = 0;
  auto operator<=>(const Limb&) const = default;
};

/// Sorted.
std::vector<Limb> limbs_of(const Mechanism& mechanism) {
  std::vector<Limb> limbs;
  for (const LimbWrenches& limb : limb_wrenches(mechanism)) {
    limbs.push_back(
        {limb.joints, limb.connectivity, limb.constraints.size(), limb.actuations.size()});
    std::ranges::sort(limbs.back().joints);
  }
  std::ranges::sort(limbs);
  return limbs;
}

TEST_P(VerdictOf, LimbsDoNotDependOnOrderOrWhichBodyOfAJointComesFirst) {
  const std::vector<Limb> reference = limbs_of(mechanism_);
  std::mt19937_64 random(17);
  for (int i = 0; i < 8; ++i)
    EXPECT_TRUE(limbs_of(variations::swapped(variations::renumbered(mechanism_, random), random)) ==
                reference)
        << i;
}

TEST_P(VerdictOf, HoldsAtDrawingPrecision) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 4; ++i) {
    SCOPED_TRACE(testing::Message() << "drawing " << i);
    const Mechanism turned =
        variations::moved(mechanism_, variations::random_frame(random, i % 2), 1000);
    expect_same_verdict(reference_, briefly_checked(variations::drawn(turned, 9)));
  }
}

TEST_P(VerdictOf, HoldsFromAnotherPostureOfTheBranch) {
  const Model model = compile(mechanism_);
  const Posture start = home(model);
  std::mt19937_64 random(13);
  const Freedoms free = freedoms_at(model, start);
  const Departure departure = leave(model, start, free.kernel, false, {2, 2, 0.2}, random);
  if (departure.branches.size() != 1) GTEST_SKIP() << "home is a meeting of branches, or rigid";
  for (const auto& [posture, there] : departure.branches.front().far) {
    const MobilityReport report = briefly_checked(variations::taken_at(model, posture));
    expect_same_motion(reference_, report);
    const bool regular =
        departure.smooth && reference_.home_locked_platform == reference_.locked_platform;
    if (regular) {
      EXPECT_EQ(to_string(report.verdict), to_string(reference_.verdict));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Machines, VerdictOf, testing::ValuesIn(machines()), test_name);

}  // namespace
}  // namespace polyglide
