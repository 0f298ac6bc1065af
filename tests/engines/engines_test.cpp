// Every machine at hand, put before two multibody engines that share no code with us:
// MuJoCo reads what `export --as mjcf` writes, Simbody is told the joint graph. They say how the
// loops' constraints depend on the velocities, and whether the loops are closed; ranks are
// taken here. Nothing is ever stepped in time: engines keep loops closed only softly.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <filesystem>
#include <map>
#include <ostream>
#include <regex>

#include "catalog/catalog.hpp"
#include "catalog/elementary_motion.hpp"
#include "catalog/engine_tree.hpp"
#include "catalog/json_file.hpp"
#include "catalog/write_mjcf.hpp"
#include "catalog/write_urdf.hpp"
#include "engines/mujoco_oracle.hpp"
#include "engines/simbody_oracle.hpp"
#include "kinematics/manifold.hpp"
#include "kinematics/mobility.hpp"
#include "kinematics/rank.hpp"

namespace polyglide::engines {
namespace {

namespace fs = std::filesystem;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

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

/// What an engine finds, in the words of our report.
struct Counts {
  double residual = 0;  ///< largest, lengths by the machine's size
  int mobility = 0, held_mobility = 0;
  int platform = 0, held_platform = 0;
  friend bool operator==(const Counts& a, const Counts& b) {
    return std::tie(a.mobility, a.held_mobility, a.platform, a.held_platform) ==
           std::tie(b.mobility, b.held_mobility, b.platform, b.held_platform);
  }
  friend std::ostream& operator<<(std::ostream& out, const Counts& c) {
    return out << "mobility " << c.mobility << ", drives held " << c.held_mobility << "; platform "
               << c.platform << ", drives held " << c.held_platform;
  }
};

/// A rule of its own: singular values below 1e-7 are zero. Ours looks for the largest gap.
constexpr double kZero = 1e-7;

Eigen::MatrixXd kernel(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return Eigen::MatrixXd::Identity(matrix.cols(), matrix.cols());
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeFullV);
  const auto& values = svd.singularValues();
  const auto rank = (values.array() > kZero * std::max(values[0], 1e-300)).count();
  return svd.matrixV().rightCols(matrix.cols() - rank);
}

/// Number of independent platform velocities among the motions that are free.
int platform_freedom(const Eigen::MatrixXd& platform, const Eigen::MatrixXd& free) {
  if (free.size() == 0) return 0;
  const Eigen::MatrixXd velocities = platform * free;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(velocities);
  return static_cast<int>((svd.singularValues().array() > kZero * platform.norm()).count());
}

/// Ranks of a system whose lengths are measured in `size`.
Counts counts_of(const ConstraintSystem& system, double size) {
  const auto map = [&](const std::vector<double>& values, int rows) {
    return Eigen::MatrixXd(Eigen::Map<const Matrix>(values.data(), rows, system.columns));
  };
  Eigen::MatrixXd jacobian = map(system.jacobian, system.rows);
  Eigen::MatrixXd platform = map(system.platform, 6);
  Counts counts;
  for (int r = 0; r < system.rows; ++r)
    if (system.row_is_length[r]) jacobian.row(r) /= size;
  platform.bottomRows(3) /= size;
  for (int c = 0; c < system.columns; ++c) {
    if (!system.column_is_length[c]) continue;
    jacobian.col(c) *= size;
    platform.col(c) *= size;
  }
  for (std::size_t r = 0; r < system.residual.size(); ++r)
    counts.residual =
        std::max(counts.residual,
                 std::abs(system.residual[r]) /
                     (r < system.row_is_length.size() && system.row_is_length[r] ? size : 1));
  const Eigen::MatrixXd free = kernel(jacobian);
  counts.mobility = static_cast<int>(free.cols());
  counts.platform = platform_freedom(platform, free);
  std::vector<int> passive;
  for (int c = 0; c < system.columns; ++c)
    if (!system.column_is_driven[c]) passive.push_back(c);
  const Eigen::MatrixXd held = kernel(jacobian(Eigen::all, passive));
  counts.held_mobility = static_cast<int>(held.cols());
  counts.held_platform = platform_freedom(platform(Eigen::all, passive), held);
  return counts;
}

MobilityReport report_of(const Model& model) {
  MobilityOptions options;
  options.evidence = false;
  return analyse_mobility(model, options);
}

/// The same from polyglide, at home.
Counts counts_of(const Model& model) {
  const MobilityReport report = report_of(model);
  const Eigen::MatrixXd held =
      columns(closure_jacobian(model, home(model)), passive_freedoms(model));
  Counts counts;
  counts.mobility = report.home;
  counts.held_mobility = static_cast<int>(kernel_of(held).basis.cols());
  counts.platform = report.platform_home_dof;
  counts.held_platform = report.home_locked_platform;
  return counts;
}

std::array<double, 3> plain(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

/// In units of the machine's size, about its centre: without dimensions for Simbody.
PlainMechanism plain(const Model& model) {
  const Mechanism& mechanism = model.mechanism;
  const auto scaled = [&](const Vector3& point) {
    return plain((point - model.centre) / model.size);
  };
  PlainMechanism result{static_cast<int>(mechanism.bodies.size()),
                        mechanism.base,
                        mechanism.platform,
                        scaled(mechanism.tool),
                        {}};
  for (const Joint& joint : mechanism.joints) {
    PlainJoint copy;
    copy.kind = to_string(joint.type);
    copy.first = joint.bodies[0];
    copy.second = joint.bodies[1];
    copy.at = scaled(joint.at);
    copy.axis = plain(joint.axes[0]);
    copy.other =
        plain(joint.type == JointType::planar ? elementary_motions(joint)[0].axis : joint.axes[1]);
    copy.pitch = joint.pitch / model.size;
    copy.driven = joint.driven;
    result.joints.push_back(copy);
  }
  return result;
}

/// Everything between quotes after `key: ` in one of our YAML files.
std::vector<std::string> yaml_strings(const std::string& yaml, const std::string& key) {
  const std::size_t start = yaml.find(key + ": ");
  const std::string line = yaml.substr(start, yaml.find('\n', start) - start);
  const std::regex string("'([^']*)'");
  std::vector<std::string> strings;
  for (std::sregex_iterator it(line.begin(), line.end(), string), end; it != end; ++it)
    strings.push_back((*it)[1]);
  return strings;
}

/// The loops of a URDF with its YAML, as rows over the velocities of the tree that MuJoCo
/// makes of it.
class UrdfLoops {
 public:
  explicit UrdfLoops(const UrdfFiles& files)
      : mujoco_(with_links_kept(files.urdf)), columns_(mujoco_.velocities()) {
    const std::vector<std::string> frames = yaml_strings(files.loops, "closed_loop");
    const std::vector<std::string> types = yaml_strings(files.loops, "type");
    EXPECT_EQ(frames.size(), 2 * types.size());
    for (std::size_t i = 0; i < types.size(); ++i)
      close(frames[2 * i], frames[2 * i + 1], types[i] == "6d");
    follow(files.urdf);
    system_.rows = static_cast<int>(system_.residual.size());
    system_.columns = columns_;
    for (int c = 0; c < columns_; ++c) system_.column_is_length.push_back(mujoco_.is_slide(c));
    system_.column_is_driven.assign(columns_, false);
    for (const std::string& drive : yaml_strings(files.loops, "name_mot"))
      system_.column_is_driven[mujoco_.velocity_index(drive)] = true;
  }

  ConstraintSystem system(const std::string& platform) {
    system_.platform = mujoco_.body_jacobian(platform);
    return system_;
  }

 private:
  /// By default MuJoCo melts links without a joint into their parents.
  static std::string with_links_kept(std::string urdf) {
    return urdf.insert(urdf.find('>', urdf.find("<robot")) + 1,
                       "<mujoco><compiler fusestatic=\"false\"/></mujoco>");
  }

  void add_row(bool length, double residual, const std::vector<double>& row) {
    system_.row_is_length.push_back(length);
    system_.residual.push_back(residual);
    system_.jacobian.insert(system_.jacobian.end(), row.begin(), row.end());
  }

  void close(const std::string& a, const std::string& b, bool rigid) {
    const auto ja = mujoco_.body_jacobian(a), jb = mujoco_.body_jacobian(b);
    const auto pa = mujoco_.body_pose(a), pb = mujoco_.body_pose(b);
    for (int r = rigid ? 0 : 3; r < 6; ++r) {
      std::vector<double> row(columns_);
      for (int c = 0; c < columns_; ++c) row[c] = ja[r * columns_ + c] - jb[r * columns_ + c];
      add_row(r >= 3, r >= 3 ? pa[r - 3] - pb[r - 3] : pa[4 + r] - pb[4 + r], row);
    }
  }

  /// MuJoCo does not know `mimic`.
  void follow(const std::string& urdf) {
    const std::regex joint(
        "<joint name=\"([^\"]*)\"|<mimic joint=\"([^\"]*)\" multiplier=\"([^\"]*)\"");
    std::string name;
    for (std::sregex_iterator it(urdf.begin(), urdf.end(), joint), end; it != end; ++it) {
      if ((*it)[1].matched) {
        name = (*it)[1];
        continue;
      }
      std::vector<double> row(columns_, 0.0);
      row[mujoco_.velocity_index(name)] = 1;
      row[mujoco_.velocity_index((*it)[2])] = -std::stod((*it)[3]);
      add_row(true, 0, row);
    }
  }

  MujocoModel mujoco_;
  int columns_;
  ConstraintSystem system_;
};

/// Repeatable numbers in [-1, 1).
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : state_(seed) {}
  double operator()() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
  }
  int below(int bound) { return static_cast<int>((*this)() * bound / 2 + bound / 2.0); }
  Vector3 vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

/// Some steps along the constraint manifold. False when the mechanism has not moved: a
/// step along an infinitesimal freedom falls back to home.
bool walk(const Model& model, Posture& posture) {
  const std::vector<int> active = all_freedoms(model);
  Uniform uniform(7);
  Eigen::VectorXd direction(static_cast<Eigen::Index>(active.size()));
  for (double& entry : direction) entry = uniform();
  for (int step = 0; step < 4; ++step) {
    const Eigen::VectorXd along = tangent(model, posture, active, direction);
    if (along.isZero() || !step_along(model, posture, active, along, 0.1)) break;
  }
  return displacement(model, home(model), posture) > 0.01;
}

/// Sets MuJoCo's joints as ours stand; loops closed by `connect` have no coordinates.
void pose(MujocoModel& mujoco, const Model& model, const Posture& posture) {
  for (const EngineLink& link : engine_tree(model.mechanism).links) {
    if (link.joint < 0) continue;
    const Joint& joint = model.mechanism.joints[link.joint];
    const int first = model.first_freedom[link.joint];
    if (joint.type == JointType::spherical) {
      Eigen::Quaterniond turn = posture.balls[link.joint];
      if (link.body == joint.bodies[0]) turn = turn.conjugate();
      mujoco.set(joint.name, {turn.w(), turn.x(), turn.y(), turn.z()});
      continue;
    }
    for (const EngineMotion& motion : link.motions) {
      const double q = posture.q[first + motion.freedom];
      mujoco.set(freedom_name(joint, motion.freedom), {q});
      if (motion.motion.pitch != 0) mujoco.set(joint.name + ".advance", {q * motion.motion.pitch});
    }
  }
}

Counts mujoco_counts(const Model& model) {
  MujocoModel mujoco(to_mjcf(model.mechanism));
  const ConstraintSystem system = mujoco.constraints();
  EXPECT_EQ(system.rows, mujoco.expected_rows()) << "an equality is not active";
  return counts_of(system, model.size);
}

Counts urdf_counts(const Model& model) {
  const Mechanism& mechanism = model.mechanism;
  return counts_of(UrdfLoops(to_urdf(mechanism)).system(mechanism.bodies[mechanism.platform]),
                   model.size);
}

Counts simbody_counts(const Model& model) { return counts_of(simbody_at_home(plain(model)), 1); }

void expect_closed_and_equal(const Counts& found, const Counts& ours) {
  EXPECT_LT(found.residual, 1e-9);
  EXPECT_EQ(found, ours);
}

/// Counts at a posture away from home, by ranks there: ours and MuJoCo's.
void expect_agreement_at(const Model& model, const Posture& posture, Counts& found) {
  MujocoModel mujoco(to_mjcf(model.mechanism));
  pose(mujoco, model, posture);
  found = counts_of(mujoco.constraints(), model.size);
  EXPECT_LT(found.residual, 1e-9);
  const Eigen::MatrixXd jacobian = closure_jacobian(model, posture);
  EXPECT_EQ(found.mobility, kernel_of(jacobian).basis.cols());
  EXPECT_EQ(found.held_mobility,
            kernel_of(columns(jacobian, passive_freedoms(model))).basis.cols());
}

/// Where a count at one posture is not that of the report, and why.
const std::map<std::string, std::string> kExplained{
    {"table1-4",
     "With its drives held it is almost singular wherever its carriages are nearly level: after "
     "this walk the smallest singular value is 9e-8 of the largest, below what the rule here "
     "keeps; the report decides by the largest gap over several walks."}};

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
  Counts found;
  expect_agreement_at(model_, posture, found);
  // From a singular home other branches start, too; one walk follows only one.
  if (report.home != report.finite || kExplained.count(GetParam())) return;
  EXPECT_EQ(found.mobility, report.finite);
  EXPECT_EQ(found.held_mobility, report.locked_mobility);
  EXPECT_EQ(found.platform, report.platform_dof);
  EXPECT_EQ(found.held_platform, report.locked_platform);
}

