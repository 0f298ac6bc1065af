#include "kinematics/clearance_kernel.hpp"

#if defined(__x86_64__)
namespace polyglide::clearance {

const Kernel& v4_kernel() {
  using V = xsimd::batch<double, xsimd::avx512dq>;
  static const Kernel kernel{"v4", simd::Lanes<V>::count, &check<V>};
  return kernel;
}

}  // namespace polyglide::clearance
#endif
