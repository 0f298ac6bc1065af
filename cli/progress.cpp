#include "cli/progress.hpp"

#include <fmt/chrono.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace polyglide {
namespace {

constexpr std::chrono::milliseconds kPatience{2000}, kRedraw{200};

}  // namespace

Progress::Progress(std::string job, bool quiet)
    : job_(std::move(job)), enabled_(!quiet && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (shown_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::update(double done, double total) {
  if (!enabled_ || (total > 0 && done <= 0)) return;
  const std::scoped_lock lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (now - start_ < kPatience || now - drawn_ < kRedraw) return;

  using std::chrono::seconds;
  if (total > 0) {
    const double share = std::min(done / total, 1.0);
    const auto left = std::chrono::duration_cast<seconds>((now - start_) * (1 / share - 1));
    fmt::print(stderr, "\r{}: {:.0f} % ({:%M:%S} left)\x1b[K", job_, 100 * share, left);
  } else {
    const auto spent = std::chrono::duration_cast<seconds>(now - start_);
    fmt::print(stderr, "\r{}: refining ({:%M:%S} so far)\x1b[K", job_, spent);
  }
  std::fflush(stderr);
  drawn_ = now;
  shown_ = true;
}

}  // namespace polyglide
