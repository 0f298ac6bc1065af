#include "kinematics/exact_measure.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "kinematics/pieces.hpp"

namespace polyglide {
namespace {

/// Groups that are joined by and by.
class Groups {
 public:
  int add() {
    parent_.push_back(static_cast<int>(parent_.size()));
    return parent_.back();
  }
  int root(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int a, int b) { parent_[std::max(root(a), root(b))] = std::min(root(a), root(b)); }

 private:
  std::vector<int> parent_;
};

struct Line {
  std::vector<int> pattern;
  std::vector<double> numbers;  // lengths of the spans
  std::vector<Span> spans;
};

/// One strip of a plane: a span of a leaf of lines.
struct Strip {
  double y = 0, z = 0;  // in its middle
  int part = 0;
};

struct Plane {
  std::vector<int> pattern;
  std::vector<double> numbers;  // areas of the parts
  double x = 0, error = 0;
  std::vector<Strip> strips;
  /// Leaves of lines: where they are, their pattern, and the part of each span.
  struct Row {
    double a = 0, b = 0;
    std::vector<int> parts;
  };
  std::vector<Row> rows;
};

bool overlap(const Span& a, const Span& b) {
  return std::min(a.to, b.to) > std::max(a.from, b.from);
}

class Measurer {
 public:
  Measurer(const LineLimits& limits, const Bounds& extent, double size, const ExactSearch& search)
      : limits_(limits), extent_(extent), size_(size), search_(search) {}

  std::optional<ExactMeasure> run(const Vector3& inside) {
    const Vector3 at = limits_.in_frame(inside);
    return limits_.dimensions() == 2 ? planar(at) : spatial(at);
  }

 private:
  static constexpr double kShare = 8;         // part of the tolerance that planes take
  static constexpr int kFirst = 64;           // planes to begin with
  static constexpr std::size_t kSign = 4096;  // lines between two signs of life

  /// Lines in each plane to begin with: what is thinner than they are apart is missed, and at the
  /// finest tolerances that shows.
  [[nodiscard]] int first_lines() const { return search_.tolerance < 1e-6 ? 320 : 160; }

  Line line(double x, double y) const {
    Line result;
    limits_.spans(x, y, result.spans);
    if (++lines_ % kSign == 0 && search_.working) search_.working();
    for (const Span& span : result.spans) {
      result.pattern.push_back(span.first);
      result.pattern.push_back(span.last);
      result.numbers.push_back(span.to - span.from);
    }
    return result;
  }

  [[nodiscard]] bool spent() const { return lines_ > search_.lines; }

  /// Parts and areas of the plane at x, to an absolute tolerance. @param hints lines to look at
  /// beside the usual ones: near the tips of a workspace planes cut slivers from it.
  Plane plane(double x, double tolerance, const std::vector<double>& hints) const {
    Plane result;
    result.x = x;
    if (spent()) return result;
    const double low = extent_.lower.y(), range = extent_.upper.y() - low;
    const auto at = [&](double y, const Line&, const Line&) { return line(x, y); };
    Pieces<Line, decltype(at)> pieces(at, range, tolerance);
    std::vector<double> places(hints);
    const int count = first_lines();
    for (int i = 0; i <= count; ++i) places.push_back(low + range * i / count);
    std::ranges::sort(places);
    std::vector<typename Pieces<Line, decltype(at)>::Mark> marks;
    for (const double y : places)
      if (marks.empty() || y - marks.back().at > 1e-9 * range) marks.push_back({y, line(x, y)});
    pieces.run(marks);
    pieces.finish();
    result.error = pieces.error;
    Groups groups;
    std::vector<std::vector<int>> numbers;
    const auto& leaves = pieces.leaves;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      numbers.emplace_back();
      for (std::size_t s = 0; s < leaves[i].integrals.size(); ++s)
        numbers.back().push_back(groups.add());
      if (i == 0 || leaves[i].a - leaves[i - 1].b > kNear * range) continue;
      const auto &before = leaves[i - 1].right.spans, &after = leaves[i].left.spans;
      for (std::size_t s = 0; s < before.size(); ++s)
        for (std::size_t t = 0; t < after.size(); ++t)
          if (overlap(before[s], after[t])) groups.join(numbers[i - 1][s], numbers[i][t]);
    }
    std::vector<int> parts;  // root of each part, in the order in which they appear
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      Plane::Row row{leaves[i].a, leaves[i].b, {}};
      for (std::size_t s = 0; s < numbers[i].size(); ++s) {
        const int root = groups.root(numbers[i][s]);
        auto found = std::ranges::find(parts, root);
        if (found == parts.end()) {
          parts.push_back(root);
          result.numbers.push_back(0);
          found = parts.end() - 1;
        }
        const int part = static_cast<int>(found - parts.begin());
        row.parts.push_back(part);
        result.numbers[part] += leaves[i].integrals[s];
        const Span& span = leaves[i].middle.spans[s];
        result.strips.push_back({(leaves[i].a + leaves[i].b) / 2, (span.from + span.to) / 2, part});
      }
      std::vector<int> pattern = leaves[i].left.pattern;
      pattern.insert(pattern.end(), row.parts.begin(), row.parts.end());
      pattern.push_back(-1);
      if (pattern != last_of(result.pattern, pattern.size()))
        result.pattern.insert(result.pattern.end(), pattern.begin(), pattern.end());
      result.rows.push_back(std::move(row));
    }
    return result;
  }

