#include "kinematics/octree_parts.hpp"

#include <numeric>

namespace polyglide {
namespace {

std::uint64_t place_key(int level, const CellPlace& at) {
  std::uint64_t result = static_cast<std::uint64_t>(level);
  for (int k = 0; k < 3; ++k) result = result << 19 | static_cast<std::uint64_t>(at[k]);
  return result;
}

int first_of(std::vector<int>& group, int i) {
  while (group[i] != i) i = group[i] = group[group[i]];
  return i;
}

void unite(std::vector<int>& group, int a, int b) {
  group[first_of(group, a)] = first_of(group, b);
}

}  // namespace

double OctreeBox::corner(int axis, int level, int index) const {
  const double step = std::ldexp(box_.upper[axis] - box_.lower[axis], -level);
  return box_.lower[axis] + step * index;
}

PoseBox OctreeBox::box_of(const OctreeCell& cell) const {
  PoseBox box;
  box.fill(Interval(0.0));
  for (int axis = 0; axis < 3; ++axis)
    box[axis] = Interval(corner(axis, cell.level, cell.at[axis]),
                         corner(axis, cell.level, cell.at[axis] + 1));
  return box;
}

bool OctreeBox::holds_home(const OctreeCell& cell) const {
  for (int k = 0; k < 3; ++k)
    if (corner(k, cell.level, cell.at[k]) > 0 || corner(k, cell.level, cell.at[k] + 1) < 0)
      return false;
  return true;
}

double OctreeBox::volume_of(const OctreeCell& cell) const {
  double size = 1;
  for (int k = 0; k < 3; ++k)
    if (!is_flat(k)) size *= std::ldexp(box_.upper[k] - box_.lower[k], -cell.level);
  return size;
}

OctreeParts::OctreeParts(const OctreeBox& box, const CellJudge& judge,
                         const std::vector<OctreeCell>& cells, bool join)
    : box_(box), judge_(judge), cells_(cells), sure_(cells.size()), maybe_(cells.size()) {
  places_.reserve(2 * cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    places_.emplace(place_key(cells[i].level, cells[i].at), static_cast<int>(i));
    lowest_ = std::min(lowest_, cells[i].level);
    if (box_.holds_home(cells[i]) && (home_ < 0 || cells[i].known.inside))
      home_ = static_cast<int>(i);
  }
  std::iota(sure_.begin(), sure_.end(), 0);
  std::iota(maybe_.begin(), maybe_.end(), 0);
  if (home_ < 0) return;
  join_over_faces(join);
  const int count = static_cast<int>(cells.size());
  for (int i = 0; i < count; ++i)
    if (!perhaps_with_home(i)) {
      join_over_edges();
      break;
    }
}

bool OctreeParts::surely_with_home(int cell) {
  return cells_[home_].known.inside && first_of(sure_, cell) == first_of(sure_, home_);
}

bool OctreeParts::perhaps_with_home(int cell) {
  return first_of(maybe_, cell) == first_of(maybe_, home_);
}

/// Calls visit(neighbour) for the cell of equal or lower level across, if any is left.
template <typename Visit>
void OctreeParts::neighbour(const OctreeCell& cell, const CellPlace& way,
                            const Visit& visit) const {
  CellPlace at;
  for (int k = 0; k < 3; ++k) {
    at[k] = cell.at[k] + way[k];
    if (at[k] < 0 || at[k] >= 1 << cell.level) return;
  }
  for (int level = cell.level; level >= lowest_; --level) {
    const auto found = places_.find(place_key(level, at));
    if (found != places_.end()) {
      visit(found->second);
      return;
    }
    for (int& each : at) each >>= 1;
  }
}

void OctreeParts::join_over_faces(bool join) {
  const int count = static_cast<int>(cells_.size());
  for (int i = 0; i < count; ++i)
    for (int axis = 0; axis < 3; ++axis)
      for (int way : {-1, 1}) {
        if (box_.is_flat(axis)) continue;
        CellPlace step{};
        step[axis] = way;
        neighbour(cells_[i], step, [&](int other) {
          unite(maybe_, i, other);
          if (join && first_of(sure_, i) != first_of(sure_, other) &&
              joined(cells_[i], cells_[other], axis, way))
            unite(sure_, i, other);
        });
      }
}

/// Cells that touch in an edge or a corner only are not separated either.
void OctreeParts::join_over_edges() {
  const int count = static_cast<int>(cells_.size());
  for (int i = 0; i < count; ++i)
    for (int code = 0; code < 27; ++code) {
      const CellPlace step{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
      if (std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]) < 2) continue;
      neighbour(cells_[i], step, [&](int other) { unite(maybe_, i, other); });
    }
}

/// Whether the pieces proved inside have a common point; `a` is the finer one.
bool OctreeParts::joined(const OctreeCell& a, const OctreeCell& b, int axis, int way) const {
  const unsigned ours = a.known.marks, theirs = b.known.marks;
  if (!ours || !(b.known.lower > 0)) return false;
  if (b.known.inside) {
    // Any marked point of a on the shared face will do.
    for (int mark = 0; mark < kMarks; ++mark)
      if ((ours >> mark & 1) && way_of(mark, axis) == way) return true;
    return false;
  }
  if (a.level != b.level) return joined_across_levels(a, b, axis, way);
  for (int mark = 0; mark < 8; ++mark)
    if (way_of(mark, axis) == way && (ours >> mark & 1) && (theirs >> (mark ^ (1 << axis)) & 1))
      return true;
  return (ours >> (8 + 2 * axis + (way > 0)) & 1) && (theirs >> (8 + 2 * axis + (way < 0)) & 1);
}

/// The same where b is coarser and crossed: its piece is asked about the marked points of a.
bool OctreeParts::joined_across_levels(const OctreeCell& a, const OctreeCell& b, int axis,
                                       int way) const {
  const UpwardRounding rounding;
  const double scale = std::ldexp(1.0, b.level - a.level);
  for (int mark = 0; mark < kMarks; ++mark) {
    if (!(a.known.marks >> mark & 1) || way_of(mark, axis) != way) continue;
    // From a's own coordinates to those of b: halves and quarters, so exact.
    Vector3 place;
    for (int k = 0; k < 3; ++k)
      place[k] = 2 * scale * (a.at[k] + (way_of(mark, k) + 1) / 2) - 2 * b.at[k] - 1;
    std::optional<Vector3> extra = place;
    CellBounds known = b.known;
    if (judge_.judge(box_.box_of(b), known, &extra) && extra) return true;
  }
  return false;
}

}  // namespace polyglide
