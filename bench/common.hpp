#pragma once

#include <time.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "catalog/catalog.hpp"
#include "kinematics/evaluate.hpp"

// What the programs of this folder share: processor time of this thread, the peak, the poses.
namespace polyglide::bench {

double peak_v3(std::size_t rounds, int* lanes);
double peak_v4(std::size_t rounds, int* lanes);

inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Least processor time of one call, of many.
template <typename Call>
double best_seconds(const Call& call, int repeats = 25) {
  double best = 1e9;
  for (int i = 0; i < repeats; ++i) {
    const double start = thread_seconds();
    call();
    best = std::min(best, thread_seconds() - start);
  }
  return best;
}

/// A number that counts what is done to it: each operation, square root or quotient is one.
struct Counted {
  double value = 0;
  static inline std::size_t operations = 0;
  Counted() = default;
  explicit Counted(double v) : value(v) {}
  static Counted made(double v) {
    ++operations;
    return Counted(v);
  }
  friend Counted operator+(Counted a, Counted b) { return made(a.value + b.value); }
  friend Counted operator-(Counted a, Counted b) { return made(a.value - b.value); }
  friend Counted operator*(Counted a, Counted b) { return made(a.value * b.value); }
  friend Counted operator/(Counted a, Counted b) { return made(a.value / b.value); }
  friend bool operator<(Counted a, Counted b) { return a.value < b.value; }
  friend bool operator>(Counted a, Counted b) { return a.value > b.value; }
  friend bool operator<=(Counted a, Counted b) { return a.value <= b.value; }
  friend bool operator>=(Counted a, Counted b) { return a.value >= b.value; }
  friend bool operator==(Counted a, Counted b) { return a.value == b.value; }
};

/// Seeded uniform numbers in (-1, 1).
class Uniform {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
  }

 private:
  std::uint64_t state_ = 42;
};

inline PoseBatch random_poses(std::size_t count, double reach, double height, double turn) {
  Uniform random;
  PoseBatch poses;
  for (std::size_t i = 0; i < count; ++i) {
    poses.x.push_back(reach * random());
    poses.y.push_back(reach * random());
    poses.z.push_back(height * random());
    if (turn > 0)
      for (auto& angle : poses.angles) angle.push_back(turn * random());
  }
  return poses;
}

inline void write_poses(const std::string& path, const PoseBatch& poses) {
  std::ofstream file(path);
  file.precision(17);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    file << poses.x[i] << ' ' << poses.y[i] << ' ' << poses.z[i];
    for (const auto& angle : poses.angles)
      if (!angle.empty()) file << ' ' << angle[i];
    file << '\n';
  }
}

}  // namespace polyglide::bench
