// Every machine at hand, put before two multibody engines that share no code with us:
// MuJoCo reads what `export --as mjcf` writes, Simbody is told the joint graph. They say how the
// loops' constraints depend on the velocities, and whether the loops are closed; ranks are
// taken here. Nothing is ever stepped in time: engines keep loops closed only softly.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "catalog/catalog.hpp"
#include "engines/oracles.hpp"

namespace polyglide::engines {
namespace {

namespace fs = std::filesystem;

const fs::path kTruth = fs::path(POLYGLIDE_SOURCE_DIR) / "tests/truth";

/// Catalog entries by name, and the machines of tests/truth by path.
std::vector<std::string> all_machines() {
  std::vector<std::string> names = catalog_names();
  for (const char* set : {"mobility", "parroblib"}) {
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(kTruth / set / "mechanisms"))
      files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    names.insert(names.end(), files.begin(), files.end());
  }
  return names;
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = fs::path(info.param).stem().string();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); },
      '_');
  return std::to_string(info.index) + "_" + name;
}

/// Where a count at one posture is not that of the report, and why.
const std::map<std::string, std::string> kExplained{
    {"table1-4",
     "With its drives held it is singular at home, and the smallest singular value grows only with "
     "the third power of the way from there. This walk ends at 1e-7 of the largest, which one "
     "posture cannot tell from zero; the report looks at several and finds it to be more."}};

class Engines : public testing::TestWithParam<std::string> {
 protected:
  Model model_ = compile(expand(find_layout(GetParam())));
};

TEST_P(Engines, AgreeAtHome) {
  const Counts ours = counts_of(model_);
  {
    SCOPED_TRACE("MuJoCo, from the MJCF");
    expect_closed_and_equal(mujoco_counts(model_), ours);
  }
  {
    SCOPED_TRACE("MuJoCo, from the URDF and its loops");
    expect_closed_and_equal(urdf_counts(model_), ours);
  }
  SCOPED_TRACE("Simbody, from the joint graph");
  expect_closed_and_equal(simbody_counts(model_), ours);
}

TEST_P(Engines, AgreeAwayFromHome) {
  const MobilityReport report = report_of(model_);
  Posture posture = home(model_);
  if (!walk(model_, posture)) {
    EXPECT_EQ(report.finite, 0) << "the walk did not leave home";
    return;
  }
  const Counts found = expect_agreement_at(model_, posture);
  // From a singular home other branches start, too; one walk follows only one.
  if (report.home != report.finite || kExplained.count(GetParam())) return;
  EXPECT_EQ(found.mobility, report.finite);
  EXPECT_EQ(found.held_mobility, report.locked_mobility);
  EXPECT_EQ(found.platform, report.platform_dof);
  EXPECT_EQ(found.held_platform, report.locked_platform);
}

INSTANTIATE_TEST_SUITE_P(All, Engines, testing::ValuesIn(all_machines()), test_name);

}  // namespace
}  // namespace polyglide::engines
