// Proved bounds of a workspace volume, from a prepared machine to upper - lower within a tolerance.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <stdexcept>

#include "catalog/catalog.hpp"
#include "kinematics/certified_volume.hpp"

namespace polyglide {
namespace {

void prove(benchmark::State& state, const std::string& name, double tolerance) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Evaluator evaluator(prepare(expand(find_layout(name))));
  const Eigen::Quaterniond home = Eigen::Quaterniond::Identity();
  const Bounds box = search_bounds(Probe(evaluator, home));
  for (auto _ : state) {
    const auto proved = certify_volume(evaluator.machine(), {}, home, box, {}, tolerance);
    if (!proved || !proved->reached) throw std::logic_error("volume_bench: nothing proved");
    state.counters["cells"] = proved->cells;
  }
  state.SetItemsProcessed(state.iterations());
}

}  // namespace
}  // namespace polyglide

int main(int count, char** words) {
  using namespace polyglide;
  benchmark::RegisterBenchmark("volume of delta-1, proved to 0.1 %/polyglide", prove, "delta-1",
                               1e-3)
      ->Unit(benchmark::kMillisecond);
  benchmark::Initialize(&count, words);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
