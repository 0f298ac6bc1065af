#pragma once

#include <cstdint>
#include <unordered_map>

#include "kinematics/cell_bounds.hpp"
#include "kinematics/region.hpp"

namespace polyglide {

using CellPlace = std::array<int, 3>;

/// One of the 8^level equal boxes of a box, or 4^level where the box is flat.
struct OctreeCell {
  int level = 0;
  CellPlace at{};
  CellBounds known;
};

/// Where the cells of an octree over a box are. A box without size along an axis is not split along
/// it (quadtree), and cells have areas for volumes.
class OctreeBox {
 public:
  static constexpr int kDeepest = 19;

  explicit OctreeBox(const Bounds& box) : box_(box) {}

  [[nodiscard]] bool is_flat(int axis) const { return box_.lower[axis] == box_.upper[axis]; }

  /// The box of a cell. Neighbours share their rounded corners, so that no place is lost between.
  /// Needs UpwardRounding.
  [[nodiscard]] PoseBox box_of(const OctreeCell& cell) const;
  [[nodiscard]] bool holds_home(const OctreeCell& cell) const;
  [[nodiscard]] double volume_of(const OctreeCell& cell) const;

 private:
  [[nodiscard]] double corner(int axis, int level, int index) const;
  Bounds box_;
};

/// Which cells of an octree hang together. Cost: some lookups per cell.
class OctreeParts {
 public:
  /// Cells that are not out, of which none holds another. All three are kept by reference.
  /// @param join whether surely_with_home() will be asked
  OctreeParts(const OctreeBox& box, const CellJudge& judge, const std::vector<OctreeCell>& cells,
              bool join = true);

  /// Index of a cell that holds home, of one wholly inside if there is any; -1 where there is none.
  [[nodiscard]] int home() const { return home_; }
  /// Joined to the cell of home, which is wholly inside, through points proved inside.
  [[nodiscard]] bool surely_with_home(int cell);
  /// Not separated from the cell of home by cells that are out.
  [[nodiscard]] bool perhaps_with_home(int cell);

 private:
  template <typename Visit>
  void neighbour(const OctreeCell& cell, const CellPlace& way, const Visit& visit) const;
  bool joined(const OctreeCell& a, const OctreeCell& b, int axis, int way) const;
  bool joined_across_levels(const OctreeCell& a, const OctreeCell& b, int axis, int way) const;
  void join_over_faces(bool join);
  void join_over_edges();

  const OctreeBox& box_;
  const CellJudge& judge_;
  const std::vector<OctreeCell>& cells_;
  int home_ = -1, lowest_ = OctreeBox::kDeepest;
  std::unordered_map<std::uint64_t, int> places_;
  std::vector<int> sure_, maybe_;  // disjoint sets: index of another of the same, or its own
};

}  // namespace polyglide
