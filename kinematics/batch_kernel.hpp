#pragma once

#include "kinematics/batch_kernel_forward.hpp"
#include "kinematics/batch_kernel_indices.hpp"
#include "kinematics/batch_kernel_legs.hpp"

/// The batch evaluator's inner part: plain numbers in, plain numbers out, one kernel
/// written once for a number or a register of numbers V. Only batch_kernel_*.cpp
/// instantiate it, each for one instruction set; batch_dispatch.cpp chooses.
namespace polyglide::batch {
namespace detail {

template <class V, int N, bool kTurning, class Legs>
[[gnu::flatten]] void run_legs(const KernelModel& model, const KernelInput& in,
                               const KernelOutput& out, int count) {
  for (int i = 0; i < count; i += Lanes<V>::count) {
    Pack<V, Legs> pack;
    solve<V, kTurning>(model, in, i, pack);
    Lanes<V>::store_whole(out.limit + i, pack.limit);
    store_columns<V, N>(model, pack, out, i);
    conclude<V, N>(model, pack, out, i);
  }
}

/// Whether AlikeLegs<kind, columns> describes the machine.
inline bool alike(const KernelModel& model, LegKind kind, int columns) {
  if (model.columns != columns || model.drives != columns) return false;
  if (static_cast<int>(model.legs.size()) != columns) return false;
  for (int d = 0; d < columns; ++d)
    if (const LegData& leg = model.legs[d];
        leg.kind != kind || leg.drive != d || !leg.primary || model.axes[d] != d)
      return false;
  return true;
}

template <class V, int N>
void run(const KernelModel& model, const KernelInput& in, const KernelOutput& out, int count) {
  using simd::WideOf;
  if constexpr (N == 3) {
    if (!in.turning() && alike(model, LegKind::guide_rod, N))
      return run_legs<WideOf<V>, N, false, AlikeLegs<LegKind::guide_rod, N>>(model, in, out, count);
  }
  if constexpr (N == 6) {
    if (in.turning() && alike(model, LegKind::strut, N))
      return run_legs<V, N, true, AlikeLegs<LegKind::strut, N>>(model, in, out, count);
  }
  if (in.turning())
    run_legs<V, N, true, AnyLegs>(model, in, out, count);
  else
    run_legs<V, N, false, AnyLegs>(model, in, out, count);
}

}  // namespace detail

/// Drives to poses by Newton's method from the poses given; the residual is the greatest
/// error of a leg's squared length, relative.
template <class V>
void forward(const KernelModel& model, const ForwardColumns& io, int count) {
  switch (model.columns) {
    case 1:
      return detail::run_forward<V, 1>(model, io, count);
    case 2:
      return detail::run_forward<V, 2>(model, io, count);
    case 3:
      return detail::run_forward<V, 3>(model, io, count);
    case 4:
      return detail::run_forward<V, 4>(model, io, count);
    case 5:
      return detail::run_forward<V, 5>(model, io, count);
    default:
      return detail::run_forward<V, 6>(model, io, count);
  }
}

/// Poses to limits, places and indices.
template <class V>
void evaluate(const KernelModel& model, const KernelInput& in, const KernelOutput& out, int count) {
  switch (model.columns) {
    case 1:
      return detail::run<V, 1>(model, in, out, count);
    case 2:
      return detail::run<V, 2>(model, in, out, count);
    case 3:
      return detail::run<V, 3>(model, in, out, count);
    case 4:
      return detail::run<V, 4>(model, in, out, count);
    case 5:
      return detail::run<V, 5>(model, in, out, count);
    default:
      return detail::run<V, 6>(model, in, out, count);
  }
}

}  // namespace polyglide::batch
