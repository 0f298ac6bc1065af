// Forward kinematics of the hexapod by Newton's method, cold (from home) and warm (from a pose
// some millimetres and half a degree away, as along a path): the batch, the same in plain
// Eigen, one pose after the other, and one pose per call.
#include <tbb/global_control.h>

#include "bench/machines.hpp"

namespace polyglide::bench {
namespace {

/// Drives of random poses; warm: with starts nearby.
DriveBatch drives_of_poses(bool warm) {
  PoseBatch poses = random_poses(kPoses, 0.05, 0.05, 0.15);
  poses.wanted = Wanted::drives;
  BatchResult result;
  Evaluator(hexapod(), kIgnored).evaluate(poses, result);
  DriveBatch drives{kPoses, result.drives, {}, {}};
  if (!warm) return drives;
  const double step = 0.003, turn = 0.01;
  for (std::size_t i = 0; i < kPoses; ++i) {
    const Pose near =
        pose_of({poses.x[i] + step, poses.y[i] - step, poses.z[i] + step, poses.angles[0][i] - turn,
                 poses.angles[1][i] + turn, poses.angles[2][i] - turn});
    for (int k = 0; k < 3; ++k) drives.start[k].push_back(near.position[k]);
    const Eigen::Quaterniond& q = near.rotation;
    const double parts[]{q.w(), q.x(), q.y(), q.z()};
    for (int k = 0; k < 4; ++k) drives.start[3 + k].push_back(parts[k]);
  }
  return drives;
}

double failures(const ForwardResult& result) {
  return static_cast<double>(std::count_if(result.residual.begin(), result.residual.end(),
                                           [](double residual) { return !(residual < 1e-9); }));
}

void run_batch(benchmark::State& state, bool warm, const std::string& instructions) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Evaluator evaluator(hexapod(), kIgnored);
  DriveBatch drives = drives_of_poses(warm);
  drives.instructions = instructions;
  ForwardResult result;
  for (auto _ : state) evaluator.forward(drives, result);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPoses));
  state.counters["failed"] = failures(result);
}

/// A call for every pose, as a controller makes it.
void run_single(benchmark::State& state) {
  constexpr std::size_t kCalls = 1000;
  const Evaluator evaluator(hexapod(), kIgnored);
  const DriveBatch all = drives_of_poses(true);
  std::vector<DriveBatch> calls(kCalls);
  for (std::size_t i = 0; i < kCalls; ++i) {
    calls[i].size = 1;
    for (std::size_t d = 0; d < 6; ++d) calls[i].drives.push_back(all.drives[d * kPoses + i]);
    for (std::size_t k = 0; k < 7; ++k) calls[i].start[k] = {all.start[k][i]};
  }
  ForwardResult result;
  double failed = 0;
  for (auto _ : state)
    for (const DriveBatch& call : calls) {
      evaluator.forward(call, result);
      failed += failures(result);
    }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCalls));
  state.counters["failed"] = failed;
}

/// Newton's method on squared leg lengths, partially pivoted LU, until steps are below 1e-12.
int solve_one(const LegMachine& legs, const Vector3& tool, const double* lengths, Vector3& t,
              Eigen::Matrix3d& r) {
  Eigen::Matrix<double, 6, 6> j;
  Eigen::Matrix<double, 6, 1> f;
  for (int step = 1; step <= 20; ++step) {
    for (int i = 0; i < 6; ++i) {
      const Leg& leg = legs.legs[i];
      const Vector3 arm = r * (leg.platform_point - tool);
      const Vector3 v = tool + t + arm - leg.base_point;
      f[i] = 0.5 * (v.squaredNorm() - lengths[i] * lengths[i]);
      j.row(i) << v.transpose(), arm.cross(v).transpose();
    }
    const Eigen::Matrix<double, 6, 1> move = j.partialPivLu().solve(-f);
    t += move.head<3>();
    const double angle = move.tail<3>().norm();
    if (angle > 0) r = Eigen::AngleAxisd(angle, move.tail<3>() / angle).toRotationMatrix() * r;
    if (move.cwiseAbs().maxCoeff() < 1e-10) return step;
  }
  return 20;
}

void run_eigen(benchmark::State& state, bool warm) {
  const LegMachine& legs = *hexapod().legs;
  const DriveBatch batch = drives_of_poses(warm);
  std::vector<double> lengths(batch.drives.size());
  std::vector<Pose> starts(kPoses);
  for (std::size_t i = 0; i < kPoses; ++i) {
    for (std::size_t d = 0; d < 6; ++d)
      lengths[6 * i + d] = legs.legs[d].length + batch.drives[d * kPoses + i];
    const auto& s = batch.start;
    if (warm)
      starts[i] = {Vector3(s[0][i], s[1][i], s[2][i]),
                   Eigen::Quaterniond(s[3][i], s[4][i], s[5][i], s[6][i])};
  }
  std::size_t steps = 0;
  for (auto _ : state)
    for (std::size_t i = 0; i < kPoses; ++i) {
      Vector3 t = starts[i].position;
      Eigen::Matrix3d r = starts[i].rotation.toRotationMatrix();
      steps += static_cast<std::size_t>(
          solve_one(legs, hexapod().model.mechanism.tool, &lengths[6 * i], t, r));
      benchmark::DoNotOptimize(t);
    }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPoses));
  state.counters["steps"] =
      static_cast<double>(steps) / (static_cast<double>(state.iterations()) * kPoses);
}

}  // namespace
}  // namespace polyglide::bench

int main(int argc, char** argv) {
  using namespace polyglide::bench;
  benchmark::Initialize(&argc, argv);
  for (const bool warm : {false, true}) {
    const std::string work = warm ? "forward warm/" : "forward/";
    benchmark::RegisterBenchmark((work + "eigen").c_str(), run_eigen, warm);
    for (const polyglide::batch::Kernel* kernel : polyglide::batch::available_kernels())
      benchmark::RegisterBenchmark((work + kernel->name).c_str(), run_batch, warm,
                                   std::string(kernel->name));
  }
  benchmark::RegisterBenchmark("forward warm/one pose per call", run_single);
  benchmark::RunSpecifiedBenchmarks();
}
