#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace polyglide {

/// A line on standard error that says how far a long job is and how long it will
/// still take. Appears after two seconds, only on a terminal and not with --quiet;
/// wiped when the job ends. Safe to update from any thread.
class Progress {
 public:
  explicit Progress(std::string job, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of `total` equal parts are finished; total 0: how much is left is not known, and the
  /// time so far is shown. Redraws at most five times a second.
  void update(double done, double total);

 private:
  using Clock = std::chrono::steady_clock;
  std::string job_;
  bool shown_ = false;
  bool enabled_;
  Clock::time_point start_ = Clock::now(), drawn_ = start_;
  std::mutex mutex_;
};

}  // namespace polyglide
