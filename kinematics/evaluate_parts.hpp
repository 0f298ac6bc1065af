#pragma once

#include <tbb/parallel_for.h>

#include "kinematics/evaluate.hpp"

// What the closed and the general way of evaluating poses share.
namespace polyglide {

/// Names of limits in the order in which broken_limit() looks for them; "motion" and "not finite"
/// are the last two.
[[nodiscard]] std::vector<std::string> general_limit_names(const Machine& machine);

/// The limit that needs no solving: a coordinate that is no number, or one that a pure
/// machine does not have; -1 when there is none.
/// @param names how many limits have a name
[[nodiscard]] int limit_of_coordinates(const Machine& machine, const Pose& pose, int names);

/// Indices of a pose that is not reachable.
void clear_at(std::size_t pose, BatchResult& result);

/// Runs `work(first, last)` on blocks of fixed size, so that results do not
/// depend on how many threads share them.
template <typename Work>
void in_blocks(std::size_t size, std::size_t block, const Work& work) {
  if (size <= block) {
    if (size > 0) work(std::size_t{0}, size);
    return;
  }
  const std::size_t blocks = (size + block - 1) / block;
  tbb::parallel_for(std::size_t{0}, blocks,
                    [&](std::size_t i) { work(i * block, std::min(size, (i + 1) * block)); });
}

}  // namespace polyglide