INSTANTIATE_TEST_SUITE_P(All, Engines, testing::ValuesIn(all_machines()), test_name);

Joint random_joint(Uniform& uniform, int number, int first, int second) {
  Joint joint;
  joint.name = "joint" + std::to_string(number);
  joint.type = *joint_type(joint_words()[uniform.below(8)]);
  joint.bodies = {first, second};
  if (uniform() < 0) std::swap(joint.bodies[0], joint.bodies[1]);
  joint.at = uniform.vector();
  joint.axes = {uniform.vector().normalized(), uniform.vector().normalized()};
  if (joint.type == JointType::helical) joint.pitch = 0.3;
  const int count = freedoms(joint.type);
  if (count > 0 && uniform() < -0.3) joint.driven = {uniform.below(count)};
  return joint;
}

/// Two random loops through one body, of joints of every kind, pointing either way.
Mechanism random_mechanism(std::uint64_t seed) {
  Uniform uniform(seed);
  for (int i = 0; i < 10; ++i) uniform();
  Mechanism mechanism;
  mechanism.name = "random";
  mechanism.tool = uniform.vector();
  const auto chain = [&](int from, int to, int links) {
    for (int i = 0; i <= links; ++i) {
      int next = to;
      if (i < links) {
        next = static_cast<int>(mechanism.bodies.size());
        mechanism.bodies.push_back("body" + std::to_string(next));
      }
      mechanism.joints.push_back(
          random_joint(uniform, static_cast<int>(mechanism.joints.size()) + 1, from, next));
      from = next;
    }
  };
  mechanism.bodies = {"base", "platform"};
  mechanism.platform = 1;
  for (int limb = 0; limb < 3; ++limb) chain(0, 1, 2 + uniform.below(3));
  return mechanism;
}

