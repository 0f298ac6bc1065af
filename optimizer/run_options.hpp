#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace polyglide {

/// How far a long job is: `done` of `total` equal parts of a stage are finished.
struct RunProgress {
  std::string stage;  ///< "enumerate", "look", "tune", "measure"
  double done = 0, total = 0;
};

/// How a study or a design job is carried out.
struct RunOptions {
  std::uint64_t seed = 1;
  int threads = 0;               ///< 0: as many as there are cores; results do not depend on it
  std::filesystem::path out;     ///< folder for the store; empty: nothing is stored
  std::string version, command;  ///< for the provenance
  std::function<void(const RunProgress&)> progress;  ///< called by one thread at a time
};

}  // namespace polyglide
