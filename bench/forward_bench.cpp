// Forward kinematics of the hexapod by Newton's method from home: the batch, and the same
// in plain Eigen, one pose after the other.
#include <tbb/global_control.h>

#include "bench/machines.hpp"

namespace polyglide::bench {
namespace {

std::vector<double> drives_of_poses() {
  PoseBatch poses = random_poses(kPoses, 0.05, 0.05, 0.15);
  poses.wanted = Wanted::drives;
  BatchResult result;
  Evaluator(hexapod(), kIgnored).evaluate(poses, result);
  return result.drives;
}

void run_batch(benchmark::State& state, const std::string& instructions) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Evaluator evaluator(hexapod(), kIgnored);
  const DriveBatch drives{kPoses, drives_of_poses(), {}, instructions};
  ForwardResult result;
  for (auto _ : state) evaluator.forward(drives, result);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPoses));
  state.counters["failed"] =
      static_cast<double>(std::count_if(result.residual.begin(), result.residual.end(),
                                        [](double residual) { return !(residual < 1e-9); }));
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

void run_eigen(benchmark::State& state) {
  const LegMachine& legs = *hexapod().legs;
  const std::vector<double> drives = drives_of_poses();
  std::vector<double> lengths(drives.size());
  for (std::size_t i = 0; i < kPoses; ++i)
    for (std::size_t d = 0; d < 6; ++d)
      lengths[6 * i + d] = legs.legs[d].length + drives[d * kPoses + i];
  std::size_t steps = 0;
  for (auto _ : state)
    for (std::size_t i = 0; i < kPoses; ++i) {
      Vector3 t = Vector3::Zero();
      Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
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
  benchmark::RegisterBenchmark("forward/eigen", run_eigen);
  for (const polyglide::batch::Kernel* kernel : polyglide::batch::available_kernels())
    benchmark::RegisterBenchmark((std::string("forward/") + kernel->name).c_str(), run_batch,
                                 std::string(kernel->name));
  benchmark::RunSpecifiedBenchmarks();
}