TEST(JointKinds, AnyMixtureOfThemEitherWayRoundAgrees) {
  std::map<JointType, int> closing;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    const Model model = compile(random_mechanism(seed));
    for (int joint : model.loop_joints) ++closing[model.mechanism.joints[joint].type];
    const Counts ours = counts_of(model);
    expect_closed_and_equal(mujoco_counts(model), ours);
    expect_closed_and_equal(simbody_counts(model), ours);
    expect_closed_and_equal(urdf_counts(model), ours);
    Posture posture = home(model);
    Counts found;
    if (walk(model, posture)) expect_agreement_at(model, posture, found);
  }
  EXPECT_GE(closing.size(), 5u) << "few kinds of joints have closed a loop";
}

TEST(JointKinds, EachClosesALoop) {
  for (const std::string& word : joint_words()) {
    SCOPED_TRACE(word);
    Mechanism mechanism = random_mechanism(3);
    // All drives and one-freedom joints but one, which therefore closes the only loop.
    mechanism.joints.clear();
    mechanism.bodies = {"base", "a", "platform", "b"};
    mechanism.platform = 2;
    Uniform uniform(11);
    for (int i = 0; i < 4; ++i) {
      Joint joint = random_joint(uniform, i + 1, i, (i + 1) % 4);
      joint.type = i == 2 ? *joint_type(word) : JointType::cylindrical;
      joint.driven.clear();
      if (i != 2) joint.driven = {0};
      joint.pitch = 0.2;
      mechanism.joints.push_back(joint);
    }
    const Model model = compile(mechanism);
    ASSERT_EQ(model.loop_joints, std::vector<int>{2});
    const Counts ours = counts_of(model);
    EXPECT_EQ(ours.mobility, std::max(0, freedoms(*joint_type(word))));
    expect_closed_and_equal(mujoco_counts(model), ours);
    expect_closed_and_equal(simbody_counts(model), ours);
    expect_closed_and_equal(urdf_counts(model), ours);
  }
}

