#include "synthesis/enumerate.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include "catalog/diagnostics.hpp"
#include "kinematics/mobility.hpp"
#include "machines.hpp"
#include "synthesis/canonical.hpp"

namespace polyglide {
namespace {

using testing::Json;

Space tripods() {
  return parse_space(testing::necklace(3, {"tangential", "z", "spherical"}), "tripods");
}

// All but what depends on the clock and on where verdicts came from.
Json results(const Enumeration& enumeration) {
  Json all = Json::array();
  for (const Candidate& candidate : enumeration.candidates)
    all.push_back({candidate.id, candidate.raw_index, candidate.raw_count, candidate.symmetry,
                   candidate.known_as, candidate.choices, candidate.check});
  for (const Unbuildable& cause : enumeration.unbuildable)
    all.push_back({cause.reason, cause.raw_index, cause.raw_count});
  return all;
}

TEST(Enumerate, FindsEveryDistinctLayoutOnceWithItsVerdict) {
  const Space space = tripods();
  const Enumeration all = enumerate(space);
  EXPECT_EQ(all.raw, 27);
  EXPECT_EQ(all.candidates.size(), 10);  // bracelets of three beads in three colours
  std::uint64_t raw = 0, last = 0;
  for (const Candidate& candidate : all.candidates) {
    raw += candidate.raw_count;
    EXPECT_TRUE(candidate.raw_index >= last);
    last = candidate.raw_index;
    EXPECT_EQ(candidate.raw_count, 6 / candidate.symmetry) << "orbit times stabiliser";
    const Mechanism mechanism = expand(candidate_layout(space, candidate.raw_index, candidate.id));
    EXPECT_EQ(mechanism.name, candidate.id);
    EXPECT_EQ(short_id(canonical_form(mechanism)), candidate.id);
    EXPECT_EQ(candidate.verdict(), to_string(analyse_mobility(compile(mechanism)).verdict));
  }
  EXPECT_EQ(raw, all.raw);
}

TEST(Enumerate, DoesNotDependOnTheNumberOfThreads) {
  const Space space = tripods();
  EnumerationOptions one, two;
  one.threads = 1;
  two.threads = 2;
  EXPECT_EQ(results(enumerate(space, one)), results(enumerate(space, two)));
}

TEST(Enumerate, RejectsWhatCannotBeBuiltWithItsReason) {
  Json document = testing::necklace(3, {"tangential", "spherical"});
  const Json lengths = {testing::option("long", 800), testing::option("short", 300)};
  for (Json& limb : document["limbs"]) limb["rods"]["length"] = {{"choose", "lengths"}};
  document["choices"] = {{"lengths", {{"options", lengths}}}};
  const Enumeration all = enumerate(parse_space(document, "test"));
  EXPECT_EQ(all.raw, 16);
  EXPECT_EQ(all.candidates.size(), 4);
  ASSERT_FALSE(all.unbuildable.empty());
  std::uint64_t unbuildable = 0;
  for (const Unbuildable& cause : all.unbuildable) unbuildable += cause.raw_count;
  EXPECT_EQ(unbuildable, 8);
  EXPECT_NE(all.unbuildable[0].reason.find("rod"), std::string::npos) << all.unbuildable[0].reason;
}

TEST(Enumerate, RefusesASpaceOfWhichNothingCanBeBuilt) {
  Json document = testing::necklace(3, {"tangential"});
  for (Json& limb : document["limbs"]) limb["rods"]["length"] = 300;
  EXPECT_THROW((void)enumerate(parse_space(document, "test")), InputError);
}

TEST(Enumerate, RefusesMoreThanCanBeListed) {
  const Space space = parse_space(testing::necklace(20, {"x", "y", "z", "spherical"}), "too many");
  EXPECT_THROW((void)enumerate(space), InputError);
}

TEST(Enumerate, WritesTheAgreedDocument) {
  const auto json = to_json(enumerate(tripods()));
  EXPECT_EQ(json.at("raw"), 27);
  EXPECT_EQ(json.at("distinct"), 10);
  EXPECT_TRUE(json.at("known").empty());
  EXPECT_EQ(json.at("store"), "");
  int verdicts = 0;
  for (const auto& [verdict, count] : json.at("by_verdict").items()) verdicts += count.get<int>();
  EXPECT_EQ(verdicts, 10);
}

TEST(Enumerate, ContinuesAfterItWasKilled) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const std::filesystem::path file = "ContinuesAfterItWasKilled.db";
  const auto remove = [&] {
    for (const char* part : {"", "-wal", "-shm"}) std::filesystem::remove(file.string() + part);
  };
  if (!::testing::internal::InDeathTestChild()) remove();
  const Space space = tripods();

  const auto killed_after_five = [&] {
    Store store(file, campaign_identity(space, 1));
    EnumerationOptions options;
    options.threads = 1;
    options.store = &store;
    options.progress = [](const EnumerationProgress& progress) {
      if (progress.stage != "check" || progress.done < 5) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1500));
      std::raise(SIGKILL);
    };
    (void)enumerate(space, options);
  };
  EXPECT_EXIT(killed_after_five(), ::testing::KilledBySignal(SIGKILL), "");

  {
    Store store(file, campaign_identity(space, 1));
    EnumerationOptions options;
    options.store = &store;
    const Enumeration resumed = enumerate(space, options);
    EXPECT_EQ(resumed.checked, 5) << "five of ten were finished";
    EXPECT_EQ(results(resumed), results(enumerate(space)));
    EXPECT_EQ(enumerate(space, options).checked, 0);
  }
  remove();
}

}  // namespace
}  // namespace polyglide
