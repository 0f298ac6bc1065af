#pragma once

#include "kinematics/batch_kernels.hpp"
#include "kinematics/evaluate.hpp"

namespace polyglide {

/// A batch of poses in the words of a kernel, and its answers brought back. Poses that fill no
/// register are padded. Keeps references to all it is given, whose columns have their lengths.
class KernelRun {
 public:
  KernelRun(const batch::KernelModel& model, const PoseBatch& poses, BatchResult& result);

  /// Answers the poses from `first` to `last`.
  void operator()(std::size_t first, std::size_t last) const;

 private:
  void run(std::size_t first, std::size_t count) const;
  void run_rest(std::size_t first, std::size_t count) const;

  const batch::KernelModel& model_;
  const batch::Kernel& kernel_;
  batch::KernelInput in_;
  batch::KernelOutput out_;
};

/// The same for drives, and the poses that they lead to.
class ForwardRun {
 public:
  /// @param result poses where the search starts
  ForwardRun(const batch::KernelModel& model, const DriveBatch& drives, ForwardResult& result);

  void operator()(std::size_t first, std::size_t last) const;

 private:
  void run_rest(std::size_t first, std::size_t count) const;

  const batch::KernelModel& model_;
  const batch::Kernel& kernel_;
  const DriveBatch& drives_;
  ForwardResult& result_;
};

}  // namespace polyglide
