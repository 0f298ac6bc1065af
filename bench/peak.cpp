// Most fused multiply-adds a core can do with one instruction set: sixteen independent
// chains in registers. Compiled once per set, with its flags.
#include <immintrin.h>

#include <cstddef>

namespace polyglide::bench {

/// Runs `rounds` rounds; each is two operations on each of `*lanes` numbers.
double POLYGLIDE_PEAK(std::size_t rounds, int* lanes) {
#if defined(__AVX512F__)
  using V = __m512d;
  const V a = _mm512_set1_pd(0.999999), b = _mm512_set1_pd(1e-7);
  const auto fma = [](V x, V y, V z) { return _mm512_fmadd_pd(x, y, z); };
  const auto start = [](double value) { return _mm512_set1_pd(value); };
#else
  using V = __m256d;
  const V a = _mm256_set1_pd(0.999999), b = _mm256_set1_pd(1e-7);
  const auto fma = [](V x, V y, V z) { return _mm256_fmadd_pd(x, y, z); };
  const auto start = [](double value) { return _mm256_set1_pd(value); };
#endif
  *lanes = static_cast<int>(sizeof(V) / sizeof(double));
  constexpr int kChains = sizeof(V) == 64 ? 16 : 12;
  V x[kChains];
  for (int k = 0; k < kChains; ++k) x[k] = start(1 + 0.01 * k);
  for (std::size_t i = 0; i < rounds; ++i) {
#pragma GCC unroll 16
    for (int k = 0; k < kChains; ++k) {
      x[k] = fma(x[k], a, b);
      // The chains are alike: keep the compiler from seeing it.
      asm volatile("" : "+v"(x[k]));
    }
  }
  V sum = x[0];
  for (int k = 1; k < kChains; ++k) sum += x[k];
  double result[8] = {};
  __builtin_memcpy(result, &sum, sizeof sum);
  *lanes *= kChains;
  return result[0];
}

}  // namespace polyglide::bench
