#include "kinematics/cell_bounds.hpp"

namespace polyglide {
namespace {

Cuboid cuboid_of(const PoseBox& box) {
  Cuboid cuboid;
  for (int k = 0; k < 3; ++k) {
    cuboid.middle[k] = middle(box[k]);
    cuboid.half[k] = radius(box[k]);
  }
  return cuboid;
}

/// Mean value form: slope of the plane in the middle, and how far the limit may be from it.
std::optional<PlaneBound> plane_of(const LimitBound& whole, const Interval& in_middle,
                                   const Cuboid& cuboid) {
  PlaneBound plane{in_middle, {}};
  for (int k = 0; k < 3; ++k) {
    const Interval& g = whole.gradient[k];
    if (!std::isfinite(g.lower()) || !std::isfinite(g.upper())) return std::nullopt;
    plane.slope[k] = middle(g);
    plane.at += Interval(-1, 1) * (Interval(radius(g)) * cuboid.half[k]);
  }
  return plane;
}

}  // namespace

/// Adds up what limits take away from a box.
class CellJudge::Tally {
 public:
  Tally(const Cuboid& cuboid, CellBounds& cell, std::optional<Vector3>* extra)
      : cuboid_(cuboid), cell_(cell), extra_(extra) {
    cell_.upper = 1;
    cell_.marks = (1u << kMarks) - 1;
  }

  const Cuboid& cuboid() const { return cuboid_; }

  /// A limit that crosses.
  void take(const PlaneCut& cut) {
    cuts_.push_back(cut);
    cell_.upper = std::min(cell_.upper, cut.part.upper());
    const auto holds = [&](const Vector3& place) { return allows(cut.plane, cuboid_, place); };
    for (int mark = 0; mark < kMarks; ++mark)
      if ((cell_.marks >> mark & 1) && !holds({way_of(mark, 0), way_of(mark, 1), way_of(mark, 2)}))
        cell_.marks &= ~(1u << mark);
    if (extra_ && *extra_ && !holds(**extra_)) extra_->reset();
  }

  /// A limit that may leave nothing.
  void give_up() {
    lost_ = true;
    cell_.marks = 0;
    if (extra_) extra_->reset();
  }

  void close() {
    cell_.inside = cell_.regular && cell_.quadrics.none() && cell_.rest.none();
    const double taken = lost_ ? 1 : cuts_.empty() ? 0 : part_taken(cuboid_, std::move(cuts_));
    cell_.lower = cell_.inside ? 1 : std::max(0.0, (1.0 - Interval(taken)).lower());
    if (cell_.lower > 0) return;
    cell_.marks = 0;
    if (extra_) extra_->reset();
  }

 private:
  Cuboid cuboid_;
  CellBounds& cell_;
  std::optional<Vector3>* extra_;
  std::vector<PlaneCut> cuts_;
  bool lost_ = false;
};

CellJudge::CellJudge(const BoxLimits& limits, std::optional<int> side)
    : limits_(limits), side_(side), quadrics_(limits.quadrics(rest_)) {}

void CellJudge::end_at(const SingularWall& wall) {
  append(quadrics_, {as_quadric({Interval(-wall.offset), vector_of(wall.normal)}), {}});
}

CellBounds CellJudge::unknown() const {
  CellBounds cell;
  for (std::size_t i = 0; i < quadrics_.size(); ++i) cell.quadrics.set(i);
  cell.rest = rest_;
  cell.regular = !side_;
  return cell;
}

bool CellJudge::judge(const PoseBox& box, CellBounds& cell, std::optional<Vector3>* extra) const {
  Tally tally(cuboid_of(box), cell, extra);
  cell.branch = limits_.follow(box, cell.branch);
  for (std::size_t i = 0; i < quadrics_.size(); ++i) {
    if (!cell.quadrics[i]) continue;
    const PlaneCut left = cut_of(tally.cuboid(), quadrics_[i]);
    if (left.fails()) return false;
    if (left.holds())
      cell.quadrics.reset(i);
    else
      tally.take(left);
  }
  if (cell.rest.any() && !judge_rest(box, cell, tally)) return false;
  if (!cell.regular && !judge_regularity(box, cell, tally)) return false;
  tally.close();
  return true;
}

bool CellJudge::judge_rest(const PoseBox& box, CellBounds& cell, Tally& tally) const {
  thread_local std::vector<LimitBound> whole, in_middle;
  limits_.enclose(box, cell.rest, whole, cell.branch);
  limits_.enclose(middle_of(box), cell.rest, in_middle, cell.branch);
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    if (!cell.rest[i]) continue;
    if (whole[i].value.lower() > 0) return false;
    if (whole[i].value.upper() <= 0) {
      cell.rest.reset(i);
      continue;
    }
    const auto plane = plane_of(whole[i], in_middle[i].value, tally.cuboid());
    if (!plane) {
      tally.give_up();
      continue;
    }
    const PlaneCut left = cut_of(tally.cuboid(), *plane);
    if (left.fails()) return false;
    if (left.holds())
      cell.rest.reset(i);
    else
      tally.take(left);
  }
  return true;
}

/// False when det J has the other sign on all of the cell.
bool CellJudge::judge_regularity(const PoseBox& box, CellBounds& cell, Tally& tally) const {
  const IntervalMatrix jacobian = limits_.rod_rows(box, cell.branch);
  if (*side_ == 0) {
    cell.regular = singular_value_bounds(jacobian).least_lower > 0;
    if (!cell.regular) tally.give_up();
    return true;
  }
  const int sign = determinant_sign(jacobian);
  cell.regular = sign == *side_;
  if (sign != 0) return cell.regular;
  const auto face = singular_face(limits_, box, tally.cuboid(), *side_);
  if (!face) {
    tally.give_up();
    return true;
  }
  const PlaneCut left = cut_of(tally.cuboid(), *face);
  if (left.fails()) return false;
  cell.regular = left.holds();
  if (!cell.regular) tally.take(left);
  return true;
}

}  // namespace polyglide