  /// The last pattern appended, if it is as long as that.
  static std::vector<int> last_of(const std::vector<int>& whole, std::size_t length) {
    if (whole.size() < length) return {};
    const bool starts = whole.size() == length || whole[whole.size() - length - 1] == -1;
    return starts ? std::vector<int>(whole.end() - static_cast<std::ptrdiff_t>(length), whole.end())
                  : std::vector<int>{};
  }

  /// The part of a plane at a place, -1 when there is none. A place in the gap between two rows
  /// counts as the end of the nearer.
  int part_at(const Plane& plane, double y, double z) const {
    const auto aside = [y](const Plane::Row& row) { return y - std::clamp(y, row.a, row.b); };
    const auto row = std::ranges::min_element(
        plane.rows, {}, [&](const Plane::Row& each) { return std::abs(aside(each)); });
    const double width = extent_.upper.y() - extent_.lower.y();
    if (row == plane.rows.end() || std::abs(aside(*row)) > kNear * width) return -1;
    std::vector<Span> spans;
    limits_.spans(plane.x, y - aside(*row), spans);
    if (spans.size() != row->parts.size()) return -1;
    for (std::size_t s = 0; s < spans.size(); ++s)
      if (z >= spans[s].from && z <= spans[s].to) return row->parts[s];
    return -1;
  }

  std::optional<ExactMeasure> planar(const Vector3& at) {
    const Plane whole = plane(0, search_.tolerance * size_, {});
    const int part = part_at(whole, at.y(), at.z());
    if (part < 0) return std::nullopt;
    Bounds found = nothing();
    widen(found, extent_.lower.x(), extent_.upper.x(), whole);
    ExactMeasure result;
    result.value = whole.numbers[part];
    result.error = whole.error;
    result.parts = static_cast<int>(whole.numbers.size());
    return finished(result, found);
  }

  /// Takes in where a plane has anything, and a step of lines beyond.
  void widen(Bounds& found, double from, double to, const Plane& plane) const {
    const double across = (extent_.upper.x() - extent_.lower.x()) / kFirst;
    const double along = (extent_.upper.y() - extent_.lower.y()) / first_lines();
    for (const Plane::Row& row : plane.rows) {
      if (row.parts.empty()) continue;
      found.lower = found.lower.cwiseMin(Vector3(from - across, row.a - along, found.lower.z()));
      found.upper = found.upper.cwiseMax(Vector3(to + across, row.b + along, found.upper.z()));
    }
  }

  /// Nothing yet, in the frame of the lines.
  [[nodiscard]] Bounds nothing() const {
    Bounds found{extent_.upper, extent_.lower};
    std::swap(found.lower.z(), found.upper.z());
    return found;
  }

  ExactMeasure finished(ExactMeasure measure, const Bounds& found) const {
    measure.extent = {found.lower.cwiseMax(extent_.lower), found.upper.cwiseMin(extent_.upper)};
    measure.lines = lines_;
    measure.reached = !spent() && measure.error <= search_.tolerance * measure.value;
    return measure;
  }

