#pragma once

#include <benchmark/benchmark.h>

#include "bench/common.hpp"
#include "kinematics/batch_kernel.hpp"
#include "kinematics/batch_model.hpp"

// The two machines timed, their poses, and how many operations a pose takes.
namespace polyglide::bench {

inline Counted sqrt(Counted a) { return Counted::made(std::sqrt(a.value)); }
inline Counted abs(Counted a) { return Counted(std::fabs(a.value)); }
inline Counted nearbyint(Counted a) { return Counted::made(std::nearbyint(a.value)); }
inline Counted atan2(Counted y, Counted x) { return Counted::made(std::atan2(y.value, x.value)); }
inline Counted min(Counted a, Counted b) { return a < b ? a : b; }
inline Counted max(Counted a, Counted b) { return a > b ? a : b; }
inline Counted select(bool chosen, Counted a, Counted b) { return chosen ? a : b; }

inline const Machine& delta() {
  static const Machine machine = prepare(expand(find_layout("delta-1")));
  return machine;
}
inline const Machine& hexapod() {
  static const Machine machine = prepare(expand(find_layout("hexapod-6ups")));
  return machine;
}

inline const Machine& four_axes() {
  static const Machine machine = prepare(expand(find_layout("table1-6")));
  return machine;
}

/// Peers check strokes only, so cones and half-spaces do not count here either.
inline const std::vector<std::string> kIgnored{"cone", "triangle", "table"};
constexpr std::size_t kPoses = 20000;

inline const PoseBatch& delta_poses() {
  static const PoseBatch poses = random_poses(kPoses, 0.05, 0.05, 0);
  return poses;
}
inline const PoseBatch& hexapod_poses() {
  static const PoseBatch poses = random_poses(kPoses, 0.1, 0.1, 0.25);
  return poses;
}

inline const PoseBatch& four_axes_poses() {
  static const PoseBatch poses = [] {
    PoseBatch found = random_poses(kPoses, 0.05, 0.05, 0.25);
    for (int axis = 0; axis < 3; ++axis)
      if (std::count(four_axes().task.axes.begin(), four_axes().task.axes.end(), 3 + axis) == 0)
        found.angles[axis].clear();
    return found;
  }();
  return poses;
}

inline void run_peak(benchmark::State& state, double (*peak)(std::size_t, int*)) {
  constexpr std::size_t kRounds = 20000;
  int lanes = 0;
  for (auto _ : state) benchmark::DoNotOptimize(peak(kRounds, &lanes));
  state.SetItemsProcessed(state.iterations() * kRounds);
  state.counters["flops"] = 2 * lanes;
}

inline void add_peaks() {
  for (const batch::Kernel* kernel : batch::available_kernels()) {
    const std::string name = kernel->name;
    if (name == "v3") benchmark::RegisterBenchmark("peak/v3", run_peak, peak_v3);
    if (name == "v4") benchmark::RegisterBenchmark("peak/v4", run_peak, peak_v4);
  }
}

}  // namespace polyglide::bench

template <>
struct polyglide::simd::Lanes<polyglide::bench::Counted> {
  static constexpr int count = 1;
  static bench::Counted load(const double* from) { return bench::Counted(*from); }
  static void store(double* to, bench::Counted value) { *to = value.value; }
  static void store_whole(int* to, bench::Counted value) { *to = static_cast<int>(value.value); }
  static void store_signs(signed char* to, bench::Counted value) { *to = value.value > 0; }
};
