#include "kinematics/batch_kernel.hpp"

#if defined(__x86_64__)
namespace polyglide::batch {

const Kernel& x86_64_kernel() {
  using V = xsimd::batch<double, xsimd::sse2>;
  static const Kernel kernel{"x86_64", simd::Lanes<simd::WideOf<V>>::count, simd::Lanes<V>::count,
                             &evaluate<V>, &forward<V>};
  return kernel;
}

}  // namespace polyglide::batch
#endif