  std::optional<ExactMeasure> spatial(const Vector3& inside) {
    const double low = extent_.lower.x(), range = extent_.upper.x() - low;
    const double tolerance = search_.tolerance * size_;
    const auto at = [&](double x, const Plane& before, const Plane& after) {
      std::vector<double> hints;
      for (const Plane* near : {&before, &after})
        for (const Strip& strip : near->strips) hints.push_back(strip.y);
      return plane(x, tolerance / range / kShare, hints);
    };
    using PlanePieces = Pieces<Plane, decltype(at)>;
    std::vector<typename PlanePieces::Mark> first(kFirst + 1);
    tbb::parallel_for(0, kFirst + 1, [&](int i) {
      const double x = low + range * i / kFirst;
      first[i] = {x, at(x, {}, {})};
    });
    // Stretches of planes, for the threads; each starts where the one before ended.
    std::vector<std::vector<typename PlanePieces::Mark>> stretches(1);
    for (std::size_t i = 0; i < first.size(); ++i) {
      stretches.back().push_back(first[i]);
      if (i > 0 && i + 1 < first.size() && stretches.back().size() > kFirst / 8) {
        stretches.push_back({first[i]});
      }
    }
    std::vector<PlanePieces> pieces(stretches.size(), PlanePieces(at, range, tolerance));
    tbb::parallel_for(std::size_t{0}, stretches.size(), [&](std::size_t i) {
      pieces[i].run(stretches[i]);
      pieces[i].finish();
    });
    ExactMeasure result;
    std::vector<const Leaf<Plane>*> leaves;
    for (const PlanePieces& each : pieces) {
      result.error += each.error;
      for (const auto& leaf : each.leaves) leaves.push_back(&leaf);
    }
    if (spent()) return std::nullopt;
    Groups groups;
    std::vector<std::vector<int>> numbers;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      numbers.emplace_back();
      for (std::size_t c = 0; c < leaves[i]->integrals.size(); ++c)
        numbers.back().push_back(groups.add());
      if (i == 0 || leaves[i]->a - leaves[i - 1]->b > kNear * range) continue;
      const Plane &before = leaves[i - 1]->right, &after = leaves[i]->left;
      if (before.pattern == after.pattern) {
        for (std::size_t c = 0; c < numbers[i].size(); ++c)
          groups.join(numbers[i - 1][c], numbers[i][c]);
        continue;
      }
      for (const Strip& strip : before.strips)
        if (const int part = part_at(after, strip.y, strip.z); part >= 0)
          groups.join(numbers[i - 1][strip.part], numbers[i][part]);
      for (const Strip& strip : after.strips)
        if (const int part = part_at(before, strip.y, strip.z); part >= 0)
          groups.join(numbers[i - 1][part], numbers[i][strip.part]);
    }
    // The leaf at the place, or the nearer of those beside the gap that it is in.
    const auto at_inside = [&](const Leaf<Plane>* leaf) {
      return std::clamp(inside.x(), leaf->a, leaf->b);
    };
    const auto home = std::ranges::min_element(leaves, {}, [&](const Leaf<Plane>* leaf) {
      return std::abs(inside.x() - at_inside(leaf));
    });
    if (home == leaves.end()) return std::nullopt;
    const Plane here = at(at_inside(*home), (*home)->left, (*home)->right);
    const int part = part_at(here, inside.y(), inside.z());
    const auto& known = numbers[static_cast<std::size_t>(home - leaves.begin())];
    if (part < 0 || part >= static_cast<int>(known.size())) return std::nullopt;
    const int own = groups.root(known[part]);
    std::vector<int> parts;
    for (std::size_t i = 0; i < leaves.size(); ++i)
      for (std::size_t c = 0; c < numbers[i].size(); ++c) {
        const int root = groups.root(numbers[i][c]);
        if (std::ranges::find(parts, root) == parts.end()) parts.push_back(root);
        if (root == own) result.value += leaves[i]->integrals[c];
      }
    // Every plane was known to its own tolerance.
    result.error += tolerance / kShare;
    result.parts = static_cast<int>(parts.size());
    Bounds found = nothing();
    for (const auto* leaf : leaves)
      for (const Plane* plane : {&leaf->left, &leaf->middle, &leaf->right})
        widen(found, leaf->a, leaf->b, *plane);
    return finished(result, found);
  }

  static constexpr double kNear = 1e-2;  // of the range: leaves nearer than this may be joined

  const LineLimits& limits_;
  Bounds extent_;
  double size_;
  ExactSearch search_;
  mutable std::atomic<std::size_t> lines_ = 0;
};

}  // namespace

std::optional<ExactMeasure> measure_exactly(const LineLimits& limits, const Vector3& inside,
                                            const Bounds& extent, double size,
                                            const ExactSearch& search) {
  // Lines laid far too widely miss tips, and a size guessed too large asks for too little: both are
  // put right by what is found, first by a look that asks for little itself.
  constexpr int kTurns = 5;
  constexpr double kLook = 1e-3;  // its tolerance
  Bounds where = extent;
  std::optional<ExactMeasure> measure;
  for (int turn = 0; turn < kTurns; ++turn) {
    ExactSearch asked = search;
    if (turn == 0) asked.tolerance = std::max(kLook, search.tolerance);
    measure = Measurer(limits, where, size, asked).run(inside);
    if (!measure || !(measure->value > 0) || measure->lines > search.lines) break;
    const Vector3 wide = where.upper - where.lower;
    const Vector3 found = measure->extent.upper - measure->extent.lower;
    const bool tight = found.x() >= wide.x() / 2 && found.y() >= wide.y() / 2;
    const bool final = asked.tolerance == search.tolerance;
    if (final && tight && (measure->reached || measure->value >= size)) break;
    size = std::min(size, measure->value);
    if (!tight) where = measure->extent;
  }
  return measure;
}

}  // namespace polyglide
