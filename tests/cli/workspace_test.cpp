#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "answer.hpp"

// The ways to ask for a workspace.
namespace polyglide::test {
namespace {

using nlohmann::json;

void refused(const std::vector<std::string>& words, const std::string& rule) {
  const ProgramResult dut = run_polyglide(words);
  EXPECT_EQ(dut.status, 1) << dut.out;
  EXPECT_NE(dut.err.find(rule), std::string::npos) << dut.err;
}

TEST(WorkspaceCommand, OrientationsAtAPlaceSayHowFarAndWhy) {
  const json dut = answer({"workspace", "hexapod-6ups", "--orientations-at", "0,0,20"});
  EXPECT_EQ(dut.at("rotations"), "ABC");
  EXPECT_TRUE(dut.at("reachable").get<bool>());
  EXPECT_GT(dut.at("tilt_in_every_direction").at("tilt").get<double>(), 0.3);
  EXPECT_TRUE(dut.at("tilt_in_every_direction").at("limit").is_string());
  EXPECT_GT(dut.at("share").get<double>(), dut.at("share_error").get<double>());
}

TEST(WorkspaceCommand, TotalOrientationIsSmallerAndSaysWhatWasAsked) {
  const json dut = answer({"workspace", "table1-6", "--total-orientation", "20"});
  const json all = answer({"workspace", "table1-6"});
  EXPECT_LT(dut.at("volume").get<double>(), all.at("volume").get<double>());
  EXPECT_GT(dut.at("orientations").at("samples").get<int>(), 5);
  EXPECT_EQ(dut.at("bounds"), "estimated");
  EXPECT_GT(dut.at("inscribed_sphere").at("diameter").get<double>(), 0.1);
  EXPECT_FALSE(dut.at("inscribed_sphere").at("touches").empty());
}

TEST(WorkspaceCommand, ASingularityMapIsDrawn) {
  const auto file = std::filesystem::path(testing::TempDir()) / "polyglide-map.svg";
  const json dut = answer({"workspace", "hexapod-6ups", "--singularity-map", "ab", "--json",
                           "--quiet", "-o", file.string()});
  EXPECT_EQ(dut.at("slice"), "AB through home");
  EXPECT_FALSE(dut.at("curves").empty());
  EXPECT_EQ(dut.at("curves")[0].at("kind"), "direct");
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  EXPECT_NE(text.str().find("<polyline class=\"c direct\""), std::string::npos);
  std::filesystem::remove(file);
}

TEST(WorkspaceCommand, ThePageOfASingularityMapNamesItsSliceAndCountsShreds) {
  const std::string page =
      run_polyglide({"workspace", "3-rrr-planar", "--singularity-map", "xy@0,0,0,0,0,20"}).out;
  EXPECT_NE(page.find("singularities over XY at C 20°;"), std::string::npos) << page;
  EXPECT_EQ(page.find("curve of 2 points"), std::string::npos) << page;
}

TEST(WorkspaceCommand, AnEmptyWorkspaceSaysWhatStopsHome) {
  EXPECT_EQ(answer({"workspace", "table1-4"}).at("stopped_by"), "singularity");
  EXPECT_EQ(answer({"workspace", "delta-1", "--turned", "10,0,0"}).at("stopped_by"), "motion");
}

TEST(WorkspaceCommand, PlanarMachinesHaveAreas) {
  for (const char* name : {"five-bar", "3-rpr-planar", "3-rrr-planar", "3-prr-planar"}) {
    const json dut = answer({"workspace", name});
    const double area = dut.at("area").get<double>();
    EXPECT_EQ(dut.at("method"), "quadrature") << name;
    EXPECT_EQ(dut.at("volume"), 0) << name;
    EXPECT_GT(area, dut.at("area_bounds").at(0).get<double>()) << name;
    EXPECT_LT(area, dut.at("area_bounds").at(1).get<double>()) << name;
    EXPECT_LT(dut.at("area_error").get<double>(), 2e-6 * area) << name;
    EXPECT_GE(dut.at("reach").get<double>(), area * (1 - 1e-5)) << name;
  }
}

TEST(WorkspaceCommand, RefusesWhatCannotBe) {
  refused({"workspace", "delta-1", "--accuracy", "1e-20"}, "--accuracy");
  refused({"workspace", "delta-1", "--accuracy", "nan"}, "--accuracy takes a number");
  refused({"workspace", "delta-1", "--box", "-1x2x3"}, "3 positive lengths");
  refused({"workspace", "delta-1", "--orientations-at", "0,0,0"}, "this one commands XYZ");
  refused({"workspace", "hexapod-6ups", "--orientations-at", "0,inf,0"}, "finite numbers");
  refused({"workspace", "hexapod-6ups", "--orientations-at", "1,2"}, "takes x,y,z");
  refused({"workspace", "hexapod-6ups", "--total-orientation", "nan"},
          "--total-orientation takes a number");
  refused({"workspace", "hexapod-6ups", "--total-orientation", "200"}, "tilts up to 180");
  refused({"workspace", "delta-1", "--total-orientation", "5"}, "commands XYZ");
  refused({"workspace", "hexapod-6ups", "--torsion", "5"}, "--total-orientation");
  refused({"workspace", "delta-1", "--singularity-map", "xa"}, "commands: XYZ");
  refused({"workspace", "delta-1", "--singularity-map", "xx"}, "two different axes");
  refused({"workspace", "delta-1", "--singularity-map", "north"}, "two of x y z a b c");
  refused({"workspace", "delta-1", "-o", "x.svg"}, "--singularity-map");
}

TEST(WorkspaceCommand, RemarksOnALimitThatIsNone) {
  const ProgramResult dut = run_polyglide({"workspace", "four-bar", "--ignore-limits", "strok"});
  EXPECT_EQ(dut.status, 0);
  EXPECT_NE(dut.err.find("has no limit strok"), std::string::npos) << dut.err;
}

}  // namespace
}  // namespace polyglide::test
