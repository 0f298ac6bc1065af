#include "kinematics/certified_volume.hpp"

#include <tbb/parallel_for.h>

#include "kinematics/octree_parts.hpp"

namespace polyglide {
namespace {

/// Boxes of places, split where their bounds are widest.
class Octree {
 public:
  /// @param followed whether cells without a proof are to be left out as soon as others part them
  /// from home
  Octree(const CellJudge& judge, const Bounds& box, bool holds_all, bool followed)
      : box_(box), judge_(judge), holds_all_(holds_all), followed_(followed) {}

  std::optional<CertifiedVolume> run(double tolerance, int budget) {
    std::vector<OctreeCell> start{{0, {}, judge_.unknown()}};
    judge(start);
    split_around_home(start);
    if (!holds_all_ && !followed_) split_along_box(start);
    cells_ = std::move(start);
    while (true) {
      if (followed_ && !leave_strangers()) return std::nullopt;
      const auto [lower, upper] = sums();
      if (upper <= 0) return std::nullopt;
      const double gap = upper - lower, aim = kRoom * tolerance * upper;
      if (gap <= aim || examined_ >= budget) break;
      // Too much is left for what is left of the budget.
      if (followed_ && 10 * examined_ >= budget && lower < kHopeless * upper) return std::nullopt;
      if (!split_widest(std::max(gap - aim, gap / 8), budget - examined_)) break;
    }
    CertifiedVolume result;
    if (!bound_part(result)) return std::nullopt;
    result.cells = examined_;
    result.reached = result.upper - result.lower <= tolerance * result.upper;
    return result;
  }

 private:
  static constexpr int kFaceDepth = 6;
  static constexpr double kHopeless = 0.1;
  static constexpr double kRoom = 0.9;  // what is aimed at: joining parts loses a little

  /// Judges all, on all threads; leaves those that are not out, in their order.
  void judge(std::vector<OctreeCell>& cells) {
    std::vector<char> keep(cells.size(), 0);
    constexpr std::size_t kBlock = 64;
    tbb::parallel_for(std::size_t{0}, (cells.size() + kBlock - 1) / kBlock, [&](std::size_t b) {
      const UpwardRounding rounding;
      const std::size_t end = std::min(cells.size(), (b + 1) * kBlock);
      for (std::size_t i = b * kBlock; i < end; ++i)
        keep[i] = judge_.judge(box_.box_of(cells[i]), cells[i].known);
    });
    examined_ += static_cast<int>(cells.size());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (keep[i]) cells[kept++] = cells[i];
    cells.resize(kept);
  }

  /// Puts in place of every chosen cell what its eight parts leave. False when there was none.
  template <typename Choose>
  bool split(std::vector<OctreeCell>& cells, const Choose& choose) {
    std::vector<OctreeCell> children, others;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const OctreeCell& cell = cells[i];
      if (!choose(i)) {
        others.push_back(cell);
        continue;
      }
      for (int part = 0; part < 8; ++part) {
        if (is_beside(part)) continue;
        OctreeCell& child = children.emplace_back(cell);
        child.level = cell.level + 1;
        for (int k = 0; k < 3; ++k) child.at[k] = 2 * cell.at[k] + (part >> k & 1);
      }
    }
    if (children.empty()) return false;
    judge(children);
    others.insert(others.end(), children.begin(), children.end());
    cells = std::move(others);
    return true;
  }

  /// Whether a face of the cell that is in the box's own is not proved to be out.
  bool escapes(const OctreeCell& cell) const {
    const PoseBox box = box_.box_of(cell);
    for (int k = 0; k < 3; ++k)
      for (const bool upper : {false, true}) {
        if (box_.is_flat(k) || cell.at[k] != (upper ? (1 << cell.level) - 1 : 0)) continue;
        PoseBox face = box;
        face[k] = Interval(upper ? box[k].upper() : box[k].lower());
        if (leaves_something(face, cell.known, kFaceDepth)) return true;
      }
    return false;
  }

