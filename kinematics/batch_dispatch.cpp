#include <stdexcept>

#include "kinematics/batch_kernels.hpp"

namespace polyglide::batch {
namespace {

std::vector<const Kernel*> find_kernels() {
  std::vector<const Kernel*> kernels{&scalar_kernel()};
#if defined(__x86_64__)
  kernels.push_back(&x86_64_kernel());
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (v3) kernels.push_back(&v3_kernel());
  if (v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512cd"))
    kernels.push_back(&v4_kernel());
#endif
  return kernels;
}

}  // namespace

const std::vector<const Kernel*>& available_kernels() {
  static const std::vector<const Kernel*> kernels = find_kernels();
  return kernels;
}

const Kernel& kernel_named(const std::string& name) {
  if (name.empty()) return *available_kernels().back();
  std::string words;
  for (const Kernel* kernel : available_kernels()) {
    if (kernel->name == name) return *kernel;
    words += words.empty() ? kernel->name : std::string(", ") + kernel->name;
  }
  throw std::invalid_argument("kernel_named: this processor runs " + words + ", not \"" + name +
                              '"');
}

}  // namespace polyglide::batch
