// Full checks of candidates (home, branches, a generic posture, drives held, verdict), beside what
// numpy needs for the four ranks alone: single machines, and candidates of a space by verdict.
// Argument: a folder for the matrices numpy is given.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <map>
#include <random>

#include "catalog/catalog.hpp"
#include "kinematics/branches.hpp"
#include "kinematics/manifold.hpp"
#include "kinematics/mobility.hpp"
#include "synthesis/enumerate.hpp"

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
void write_matrices(std::ofstream& file, const Model& model) {
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

using Group = std::vector<Mechanism>;

void check(benchmark::State& state, const Group& group) {
  for (auto _ : state)
    for (const Mechanism& mechanism : group)
      benchmark::DoNotOptimize(analyse_mobility(compile(mechanism), screening_options(1)));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(group.size()));
}

void add_rows(const std::string& folder, const std::string& name, const Group& group) {
  std::ofstream file(folder + "/mobility-" + name + ".txt");
  file.precision(17);
  for (const Mechanism& mechanism : group) write_matrices(file, compile(mechanism));
  benchmark::RegisterBenchmark(("check " + name + "/polyglide").c_str(),
                               [group](benchmark::State& state) { check(state, group); });
}

/// Of a space, candidates with at most 18 closure equations by their verdict, from all over it.
std::map<Verdict, Group> candidates(const std::string& file) {
  constexpr std::uint64_t kStride = 7;
  constexpr std::size_t kMost = 16, kLoops = 3;
  const Space space = load_space(file);
  std::map<Verdict, Group> groups;
  for (std::uint64_t index = 0; index < raw_count(space); index += kStride) {
    const Mechanism mechanism = expand(candidate_layout(space, index, std::to_string(index)));
    const Model model = compile(mechanism);
    if (model.loops.size() > kLoops) continue;
    Group& group = groups[analyse_mobility(model, screening_options(1)).verdict];
    if (group.size() < kMost) group.push_back(mechanism);
  }
  return groups;
}

}  // namespace
}  // namespace polyglide

int main(int count, char** words) {
  using namespace polyglide;
  if (count < 2) return 1;
  const std::string folder = words[1];
  for (int i = 1; i <= 6; ++i) {
    const std::string name = "table1-" + std::to_string(i);
    add_rows(folder, name, {expand(find_layout(name))});
  }
  add_rows(folder, "11-ups", {eleven_struts()});
  for (const auto& [verdict, group] : candidates("examples/spaces/table1.json"))
    add_rows(folder, std::string(to_string(verdict)) + " candidates", group);
  benchmark::Initialize(&count, words);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