  /// Of a face, in at most 4^depth parts.
  bool leaves_something(const PoseBox& face, const CellBounds& known, int depth) const {
    CellBounds here = known;
    if (!judge_.judge(face, here)) return false;
    if (depth == 0) return true;
    for (int part = 0; part < 8; ++part) {
      PoseBox piece = face;
      bool twice = false;
      for (int k = 0; k < 3; ++k) {
        const double cut = middle(face[k]);
        const bool high = part >> k & 1;
        if (face[k].lower() == face[k].upper())
          twice = twice || high;
        else
          piece[k] = high ? Interval(cut, face[k].upper()) : Interval(face[k].lower(), cut);
      }
      if (!twice && leaves_something(piece, here, depth - 1)) return true;
    }
    return false;
  }

  /// Parts of a cell that are none, because the box is flat there.
  bool is_beside(int part) const {
    for (int k = 0; k < 3; ++k)
      if ((part >> k & 1) && box_.is_flat(k)) return true;
    return false;
  }

  bool touches_box(const OctreeCell& cell) const {
    for (int k = 0; k < 3; ++k)
      if (!box_.is_flat(k) && (cell.at[k] == 0 || cell.at[k] == (1 << cell.level) - 1)) return true;
    return false;
  }

  /// Where strokes are unlimited the box is a guess: small cells along it show that it was wide
  /// enough.
  void split_along_box(std::vector<OctreeCell>& cells) {
    constexpr int kFine = 6;
    for (int level = 0; level < kFine; ++level)
      split(cells, [&](std::size_t i) { return touches_box(cells[i]) && cells[i].level < kFine; });
  }

  /// Small cells around home until one that holds it is wholly inside.
  void split_around_home(std::vector<OctreeCell>& cells) {
    constexpr int kFinest = 14;
    for (int level = 0; level < kFinest; ++level) {
      if (std::ranges::any_of(cells, [&](const OctreeCell& cell) {
            return cell.known.inside && box_.holds_home(cell);
          }))
        return;
      if (!split(cells, [&](std::size_t i) { return box_.holds_home(cells[i]); })) return;
    }
  }

  double gap_of(const OctreeCell& cell) const {
    return (cell.known.upper - cell.known.lower) * box_.volume_of(cell);
  }

  std::pair<double, double> sums() const {
    double lower = 0, upper = 0;
    for (const OctreeCell& cell : cells_) {
      lower += cell.known.lower * box_.volume_of(cell);
      upper += cell.known.upper * box_.volume_of(cell);
    }
    return {lower, upper};
  }

  /// Splits the cells with the widest bounds, enough to hold most of `excess` or to make `most`
  /// new ones. False when none can be split.
  bool split_widest(double excess, int most) {
    std::vector<std::pair<double, std::size_t>> gaps;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const double gap = gap_of(cells_[i]);
      if (gap > 0 && cells_[i].level < OctreeBox::kDeepest) gaps.emplace_back(gap, i);
    }
    std::sort(gaps.begin(), gaps.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    std::vector<char> chosen(cells_.size(), 0);
    double sum = 0;
    for (const auto& [gap, cell] : gaps) {
      if (sum > excess || most <= 0) break;
      sum += gap;
      most -= 8;
      chosen[cell] = 1;
    }
    return split(cells_, [&](std::size_t i) { return chosen[i] != 0; });
  }

  /// Leaves out what belongs to other parts; false when there is no home.
  bool leave_strangers() {
    OctreeParts parts(box_, judge_, cells_, false);
    if (parts.home() < 0) return false;
    std::vector<OctreeCell> kept;
    for (int i = 0; i < static_cast<int>(cells_.size()); ++i)
      if (parts.perhaps_with_home(i)) kept.push_back(std::move(cells_[i]));
    cells_ = std::move(kept);
    return true;
  }

