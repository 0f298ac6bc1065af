#include "kinematics/clearance_kernel.hpp"

#if defined(__x86_64__)
namespace polyglide::clearance {

const Kernel& x86_64_kernel() {
  using V = xsimd::batch<double, xsimd::sse2>;
  static const Kernel kernel{"x86_64", simd::Lanes<V>::count, &check<V>};
  return kernel;
}

}  // namespace polyglide::clearance
#endif
