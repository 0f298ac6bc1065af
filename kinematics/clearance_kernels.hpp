#pragma once

#include <array>
#include <string>
#include <vector>

namespace polyglide::clearance {

constexpr int kBlock = 64;  ///< most poses per call of a kernel

/// A point, segment or triangle: which columns of places hold its corners.
struct PieceData {
  int corners = 1;
  std::array<int, 3> corner{};
};

/// Pieces of two shapes that must be at least √bound apart. A bound of 0 or less is always kept.
struct PairData {
  int first = 0, last = 0;              ///< pieces of the one shape
  int other_first = 0, other_last = 0;  ///< and of the other
  double bound = 0;                     ///< [m²]
  int limit = 0;
};

struct KernelModel {
  std::vector<PieceData> pieces;
  std::vector<PairData> pairs;
};

/// What an instruction set offers. `count` is a multiple of `lanes`, at most kBlock. Column c holds
/// x, y and z of a corner, kBlock numbers each. A limit that is negative becomes that of the first
/// pair too near.
struct Kernel {
  const char* name;
  int lanes;
  void (*check)(const KernelModel&, const double* places, double* limit, int count);
};

// One per instruction set, as in batch_kernels.hpp.
const Kernel& scalar_kernel();
#if defined(__x86_64__)
const Kernel& x86_64_kernel();
const Kernel& v3_kernel();
const Kernel& v4_kernel();
#endif

/// The kernel for the instruction set of that name, as batch::kernel_named() knows them.
[[nodiscard]] const Kernel& kernel_named(const std::string& name);

}  // namespace polyglide::clearance
