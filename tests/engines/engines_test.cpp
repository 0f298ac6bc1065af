// Every machine at hand, put before two multibody engines that share no code with us:
// MuJoCo reads what `export --as mjcf` writes, Simbody is told the joint graph. They say how the
// loops' constraints depend on the velocities, and whether the loops are closed; ranks are
// taken here. Nothing is ever stepped in time: engines keep loops closed only softly.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "catalog/catalog.hpp"
#include "catalog/elementary_motion.hpp"
#include "catalog/engine_tree.hpp"
#include "catalog/json_file.hpp"
#include "catalog/write_mjcf.hpp"
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

/// The same from polyglide, at home.
Counts counts_of(const Model& model) {
  MobilityOptions options;
  options.evidence = false;
  const MobilityReport report = analyse_mobility(model, options);
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

class Engines : public testing::TestWithParam<std::string> {
 protected:
  Model model_ = compile(expand(find_layout(GetParam())));
};

TEST_P(Engines, MujocoAgreesAtHome) {
  MujocoModel mujoco(to_mjcf(model_.mechanism));
  const ConstraintSystem system = mujoco.constraints();
  EXPECT_EQ(system.rows, mujoco.expected_rows());
  const Counts counts = counts_of(system, model_.size);
  EXPECT_LT(counts.residual, 1e-9);
  EXPECT_EQ(counts, counts_of(model_));
}

TEST_P(Engines, SimbodyAgreesAtHome) {
  const Counts counts = counts_of(simbody_at_home(plain(model_)), 1);
  EXPECT_LT(counts.residual, 1e-9);
  EXPECT_EQ(counts, counts_of(model_));
}

INSTANTIATE_TEST_SUITE_P(All, Engines, testing::ValuesIn(all_machines()), test_name);

}  // namespace
}  // namespace polyglide::engines
