#pragma once

#include "kinematics/clearance_kernels.hpp"
#include "kinematics/piece_distance.hpp"

/// Clearances of a block of poses, written once for a number or a register V. Only
/// clearance_kernel_*.cpp instantiate it, each for one instruction set.
namespace polyglide::clearance {

using simd::select;

template <class V>
inline pieces::Piece<V> piece_at(const PieceData& piece, const double* places, int i) {
  pieces::Piece<V> result;
  result.corners = piece.corners;
  for (int k = 0; k < piece.corners; ++k) {
    const double* column = places + 3 * kBlock * piece.corner[k] + i;
    result.corner[k] = {simd::Lanes<V>::load(column), simd::Lanes<V>::load(column + kBlock),
                        simd::Lanes<V>::load(column + 2 * kBlock)};
  }
  return result;
}

template <class V>
void check(const KernelModel& model, const double* places, double* limit, int count) {
  for (const PairData& pair : model.pairs)
    for (int a = pair.first; a < pair.last; ++a)
      for (int b = pair.other_first; b < pair.other_last; ++b)
        for (int i = 0; i < count; i += simd::Lanes<V>::count) {
          const V square = pieces::squared_distance(piece_at<V>(model.pieces[a], places, i),
                                                    piece_at<V>(model.pieces[b], places, i));
          const V known = simd::Lanes<V>::load(limit + i);
          const auto broken = (square < V(pair.bound)) & (known < V(0));
          simd::Lanes<V>::store(limit + i, select(broken, V(double(pair.limit)), known));
        }
}

}  // namespace polyglide::clearance
