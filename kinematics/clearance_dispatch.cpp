#include "kinematics/batch_kernels.hpp"
#include "kinematics/clearance_kernels.hpp"

namespace polyglide::clearance {

const Kernel& kernel_named(const std::string& name) {
  const std::string chosen = batch::kernel_named(name).name;
#if defined(__x86_64__)
  if (chosen == "x86_64") return x86_64_kernel();
  if (chosen == "v3") return v3_kernel();
  if (chosen == "v4") return v4_kernel();
#endif
  return scalar_kernel();
}

}  // namespace polyglide::clearance