  /// Bounds of the part around home; false when it cannot be told.
  bool bound_part(CertifiedVolume& result) const {
    OctreeParts parts(box_, judge_, cells_);
    if (parts.home() < 0) return false;
    const UpwardRounding rounding;
    Interval lower(0.0), upper(0.0);
    for (int i = 0; i < static_cast<int>(cells_.size()); ++i) {
      const OctreeCell& cell = cells_[i];
      if (!parts.perhaps_with_home(i)) continue;
      if (!holds_all_ && (followed_ ? escapes(cell) : touches_box(cell))) return false;
      const PoseBox box = box_.box_of(cell);
      Interval size(1.0);
      for (int k = 0; k < 3; ++k)
        if (!box_.is_flat(k)) size *= Interval(box[k].upper()) - box[k].lower();
      upper += cell.known.upper * size;
      if (cell.known.lower > 0 && parts.surely_with_home(i)) lower += cell.known.lower * size;
    }
    result.lower = lower.lower();
    result.upper = upper.upper();
    return true;
  }

  OctreeBox box_;
  const CellJudge& judge_;
  bool holds_all_, followed_;
  int examined_ = 0;
  std::vector<OctreeCell> cells_;
};

/// Sign of det J at home, 0 where J is not square; nullopt where home is, or may be, singular.
std::optional<int> side_of_home(const Machine& machine, const std::vector<std::string>& ignored) {
  const auto limits = make_box_limits(machine, ignored, Eigen::Quaterniond::Identity(), false);
  if (!limits) return std::nullopt;
  PoseBox home;
  home.fill(Interval(0.0));
  const IntervalMatrix jacobian = limits->rod_rows(home, limits->follow(home, nullptr));
  if (jacobian.rows() < jacobian.cols()) return std::nullopt;
  if (jacobian.rows() > jacobian.cols()) return 0;
  const int side = determinant_sign(jacobian);
  return side != 0 ? std::optional(side) : std::nullopt;
}

}  // namespace

std::optional<CertifiedVolume> certify_volume(const Machine& machine,
                                              const std::vector<std::string>& ignored,
                                              const Eigen::Quaterniond& rotation, const Bounds& box,
                                              const SingularPlaces& singular, double tolerance,
                                              int budget) {
  // Joints that hang together by the dozen would take minutes.
  constexpr double kGreatestEffort = 3000, kWork = 1.6e7;
  if (machine.task.translations < 2) return std::nullopt;
  const auto commands = [&](int axis) { return std::ranges::count(machine.task.axes, axis) > 0; };
  const auto asked = coordinates_of({Vector3::Zero(), rotation.normalized()});
  for (int axis = 3; axis < 6; ++axis)
    if (std::abs(asked[axis]) > 1e-9 && !commands(axis)) return std::nullopt;
  std::unique_ptr<const BoxLimits> limits;
  std::optional<int> side;
  {
    const UpwardRounding rounding;
    limits = make_box_limits(machine, ignored, rotation, false);
    if (!limits || limits->effort() > kGreatestEffort) return std::nullopt;
    if (!singular.count && !(side = side_of_home(machine, ignored))) return std::nullopt;
  }
  // A margin, so that what is inside does not touch the box, and uneven, so that faces
  // of the workspace do not lie in faces of cells.
  Bounds roomy = box;
  const Vector3 size = box.upper - box.lower;
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(size[k]) || (size[k] > 0) != commands(k)) return std::nullopt;
  roomy.lower -= size.cwiseProduct(Vector3(0.0131, 0.0173, 0.0119));
  roomy.upper += size.cwiseProduct(Vector3(0.0157, 0.0109, 0.0147));
  const bool followed = limits->effort() > 0;
  if (followed) budget = std::min(budget, static_cast<int>(kWork / limits->effort()));
  const bool limited =
      !followed &&
      std::all_of(machine.legs->legs.begin(), machine.legs->legs.end(), [](const Leg& leg) {
        return std::isfinite(leg.stroke.max) &&
               (leg.kind == Leg::Kind::strut || std::isfinite(leg.stroke.min));
      });
  // Made of intervals, and so under the rounding that they need.
  const UpwardRounding rounding;
  CellJudge judge(*limits, side);
  if (singular.wall) judge.end_at(*singular.wall);
  Octree octree(judge, roomy, limited, followed);
  return octree.run(tolerance, budget);
}

}  // namespace polyglide
