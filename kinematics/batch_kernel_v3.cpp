#include "kinematics/batch_kernel.hpp"

#if defined(__x86_64__)
namespace polyglide::batch {

const Kernel& v3_kernel() {
  using V = xsimd::batch<double, xsimd::fma3<xsimd::avx2>>;
  static const Kernel kernel{"v3", simd::Lanes<simd::WideOf<V>>::count, simd::Lanes<V>::count,
                             &evaluate<V>, &forward<V>};
  return kernel;
}

}  // namespace polyglide::batch
#endif
