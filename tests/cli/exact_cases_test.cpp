#include <cmath>
#include <numbers>

#include "answer.hpp"
#include "machine_files.hpp"

// Every exact case of tests/truth/workspace_conditioning_stiffness.json that the command line can
// be asked. What it cannot: gough_identifiability_full_pose, since nothing calibrates yet; and
// max_span of the linear Delta, which is a step of the closed form of its volume.
namespace polyglide::test {
namespace {

using nlohmann::json;

constexpr double kDefault = 1e-6, kFine = 1e-9;  // relative

const std::string kOrthoglide = POLYGLIDE_SOURCE_DIR "/tests/cli/machines/orthoglide.json";
const std::string kLinearDelta = POLYGLIDE_SOURCE_DIR "/tests/cli/machines/linear-delta.json";

json exact(const std::string& name) {
  return truth("workspace_conditioning_stiffness.json").at(name);
}

void expect_close(double dut, double expected, double relative) {
  EXPECT_NEAR(dut, expected, relative * std::abs(expected));
}

/// Size of a workspace, at the default and at a fine accuracy, singular surfaces no limit.
void expect_size(std::vector<std::string> words, const std::string& key, double expected) {
  words.insert(words.begin(), "workspace");
  const json usual = answer(words);
  expect_close(usual.at(key).get<double>(), expected, kDefault);
  EXPECT_EQ(usual.at("method"), "quadrature");
  words.insert(words.end(), {"--accuracy", "1e-9"});
  const json fine = answer(words);
  expect_close(fine.at(key).get<double>(), expected, kFine);
  EXPECT_LE(fine.at(key + "_error").get<double>(), kFine * expected);
}

const std::vector<std::string> kReach{"--ignore-limits", "singularity"};

std::vector<std::string> with(std::vector<std::string> words,
                              const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

json pose(const std::string& machine, const std::vector<double>& at,
          const std::vector<std::string>& more = {}) {
  return answer(with({"pose", machine, "--ik=" + word(at)}, more));
}

double entry(const json& matrix, int i, int j) { return matrix.at(i).at(j).get<double>(); }

/// Entries on the diagonal as expected, all others nothing beside the greatest of them.
void expect_diagonal(const json& matrix, const std::vector<double>& expected) {
  const auto n = static_cast<int>(expected.size());
  ASSERT_EQ(matrix.size(), expected.size());
  const double greatest = *std::max_element(expected.begin(), expected.end());
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      EXPECT_NEAR(entry(matrix, i, j), i == j ? expected[i] : 0, kFine * greatest) << i << j;
}

void expect_values(const json& dut, std::vector<double> expected) {
  ASSERT_EQ(dut.size(), expected.size());
  std::sort(expected.rbegin(), expected.rend());
  for (std::size_t i = 0; i < expected.size(); ++i)
    expect_close(dut.at(i).get<double>(), expected[i], kFine);
}

/// Six telescopes in pairs to one centre each: with the platform unturned every pair has the tool
/// in a ball about its centre. The platform joints lie about the tool, which home lifts.
std::string balls(const TemporaryFolder& folder, const std::string& name,
                  const std::vector<Vector3d>& centres, const Vector3d& tool, double longest) {
  MachineFile file(name, tool);
  for (int i = 0; i < 6; ++i) {
    const double angle = i * std::numbers::pi / 3 + 0.1 * i;
    const Vector3d arm(0.4 * std::cos(angle), 0.4 * std::sin(angle), 0.05 * (i % 3));
    const Vector3d foot = centres[i / 2] + arm, head = tool + arm;
    const double length = (head - foot).norm();
    file.strut(foot, head, {}, {}, {-length, longest - length});
  }
  return file.in(folder);
}

TEST(ExactWorkspace, OrthoglideIsTheSolidOfThreeCylinders) {
  expect_size(with({kOrthoglide}, kReach), "volume",
              exact("orthoglide_reach_volume").at("value").get<double>());
}

TEST(ExactWorkspace, LinearDelta) {
  const json expected = exact("linear_delta_vertical_e0.25_L1.0_H1.5");
  expect_size({kLinearDelta, "--ignore-limits", "singularity,slab"}, "volume",
              expected.at("value").get<double>());
}

TEST(ExactWorkspace, ASlabOfTheLinearDeltaIsItsShadow) {
  const json expected = exact("linear_delta_vertical_e0.25_L1.0_H1.5");
  expect_size({kLinearDelta, "--set", "home=0.2", "--ignore-limits", "singularity"}, "volume",
              0.2 * expected.at("area_closed_form").get<double>());
}

TEST(ExactWorkspace, AGoughPlatformWhoseShellsCoincide) {
  const TemporaryFolder folder;
  MachineFile file("congruent", Vector3d(0, 0, 1.25));
  for (int i = 0; i < 6; ++i) {
    const double angle = i * std::numbers::pi / 3 + (i % 2 == 0 ? 0.2 : -0.2);
    const Vector3d foot(std::cos(angle), std::sin(angle), 0);
    file.strut(foot, foot + Vector3d(0, 0, 1.25), {}, {}, {-0.25, 0.25});
  }
  const std::string machine = file.in(folder);
  const double expected = exact("gough_congruent_const_orientation").at("value").get<double>();
  expect_size(with({machine}, kReach), "volume", expected);
  EXPECT_TRUE(answer({"workspace", machine}).at("singular_throughout").get<bool>());
}

TEST(ExactWorkspace, AFiveBarReachesALens) {
  // Scaled: cranks and rods of 200 mm, motors 200 mm apart.
  const double height = 200 + 200 * std::sqrt(0.75);
  expect_size({"five-bar", "--set", "d=100", "--set", "px=0", "--set", "py=200", "--set",
               "ty=" + word({height}), "--ignore-limits", "singularity,stroke"},
              "area", 0.04 * exact("five_bar_reach_area").at("value").get<double>());
}

TEST(ExactWorkspace, ThreeUnitBalls) {
  const TemporaryFolder folder;
  const double r = 1 / std::sqrt(3), s = std::sqrt(0.75);
  expect_size(with({balls(folder, "three-balls", {{r, 0, 0}, {-r / 2, 0.5, 0}, {-r / 2, -0.5, 0}},
                          {0, 0, s / 3}, 1)},
                   kReach),
              "volume", exact("three_unit_spheres_distance1").at("value").get<double>());
}

TEST(ExactWorkspace, TwoBallsMakeALens) {
  const TemporaryFolder folder;
  expect_size(
      with({balls(folder, "lens", {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}, {0.5, 0.2, 0.3}, 1)}, kReach),
      "volume", exact("two_spheres_lens").at("value").get<double>());
}

TEST(ExactConditioning, OrthoglideIsIsotropicAtHome) {
  const json dut = pose(kOrthoglide, {0, 0, 0});
  expect_close(dut.at("condition").get<double>(),
               exact("orthoglide_home_condition").at("value").get<double>(), kFine);
  expect_diagonal(dut.at("jacobian"), {1, 1, 1});
}

TEST(ExactConditioning, TheCubeOfTheOrthoglide) {
  const json expected = exact("orthoglide_cube").at("values");
  const double rod = expected.at("L_for_200mm").get<double>() / 1000;
  const std::string length = "L=" + word({rod});
  const double from = rod * expected.at("t_min_over_L").get<double>();
  const double to = rod * expected.at("t_max_over_L").get<double>();
  expect_close(to - from, rod * expected.at("cube_edge_over_L").get<double>(), kFine);
  expect_close(to - from, 0.2, kFine);
  // Its two ends, where the amplification has its bounds 2 and 1/2 ...
  const json low = pose(kOrthoglide, {from, from, from}, {"--set", length});
  const json high = pose(kOrthoglide, {to, to, to}, {"--set", length});
  expect_values(low.at("singular_values"), {2, 0.5, 0.5});
  expect_values(high.at("singular_values"), {0.5, 1.25, 1.25});
  // ... and the stroke, from the least drive to the greatest: with two coordinates at zero.
  const json far = pose(kOrthoglide, {to, 0, 0}, {"--set", length});
  const double stroke = far.at("drives").at(0).get<double>() - low.at("drives").at(0).get<double>();
  expect_close(stroke, rod * expected.at("stroke_over_L").get<double>(), kFine);
  expect_close(stroke, expected.at("stroke_for_200mm").get<double>() / 1000, kFine);
}

TEST(ExactConditioning, TheCubeOfTheOrthoglideIsProved) {
  const json expected = exact("orthoglide_cube").at("values");
  const double rod = expected.at("L_for_200mm").get<double>() / 1000;
  const double middle =
      rod / 2 *
      (expected.at("t_min_over_L").get<double>() + expected.at("t_max_over_L").get<double>());
  const auto certificate = [&](const std::string& condition) {
    return answer({"workspace", kOrthoglide, "--set", "L=" + word({rod}), "--certify", "--box",
                   "0.2,0.2,0.2@" + word({middle, middle, middle}), "--condition", condition});
  };
  // 4 = 2 : 1/2 is the worst, in one corner.
  EXPECT_EQ(certificate("4.04").at("verdict"), "certified");
  EXPECT_EQ(certificate("3.99").at("verdict"), "fails");
}

TEST(ExactConditioning, LinearDeltaOnItsAxis) {
  for (const double e : {0.3, std::sqrt(2.0 / 3)}) {
    const double tangent = e / std::sqrt(1 - e * e);
    const double side = std::sqrt(1.5) * tangent;
    const json dut = pose(kLinearDelta, {0, 0, 0.2}, {"--set", "e=" + word({e})});
    expect_values(dut.at("singular_values"), {std::sqrt(3), side, side});
    const double worse = std::max(std::sqrt(3) / side, side / std::sqrt(3));
    expect_close(dut.at("condition").get<double>(), worse, kFine);
  }
  // The printed check of the file, of e = 0.3.
  EXPECT_TRUE(has(exact("linear_delta_axis_singular_values").at("check"), "0.3851644432598216"));
}

TEST(ExactConditioning, APlanarThreeRprIsIsotropicWithTheRightLength) {
  const TemporaryFolder folder;
  const double d = 0.37;
  MachineFile file("isotropic-3-rpr");
  for (int i = 0; i < 3; ++i) {
    const double angle = i * 2 * std::numbers::pi / 3;
    const Vector3d out(std::cos(angle), std::sin(angle), 0), along(-out.y(), out.x(), 0);
    file.strut(d * out - along, d * out, {Vector3d::UnitZ()}, {Vector3d::UnitZ()});
  }
  const json dut =
      pose(file.in(folder), {0, 0, 0}, {"--characteristic-length", word({std::sqrt(2) * d})});
  expect_close(dut.at("condition").get<double>(),
               exact("planar_3RPR_isotropic").at("value").get<double>(), kFine);
  EXPECT_EQ(dut.at("axes"), "XYC");
  // JᵀJ, as the stiffness of unit drives.
  expect_diagonal(dut.at("stiffness").at("matrix"), {1.5, 1.5, 3 * d * d});
}

TEST(ExactConditioning, TheTripteronIsOneToOneEverywhere) {
  const json dut = answer({"workspace", "tripteron"}).at("conditioning");
  for (const char* key : {"global", "worst", "best"})
    EXPECT_NEAR(dut.at(key).get<double>(), exact("tripteron_stiffness").at("value").get<double>(),
                1e-6)
        << key;
}

TEST(ExactStiffness, CubicHexapod) {
  const TemporaryFolder folder;
  MachineFile file("cubic");
  const json legs = exact("cubic_hexapod_legs").at("values");
  for (const json& leg : legs) file.strut(point(leg.at(0)), point(leg.at(1)));
  const json dut = pose(file.in(folder), {0, 0, 0}).at("stiffness");
  expect_diagonal(
      dut.at("matrix"),
      exact("cubic_hexapod_stiffness").at("values").at("diag").get<std::vector<double>>());
  EXPECT_NEAR(dut.at("translation").at("min").get<double>(), 2, kFine);
  EXPECT_NEAR(dut.at("translation").at("max").get<double>(), 2, kFine);
  EXPECT_NEAR(dut.at("rotation").at("min").get<double>(), 0.5, kFine);
  EXPECT_NEAR(dut.at("rotation").at("max").get<double>(), 2, kFine);
}

TEST(ExactStiffness, LinearDeltaOnItsAxis) {
  const json expected = exact("linear_delta_axis_stiffness").at("values");
  const auto value = [&](const char* key) { return expected.at(key).get<double>(); };
  const json dut =
      pose(kLinearDelta, {0, 0, 0.2},
           {"--set", "e=" + word({value("e")}), "--set", "L=" + word({value("L")}),
            "--drive-stiffness", word({value("ka")}), "--rod-stiffness", word({value("kr")})})
          .at("stiffness");
  expect_diagonal(dut.at("matrix"), {value("Kxx"), value("Kyy"), value("Kzz")});
  expect_close(dut.at("translation").at("min").get<double>(), value("Kxx"), kFine);
  expect_close(dut.at("translation").at("max").get<double>(), value("Kzz"), kFine);
  EXPECT_TRUE(dut.at("rotation").is_null());
}

TEST(ExactStiffness, OrthoglideAtHome) {
  const double unit = exact("orthoglide_home_stiffness").at("value").get<double>();
  const double drive = 3e7, rods = 8e7, both = 1 / (1 / drive + 1 / rods);
  expect_diagonal(pose(kOrthoglide, {0, 0, 0}).at("stiffness").at("matrix"), {unit, unit, unit});
  const json dut = pose(kOrthoglide, {0, 0, 0},
                        {"--drive-stiffness", word({drive}), "--rod-stiffness", word({rods})});
  expect_diagonal(dut.at("stiffness").at("matrix"), {unit * both, unit * both, unit * both});
}

TEST(ExactStiffness, TheTripteronHasThatOfItsDrives) {
  const double unit = exact("tripteron_stiffness").at("value").get<double>();
  const std::vector<double> drives{1e6, 2e6, 3e6};
  for (const auto& at : {std::vector<double>{0, 0, 0}, {50, -80, 30}}) {
    const json dut = pose("tripteron", at, {"--drive-stiffness", word(drives)});
    expect_close(dut.at("condition").get<double>(), unit, kFine);
    expect_diagonal(dut.at("stiffness").at("matrix"),
                    {unit * drives[0], unit * drives[1], unit * drives[2]});
  }
}

TEST(ExactPose, LinearDeltaHasTwoSolutions) {
  const json expected = exact("linear_delta_FK").at("values");
  const double e = expected.at("e").get<double>(), rod = expected.at("L").get<double>();
  std::vector<double> drives = expected.at("q").get<std::vector<double>>();
  for (double& drive : drives) drive -= std::sqrt(rod * rod - e * e);
  const json dut = answer({"pose", kLinearDelta, "--set", "e=" + word({e}), "--set",
                           "L=" + word({rod}), "--fk=" + word(drives), "--all"});
  ASSERT_EQ(dut.at("count"), expected.at("solutions").size());
  for (const json& solution : expected.at("solutions")) {
    double nearest = 1;
    for (const json& found : dut.at("solutions")) {
      EXPECT_TRUE(found.at("certified").get<bool>());
      EXPECT_GT(found.at("condition").get<double>(), 1);
      nearest =
          std::min(nearest, (point(found.at("pose").at("position")) - point(solution)).norm());
    }
    EXPECT_LT(nearest, kFine * rod);
  }
}

}  // namespace
}  // namespace polyglide::test
