#include "kinematics/clearance_kernel.hpp"

#if defined(__x86_64__)
namespace polyglide::clearance {

const Kernel& v3_kernel() {
  using V = xsimd::batch<double, xsimd::fma3<xsimd::avx2>>;
  static const Kernel kernel{"v3", simd::Lanes<V>::count, &check<V>};
  return kernel;
}

}  // namespace polyglide::clearance
#endif
