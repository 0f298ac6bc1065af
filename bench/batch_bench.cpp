// Poses per second of the batch evaluator, one thread, every instruction set; the mean
// operations per pose are counted by running the same kernel on a counting number.
// Writes the poses and the machines for the peers into the folder named by its argument.
#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "bench/machines.hpp"

namespace polyglide::bench {
namespace {

struct Case {
  const char* name;
  const Machine& machine;
  const PoseBatch& poses;
  unsigned wanted;
  std::vector<std::string> ignored = kIgnored;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> list{
      {"delta/condition", delta(), delta_poses(), Wanted::drives | Wanted::condition},
      // What peers leave out: cones and the paper's triangle; and legs that are not alike.
      {"delta all limits/condition",
       delta(),
       delta_poses(),
       Wanted::drives | Wanted::condition,
       {}},
      {"table1-6/condition", four_axes(), four_axes_poses(), Wanted::drives | Wanted::condition},
      {"hexapod/jacobian", hexapod(), hexapod_poses(), Wanted::drives | Wanted::jacobian},
      {"hexapod/frobenius", hexapod(), hexapod_poses(), Wanted::drives | Wanted::frobenius},
      {"hexapod/condition", hexapod(), hexapod_poses(), Wanted::drives | Wanted::condition}};
  return list;
}

/// Mean operations per pose.
double count_operations(const Case& item) {
  constexpr int kCount = 200;
  const BatchModel model(Evaluator(item.machine, item.ignored).machine(), item.ignored);
  const PoseBatch& poses = item.poses;
  batch::KernelInput in{poses.x.data(), poses.y.data(), poses.z.data(), {}, {}};
  for (int k = 0; k < 3; ++k)
    in.angle[k] = poses.angles[k].empty() ? nullptr : poses.angles[k].data();
  std::vector<int> limit(kCount);
  std::vector<double> index(kCount);
  batch::KernelOutput out;
  out.limit = limit.data();
  if (item.wanted & Wanted::condition) out.condition = index.data();
  if (item.wanted & Wanted::frobenius) out.frobenius = index.data();
  Counted::operations = 0;
  batch::evaluate<Counted>(
      in.turning() ? model.turning() : model.turned(Eigen::Quaterniond::Identity()), in, out,
      kCount);
  return static_cast<double>(Counted::operations) / kCount;
}

void run(benchmark::State& state, const Case& item, const std::string& instructions,
         double operations) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Evaluator evaluator(item.machine, item.ignored);
  PoseBatch poses = item.poses;
  poses.wanted = item.wanted;
  poses.instructions = instructions;
  BatchResult result;
  for (auto _ : state) evaluator.evaluate(poses, result);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(poses.size()));
  state.counters["flops"] = operations;
  double sum = 0;
  for (double value : result.inverse_condition) sum += value;
  for (double value : result.frobenius) sum += value;
  state.counters["mean_index"] = sum / static_cast<double>(poses.size());
}

/// A machine without closed form: Newton's method on loop closure, each pose from the one before.
void run_general(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  constexpr std::size_t kCount = 160;
  const Evaluator evaluator(prepare(expand(find_layout("3-rps"))), kIgnored);
  PoseBatch poses = random_poses(kCount, 0, 0.01, 0.05);
  poses.angles[2].clear();
  poses.wanted = Wanted::drives | Wanted::condition;
  BatchResult result;
  for (auto _ : state) evaluator.evaluate(poses, result);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
  state.counters["reached"] =
      static_cast<double>(std::count(result.limit.begin(), result.limit.end(), -1));
}

nlohmann::json machine_json(const Machine& machine) {
  nlohmann::json legs = nlohmann::json::array();
  const auto list = [](const Vector3& v) { return nlohmann::json{v.x(), v.y(), v.z()}; };
  for (int index : machine.legs->primary) {
    const Leg& leg = machine.legs->legs[index];
    legs.push_back({{"base", list(leg.base_point)},
                    {"direction", list(leg.direction)},
                    {"platform", list(leg.platform_point)},
                    {"length", leg.length},
                    {"side", leg.side},
                    {"stroke", {leg.stroke.min, leg.stroke.max}}});
  }
  return {{"tool", list(machine.model.mechanism.tool)},
          {"scale", machine.task.characteristic_length},
          {"legs", legs}};
}

void write_inputs(const std::string& folder) {
  write_poses(folder + "/delta_poses.txt", delta_poses());
  write_poses(folder + "/hexapod_poses.txt", hexapod_poses());
  std::ofstream(folder + "/machines.json")
      << nlohmann::json{{"delta", machine_json(delta())}, {"hexapod", machine_json(hexapod())}};
}

}  // namespace
}  // namespace polyglide::bench

int main(int argc, char** argv) {
  using namespace polyglide::bench;
  benchmark::Initialize(&argc, argv);
  if (argc > 1) write_inputs(argv[1]);
  add_peaks();
  for (const Case& item : cases()) {
    const double operations = count_operations(item);
    for (const polyglide::batch::Kernel* kernel : polyglide::batch::available_kernels())
      benchmark::RegisterBenchmark((std::string(item.name) + '/' + kernel->name).c_str(), run, item,
                                   std::string(kernel->name), operations);
  }
  benchmark::RegisterBenchmark("3-rps/condition/general way", run_general);
  benchmark::RunSpecifiedBenchmarks();
}
