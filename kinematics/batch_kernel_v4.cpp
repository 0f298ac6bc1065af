#include "kinematics/batch_kernel.hpp"

#if defined(__x86_64__)
namespace polyglide::batch {

const Kernel& v4_kernel() {
  using V = xsimd::batch<double, xsimd::avx512dq>;
  static const Kernel kernel{"v4", simd::Lanes<simd::WideOf<V>>::count, simd::Lanes<V>::count,
                             &evaluate<V>, &forward<V>};
  return kernel;
}

}  // namespace polyglide::batch
#endif
