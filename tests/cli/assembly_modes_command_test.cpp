#include <chrono>
#include <cmath>

#include "answer.hpp"
#include "machine_files.hpp"

// Every machine of tests/truth/forward_kinematics.json, asked for all its assembly modes as a user
// would. Home is the first solution of the file, where its machine can be assembled.
namespace polyglide::test {
namespace {

using nlohmann::json;

/// A machine, the drives to ask for, and what is known of the platform.
struct ForwardCase {
  std::string machine;                    ///< NAME and settings
  std::vector<std::string> set;           ///< more words
  std::vector<double> drives;             ///< from home
  std::vector<Eigen::Isometry3d> places;  ///< of the platform from home, about the base frame
  Vector3d tool = Vector3d::Zero();       ///< point at home
};

Eigen::Isometry3d place_of(const json& solution) {
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.linear() = matrix3(solution.at("R"));
  if (solution.contains("t")) place.translation() = point(solution.at("t"));
  return place;
}

/// Places as displacements from the first.
std::vector<Eigen::Isometry3d> from_first(std::vector<Eigen::Isometry3d> places) {
  const Eigen::Isometry3d home = places.front().inverse();
  for (auto& place : places) place = place * home;
  return places;
}

ForwardCase six_struts(const json& data, const std::string& name, const TemporaryFolder& folder) {
  ForwardCase made;
  for (const json& solution : data.at("solutions")) made.places.push_back(place_of(solution));
  const Eigen::Isometry3d home = made.places.front();
  made.tool = home.translation();
  MachineFile file(name, made.tool);
  for (std::size_t i = 0; i < 6; ++i) {
    const Vector3d foot = point(data.at("base")[i]), head = home * point(data.at("platform")[i]);
    file.strut(foot, head);
    made.drives.push_back(data.at("leg_lengths")[i].get<double>() - (head - foot).norm());
  }
  made.machine = file.in(folder);
  made.places = from_first(made.places);
  return made;
}

ForwardCase planar_struts(const json& data, const std::string& name,
                          const TemporaryFolder& folder) {
  ForwardCase made;
  for (const json& s : data.at("solutions_x_y_phi")) {
    Eigen::Isometry3d place(Eigen::AngleAxisd(s[2].get<double>(), Vector3d::UnitZ()));
    place.pretranslate(Vector3d(s[0].get<double>(), s[1].get<double>(), 0));
    made.places.push_back(place);
  }
  const auto length = [&](const char* key) { return data.at(key).get<double>(); };
  const double x =
      (std::pow(length("d12"), 2) + std::pow(length("d13"), 2) - std::pow(length("d23"), 2)) /
      (2 * length("d12"));
  const std::vector<Vector3d> corners{
      Vector3d::Zero(), Vector3d(length("d12"), 0, 0),
      Vector3d(x, std::sqrt(std::pow(length("d13"), 2) - x * x), 0)};
  const Eigen::Isometry3d home = made.places.front();
  made.tool = home.translation();
  MachineFile file(name, made.tool);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d foot = point(data.at("base")[i]), head = home * corners[i];
    file.strut(foot, head, {Vector3d::UnitZ()}, {Vector3d::UnitZ()});
    made.drives.push_back(data.at("rho")[i].get<double>() - (head - foot).norm());
  }
  made.machine = file.in(folder);
  made.places = from_first(made.places);
  return made;
}

/// Balls of the 3-RPS with its hinges at angles f.
std::vector<Vector3d> balls_at(const json& data, const json& f) {
  std::vector<Vector3d> balls;
  for (std::size_t i = 0; i < 3; ++i) {
    const double turn = data.at("azimuth_deg")[i].get<double>() * M_PI / 180;
    const double angle = f.at(i).get<double>();
    const Vector3d out(std::cos(turn), std::sin(turn), 0);
    balls.emplace_back(data.at("base_radius").get<double>() * out +
                       data.at("leg_lengths")[i].get<double>() *
                           (std::sin(angle) * Vector3d::UnitZ() - std::cos(angle) * out));
  }
  return balls;
}

/// The frame of three points.
Eigen::Isometry3d frame_of(const std::vector<Vector3d>& points) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  const Vector3d x = (points[1] - points[0]).normalized();
  const Vector3d z = x.cross(points[2] - points[0]).normalized();
  frame.linear() << x, z.cross(x), z;
  frame.translation() = (points[0] + points[1] + points[2]) / 3;
  return frame;
}

ForwardCase three_rps(const json& data, const std::string& name, const TemporaryFolder& folder) {
  ForwardCase made;
  for (const json& f : data.at("solutions_f")) made.places.push_back(frame_of(balls_at(data, f)));
  const auto home = balls_at(data, data.at("solutions_f").at(0));
  made.tool = (home[0] + home[1] + home[2]) / 3;
  MachineFile file(name, made.tool);
  for (std::size_t i = 0; i < 3; ++i) {
    const double turn = data.at("azimuth_deg")[i].get<double>() * M_PI / 180;
    const Vector3d out(std::cos(turn), std::sin(turn), 0);
    file.strut(data.at("base_radius").get<double>() * out, home[i], {Vector3d::UnitZ().cross(out)});
  }
  made.drives = {0, 0, 0};
  made.machine = file.in(folder);
  made.places = from_first(made.places);
  return made;
}

