// Most fused multiply-adds a core can do with one instruction set: twelve independent
// chains in registers. Compiled once per set, with its flags.
#include <immintrin.h>

#include <cstddef>

namespace polyglide::bench {

/// Runs `rounds` rounds; each is two operations on each of `*lanes` numbers.
double POLYGLIDE_PEAK(std::size_t rounds, int* lanes) {
#if defined(__AVX512F__)
  using V = __m512d;
#else
  using V = __m256d;
#endif
  V a{}, b{}, x0{}, x1{}, x2{}, x3{}, x4{}, x5{}, x6{}, x7{}, x8{}, x9{}, x10{}, x11{};
  // Written out, so that the compiler can neither spill the chains nor join them.
  for (std::size_t i = 0; i < rounds; ++i)
    asm volatile(
        "vfmadd231pd %12, %13, %0\n\tvfmadd231pd %12, %13, %1\n\t"
        "vfmadd231pd %12, %13, %2\n\tvfmadd231pd %12, %13, %3\n\t"
        "vfmadd231pd %12, %13, %4\n\tvfmadd231pd %12, %13, %5\n\t"
        "vfmadd231pd %12, %13, %6\n\tvfmadd231pd %12, %13, %7\n\t"
        "vfmadd231pd %12, %13, %8\n\tvfmadd231pd %12, %13, %9\n\t"
        "vfmadd231pd %12, %13, %10\n\tvfmadd231pd %12, %13, %11\n\t"
        : "+v"(x0), "+v"(x1), "+v"(x2), "+v"(x3), "+v"(x4), "+v"(x5), "+v"(x6), "+v"(x7), "+v"(x8),
          "+v"(x9), "+v"(x10), "+v"(x11)
        : "v"(a), "v"(b));
  const V sum = x0 + x1 + x2 + x3 + x4 + x5 + x6 + x7 + x8 + x9 + x10 + x11;
  *lanes = static_cast<int>(sizeof(V) / sizeof(double)) * 12;
  return sum[0];
}

}  // namespace polyglide::bench