// The oracles are not blind: what is open is seen, and so is a constraint that no longer repeats
// another.
TEST(Oracles, AMicroradianOfOneJointOpensALoop) {
  const Model model = compile(expand(find_layout("four-bar")));
  MujocoModel mujoco(to_mjcf(model.mechanism));
  mujoco.set("a", {1e-6});
  const double residual = counts_of(mujoco.constraints(), model.size).residual;
  EXPECT_GT(residual, 1e-7);
  EXPECT_LT(residual, 1e-5);
}

TEST(Oracles, AThousandthOfARadianCostsBennettHisFreedom) {
  Mechanism mechanism = expand(find_layout("bennett"));
  EXPECT_EQ(mujoco_counts(compile(mechanism)).mobility, 1);
  Vector3& axis = mechanism.joints[0].axes[0];
  axis = (axis + 1e-3 * axis.unitOrthogonal()).normalized();
  const Model model = compile(mechanism);
  EXPECT_EQ(mujoco_counts(model).mobility, 0);
  EXPECT_EQ(simbody_counts(model).mobility, 0);
  EXPECT_EQ(urdf_counts(model).mobility, 0);
}

TEST(Exports, CountTheSameInAnySize) {
  for (const double factor : {1e-3, 1e3}) {
    SCOPED_TRACE(factor);
    Mechanism mechanism = expand(find_layout("table1-6"));
    mechanism.tool *= factor;
    for (Joint& joint : mechanism.joints) {
      joint.at *= factor;
      joint.range.clear();
    }
    const Model model = compile(mechanism);
    const Counts ours = counts_of(model);
    expect_closed_and_equal(mujoco_counts(model), ours);
    expect_closed_and_equal(urdf_counts(model), ours);
  }
}

TEST(Exports, LoadWhateverBodiesAndJointsAreCalled) {
  Mechanism mechanism = expand(find_layout("four-bar"));
  mechanism.name = "<\"four\" & 'bar'>";
  mechanism.title = "a -- b -->";
  mechanism.bodies = {"world", "a <&> \"b\"\n", "tool", "d.cut"};
  const Model model = compile(mechanism);
  expect_closed_and_equal(mujoco_counts(model), counts_of(model));
  EXPECT_EQ(MujocoModel(to_urdf(mechanism).urdf).velocities(), 4);
}

}  // namespace
}  // namespace polyglide::engines
