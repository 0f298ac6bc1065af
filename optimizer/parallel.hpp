#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <mutex>
#include <string>

#include "optimizer/run_options.hpp"

namespace polyglide {

/// Runs work(i) for 0 <= i < count on the asked number of threads, one index at a time
/// so that long ones do not hold up others, and tells how far the stage is.
template <typename Work>
void in_parallel(int count, const RunOptions& options, const std::string& stage, const Work& work) {
  std::mutex mutex;
  RunProgress progress{stage, 0, static_cast<double>(count)};
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    const tbb::blocked_range<int> all(0, count, 1);
    tbb::parallel_for(
        all,
        [&](const tbb::blocked_range<int>& range) {
          for (int i = range.begin(); i < range.end(); ++i) {
            work(i);
            if (!options.progress) continue;
            const std::lock_guard lock(mutex);
            ++progress.done;
            options.progress(progress);
          }
        },
        tbb::simple_partitioner());
  });
}

}  // namespace polyglide
