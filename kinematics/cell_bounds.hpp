#pragma once

#include "kinematics/probe.hpp"
#include "kinematics/singular_face.hpp"

namespace polyglide {

/// Points of a cell by which pieces are joined: its 8 corners, then the middles of its 6 faces.
inline constexpr int kMarks = 14;

/// Coordinate of a mark, in [-1, 1] of the cell.
[[nodiscard]] constexpr double way_of(int mark, int axis) {
  if (mark < 8) return mark >> axis & 1 ? 1 : -1;
  if ((mark - 8) / 2 != axis) return 0;
  return (mark - 8) % 2 ? 1 : -1;
}

/// What is known of a box of places.
struct CellBounds {
  std::bitset<2 * BoxLimits::kMost + 1> quadrics;  ///< limits not proved to hold on all of it
  BoxLimits::Mask rest;                            ///< the same of those that are no quadrics
  bool regular = false;                            ///< det J proved to have home's sign
  bool inside = false;                             ///< wholly
  double lower = 0, upper = 1;                     ///< part of it that is inside
  unsigned marks = 0;                              ///< those in the convex piece proved inside
  BoxLimits::BranchPointer branch;                 ///< where the joints are
};

/// Bounds what of a box belongs to the workspace at one orientation: limits and the singular face
/// that cross it are enclosed between parallel planes, whose distance shrinks with the square of
/// the box. Needs UpwardRounding. Fixed; share between threads.
class CellJudge {
 public:
  /// @param side sign of det J that counts; 0 where J is not square; null where singular poses
  /// belong to the workspace, too
  CellJudge(const BoxLimits& limits, std::optional<int> side);

  /// What lies beyond the wall is out.
  void end_at(const SingularWall& wall);

  /// Nothing known.
  [[nodiscard]] CellBounds unknown() const;

  /// Takes up what was known of a larger box, and leaves what is known of this one; false when
  /// it is out. `extra`, a place in [-1, 1]³ of the box, is taken away when it is not in
  /// the piece proved inside.
  bool judge(const PoseBox& box, CellBounds& cell, std::optional<Vector3>* extra = nullptr) const;

 private:
  class Tally;
  bool judge_rest(const PoseBox& box, CellBounds& cell, Tally& tally) const;
  bool judge_regularity(const PoseBox& box, CellBounds& cell, Tally& tally) const;

  const BoxLimits& limits_;
  std::optional<int> side_;
  BoxLimits::Mask rest_;
  std::vector<QuadricLimit> quadrics_;
};

}  // namespace polyglide
