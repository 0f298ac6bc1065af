// Full checks of candidates (home, branches, a generic posture, drives held, verdict), beside what
// numpy needs for the four ranks alone. Argument: a folder for the matrices numpy is given.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <random>

#include "catalog/catalog.hpp"
#include "kinematics/branches.hpp"
#include "kinematics/manifold.hpp"
#include "kinematics/mobility.hpp"

namespace polyglide {
namespace {

/// A platform on eleven driven struts: ten loops, sixty rows.
Mechanism eleven_struts() {
  Mechanism mechanism;
  mechanism.name = "11-ups";
  mechanism.bodies = {"base", "platform"};
  mechanism.platform = 1;
  for (int i = 0; i < 11; ++i) {
    const double angle = 2 * M_PI * i / 11;
    const Vector3 foot(std::cos(angle), std::sin(angle), 0);
    const Vector3 head(0.4 * std::cos(angle + 0.5 * (i % 3)), 0.4 * std::sin(angle + 0.5 * (i % 3)),
                       1 + 0.05 * (i % 4));
    const int lower = static_cast<int>(mechanism.bodies.size());
    mechanism.bodies.push_back("lower" + std::to_string(i));
    mechanism.bodies.push_back("upper" + std::to_string(i));
    const Vector3 along = (head - foot).normalized();
    Joint below, strut, above;
    below.name = "below" + std::to_string(i);
    below.type = JointType::universal;
    below.bodies = {0, lower};
    below.at = foot;
    below.axes = {along.unitOrthogonal(), along.cross(along.unitOrthogonal())};
    strut.name = "strut" + std::to_string(i);
    strut.type = JointType::prismatic;
    strut.bodies = {lower, lower + 1};
    strut.at = foot;
    strut.axes[0] = along;
    strut.driven = {0};
    above.name = "above" + std::to_string(i);
    above.type = JointType::spherical;
    above.bodies = {lower + 1, 1};
    above.at = head;
    mechanism.joints.insert(mechanism.joints.end(), {below, strut, above});
  }
  return mechanism;
}

void write_matrix(std::ofstream& file, const Eigen::MatrixXd& matrix) {
  file << matrix.rows() << ' ' << matrix.cols();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r)
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) file << ' ' << matrix(r, c);
  file << '\n';
}

/// The four matrices whose ranks the decision needs: home and generic, free and held.
void write_matrices(const std::string& folder, const std::string& name, const Model& model) {
  std::ofstream file(folder + "/mobility-" + name + ".txt");
  file.precision(17);
  std::mt19937_64 random(1);
  const Posture start = home(model);
  const Departure departure =
      leave(model, start, freedoms_at(model, start).kernel, false, {1, 1, 0.25}, random);
  const Posture& far =
      departure.branches.empty() ? start : departure.branches.front().far.front().posture;
  for (const Posture* posture : {&start, &far}) {
    const Eigen::MatrixXd jacobian = closure_jacobian(model, *posture);
    write_matrix(file, jacobian);
    write_matrix(file, columns(jacobian, passive_freedoms(model)));
  }
}

void check(benchmark::State& state, const Mechanism& mechanism) {
  for (auto _ : state)
    benchmark::DoNotOptimize(analyse_mobility(compile(mechanism), screening_options(1)));
  state.SetItemsProcessed(state.iterations());
}

}  // namespace
}  // namespace polyglide

int main(int count, char** words) {
  using namespace polyglide;
  if (count < 2) return 1;
  const std::string folder = words[1];
  std::vector<Mechanism> machines;
  for (int i = 1; i <= 6; ++i)
    machines.push_back(expand(find_layout("table1-" + std::to_string(i))));
  machines.push_back(eleven_struts());
  for (const Mechanism& mechanism : machines) {
    write_matrices(folder, mechanism.name, compile(mechanism));
    benchmark::RegisterBenchmark(("check " + mechanism.name + "/polyglide").c_str(),
                                 [mechanism](benchmark::State& state) { check(state, mechanism); });
  }
  benchmark::Initialize(&count, words);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
