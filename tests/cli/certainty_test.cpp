#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/run_program.hpp"

// What the program says about how sure it is.
namespace polyglide::test {
namespace {

using nlohmann::json;

TEST(Certainty, AllAssemblyModesCarryCertificatesAndACompletenessEstimate) {
  const ProgramResult dut =
      run_polyglide({"pose", "hexapod-6ups", "--fk", "5,0,-5,10,20,0", "--all", "--json"});
  ASSERT_EQ(dut.status, 0) << dut.err;
  const json document = json::parse(dut.out);
  EXPECT_EQ(document.at("count"), document.at("solutions").size());
  for (const json& solution : document.at("solutions")) {
    EXPECT_TRUE(solution.at("certified").get<bool>());
    EXPECT_GT(solution.at("radius").get<double>(), 0);
    EXPECT_TRUE(solution.at("region").is_number());
  }
  EXPECT_TRUE(document.at("solutions")[0].at("connected_to_home").get<bool>());
  EXPECT_LT(document.at("completeness").at("unseen").get<double>(), 0.01);
}

TEST(Certainty, TheVolumeOfDeltaOneIsProvedToAThousandth) {
  const ProgramResult dut = run_polyglide({"workspace", "delta-1", "--json"});
  ASSERT_EQ(dut.status, 0) << dut.err;
  const json document = json::parse(dut.out);
  EXPECT_EQ(document.at("bounds"), "certified");
  const double lower = document.at("volume_bounds")[0], upper = document.at("volume_bounds")[1];
  const double volume = document.at("volume");
  EXPECT_LE(lower, volume);
  EXPECT_GE(upper, volume);
  EXPECT_LE(upper - lower, 1e-3 * volume);
}

TEST(Certainty, WithoutAClosedFormBoundsAreCalledEstimates) {
  const ProgramResult dut = run_polyglide({"workspace", "four-bar", "--json"});
  ASSERT_EQ(dut.status, 0) << dut.err;
  EXPECT_EQ(json::parse(dut.out).at("bounds"), "estimated");
}

TEST(Certainty, ABoxIsCertifiedOrFailsWithAPose) {
  const ProgramResult good = run_polyglide({"workspace", "delta-1", "--certify", "--box",
                                            "100,100,50@0,0,50", "--condition", "4", "--json"});
  ASSERT_EQ(good.status, 0) << good.err;
  const json certified = json::parse(good.out);
  EXPECT_EQ(certified.at("verdict"), "certified");
  EXPECT_EQ(certified.at("proved"), 1);
  EXPECT_LE(certified.at("worst_condition").get<double>(), 4);
  const json failed = json::parse(
      run_polyglide({"workspace", "delta-1", "--certify", "--box", "10x10x10@0,0,5000", "--json"})
          .out);
  EXPECT_EQ(failed.at("verdict"), "fails");
  EXPECT_NEAR(failed.at("pose").at("position")[2].get<double>(), 5, 0.01);
  const json turned = json::parse(run_polyglide({"workspace", "table1-6", "--certify", "--box",
                                                 "100,100,50", "--tilt", "5", "--json"})
                                      .out);
  EXPECT_EQ(turned.at("verdict"), "certified");
}

TEST(Certainty, PlanarMachinesAndCranksAreCertified) {
  for (const auto& [name, box] : {std::pair{"3-rrr-planar", "10x10x0"}, {"delta", "100x100x50"}}) {
    const json dut =
        json::parse(run_polyglide({"workspace", name, "--certify", "--box", box, "--json"}).out);
    EXPECT_EQ(dut.at("verdict"), "certified") << name << dut;
  }
}

TEST(Certainty, NonsenseIsRefused) {
  const auto refused = [](const std::vector<std::string>& arguments, const std::string& message) {
    const ProgramResult dut = run_polyglide(arguments);
    EXPECT_EQ(dut.status, 1) << dut.err;
    EXPECT_EQ(dut.out, "");
    EXPECT_TRUE(has(dut.err, message)) << dut.err;
  };
  refused({"workspace", "delta-1", "--certify"}, "--certify needs --box");
  refused({"workspace", "delta-1", "--certify", "--box", "1,1"}, "--box takes 3 lengths");
  refused({"workspace", "delta-1", "--certify", "--box", "1,-1,1"}, "0 where the machine stays");
  refused({"workspace", "delta-1", "--certify", "--box", "1,1,1@2"}, "three lengths and a place");
  refused({"workspace", "delta-1", "--certify", "--box", "1,1,1@nan,0,0"}, "finite numbers");
  refused({"workspace", "delta-1", "--certify", "--box", "1,1,1", "--tilt", "100"}, "90 degrees");
  refused({"workspace", "delta-1", "--certify", "--box", "1,1,1", "--condition", "0.5"},
          "--condition");
}

}  // namespace
}  // namespace polyglide::test