ForwardCase agile_eye(const json& data, const std::string& name, const TemporaryFolder& folder) {
  ForwardCase made;
  for (const json& rotation : data.at("solutions_R"))
    made.places.push_back(place_of({{"R", rotation}}));
  // The first has entries -1, 0 and 1.
  made.places.front().linear() = made.places.front().linear().array().round().matrix();
  MachineFile file(name);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string arm = fmt::format("arm{}", i + 1), link = fmt::format("link{}", i + 1);
    file.hinge("base", arm, Vector3d::Zero(), point(data.at("u")[i]), true);
    file.hinge(arm, link, Vector3d::Zero(), point(data.at("w_ref")[i]));
    file.hinge(link, "platform", Vector3d::Zero(),
               made.places.front() * point(data.at("v_ref")[i]));
  }
  made.drives = data.at("theta").get<std::vector<double>>();
  made.machine = file.in(folder);
  made.places = from_first(made.places);
  return made;
}

ForwardCase linear_delta(const json& data, const std::string&, const TemporaryFolder&) {
  const json& values = data.at("values");
  const double e = values.at("e").get<double>(), rod = values.at("L").get<double>();
  ForwardCase made;
  made.machine = POLYGLIDE_SOURCE_DIR "/tests/cli/machines/linear-delta.json";
  made.set = {"--set", "e=" + word({e}), "--set", "L=" + word({rod})};
  made.drives = values.at("q").get<std::vector<double>>();
  for (double& drive : made.drives) drive -= std::sqrt(rod * rod - e * e);
  for (const json& solution : values.at("solutions"))
    made.places.emplace_back(Eigen::Translation3d(point(solution)));
  return made;
}

struct Kind {
  const char* name;
  ForwardCase (*make)(const json&, const std::string&, const TemporaryFolder&);
  const char* count;  ///< key of the number of modes
  bool complete;      ///< whether as many modes as there can be are certified
};

class EveryAssemblyMode : public testing::TestWithParam<Kind> {};

/// How far a solution is from a place, in rotation [rad] and in the tool's position.
double distance(const json& solution, const Eigen::Isometry3d& place, const Vector3d& tool) {
  const json& pose = solution.at("pose");
  const json& q = pose.at("quaternion");
  const Eigen::Quaterniond rotation(q[0].get<double>(), q[1].get<double>(), q[2].get<double>(),
                                    q[3].get<double>());
  return rotation.angularDistance(Eigen::Quaterniond(place.linear())) +
         (point(pose.at("position")) - (place * tool - tool)).norm() / (1 + tool.norm());
}

TEST_P(EveryAssemblyMode, IsFoundAndCertified) {
  const TemporaryFolder folder;
  const Kind& kind = GetParam();
  const json data = truth("forward_kinematics.json").at(kind.name);
  const ForwardCase made = kind.make(data, kind.name, folder);
  std::vector<std::string> words{"pose", made.machine, "--fk=" + word(made.drives), "--all"};
  words.insert(words.end(), made.set.begin(), made.set.end());
  const auto start = std::chrono::steady_clock::now();
  const json dut = answer(words);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ASSERT_EQ(dut.at("count"), data.at(kind.count)) << dut.at("completeness");
  for (const Eigen::Isometry3d& place : made.places) {
    double nearest = 9;
    for (const json& solution : dut.at("solutions"))
      nearest = std::min(nearest, distance(solution, place, made.tool));
    EXPECT_LT(nearest, 1e-6) << place.matrix();
  }
  for (const json& solution : dut.at("solutions")) {
    EXPECT_TRUE(solution.at("certified").get<bool>()) << solution;
    EXPECT_LT(solution.at("residual").get<double>(), 1e-9);
  }
  EXPECT_EQ(dut.at("completeness").at("complete").get<bool>(), kind.complete);
  std::printf("%-30s %3zu modes in %.3f s, %d starts\n", kind.name, dut.at("solutions").size(),
              seconds, dut.at("completeness").at("starts").get<int>());
  EXPECT_LT(seconds, 20);  // below 1 s on a machine that does nothing else
}

INSTANTIATE_TEST_SUITE_P(
    Truth, EveryAssemblyMode,
    testing::Values(Kind{"dietmaier_40", six_struts, "count_real", true},
                    Kind{"platform_3_2_1", six_struts, "count_real", true},
                    Kind{"planar_3RPR_innocenti_merlet", planar_struts, "count_real", true},
                    Kind{"3RPS_symmetric", three_rps, "count_real", true},
                    Kind{"linear_delta_FK", linear_delta, "count_real", true},
                    Kind{"agile_eye_theta_0_0_0", agile_eye, "count_real_isolated", true}),
    [](const auto& one) { return "Of_" + std::string(one.param.name); });

/// The most modes of a family, as the file's table of published counts has them.
TEST(ModeBounds, AreThoseOfTheLiterature) {
  const json table =
      truth("forward_kinematics.json").at("counts_table").at("max_real_assembly_modes");
  const std::vector<std::pair<std::string, std::string>> machines{
      {"general_6UPS", "gough-platform"},
      {"octahedral_3_3", "octahedral-3-3"},
      {"planar_3RPR", "3-rpr-planar"},
      {"planar_3RRR", "3-rrr-planar"},
      {"general_3RS_3RPS", "3-rps"},
      {"spherical_3dof", "3-rrr-spherical"},
      {"agile_eye", "agile-eye"},
      {"delta_linear_delta_orthoglide", "orthoglide"},
      {"delta_linear_delta_orthoglide", "delta"},
      {"tripteron", "tripteron"},
      {"five_bar", "five-bar"}};
  for (const auto& [family, machine] : machines) {
    const int drives = answer({"check", machine}).at("drives").at("count").get<int>();
    const json dut =
        answer({"pose", machine, "--fk=" + word(std::vector<double>(drives, 0.0)), "--all"});
    const int most = std::stoi(table.at(family).get<std::string>());
    EXPECT_EQ(dut.at("completeness").at("bound"), most) << machine;
    EXPECT_LE(dut.at("count").get<int>(), most) << machine;
  }
}

}  // namespace
}  // namespace polyglide::test
