#pragma once

#include <cstdint>

#include "catalog/mechanism.hpp"

namespace polyglide::engines {

/// Repeatable numbers in [-1, 1).
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : state_(seed) {}
  double operator()() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
  }
  int below(int bound) { return static_cast<int>((*this)() * bound / 2 + bound / 2.0); }
  Vector3 vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace polyglide::engines
