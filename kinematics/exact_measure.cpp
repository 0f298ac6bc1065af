#include "kinematics/exact_measure.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

namespace polyglide {
namespace {

/// Gauss–Kronrod 7/15 on [-1, 1] (QUADPACK, Piessens et al. 1983).
constexpr std::array<double, 8> kNodes{
    0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
    0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
    0.586087235467691130294144691693,    0.405845151377397166906606412076961,
    0.207784955007898467600689403773245, 0.0};
constexpr std::array<double, 8> kKronrod{
    0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
    0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
    0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
    0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
constexpr std::array<double, 4> kGauss{
    0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
    0.381830050505118944950369775488975, 0.417959183673469387755102040816327};

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

/// A function whose value at a place is a few numbers and a pattern; where the pattern is the same,
/// the numbers belong together and are smooth.
template <typename Sample>
struct Leaf {
  double a = 0, b = 0;
  Sample left, right, middle;
  std::vector<double> integrals;  // per number, with half of the gaps beside
  double error = 0;
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

double total(const std::vector<double>& numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), 0.0);
}

/// Cuts [a, b] where the pattern changes, and integrates between the cuts.
template <typename Sample, typename Function>
class Pieces {
 public:
  Pieces(const Function& function, double range, double tolerance)
      : function_(function), range_(range), tolerance_(tolerance) {}

  /// A place and the sample there.
  struct Mark {
    double at;
    Sample sample;
  };

  /// Places in ascending order, the ends among them.
  void run(const std::vector<Mark>& marks, int depth = 0) {
    // Bisection where neighbours differ, so that runs of one pattern and the gaps between are left.
    std::vector<Mark> fine{marks.front()};
    for (std::size_t i = 1; i < marks.size(); ++i) {
      separate(fine, marks[i], depth);
      fine.push_back(marks[i]);
    }
    for (std::size_t i = 0; i < fine.size();) {
      std::size_t j = i;
      while (j + 1 < fine.size() && fine[j + 1].sample.pattern == fine[i].sample.pattern) ++j;
      if (j > i) piece(fine[i], fine[j], depth);
      if (j + 1 < fine.size()) add_gap(fine[j], fine[j + 1]);
      i = j + 1;
    }
  }

  /// To be called after the last run().
  void finish() {
    if (half_gap_ > 0) add_point(gap_end_, after_gap_, 0);
  }

  std::vector<Leaf<Sample>> leaves;
  double error = 0;

 private:
  static constexpr int kDeepest = 60;

  /// What a trapezium makes wrong of a kink, or of a jump.
  double doubt(const Mark& a, const Mark& b) const {
    const double before = total(a.sample.numbers), after = total(b.sample.numbers);
    const double width = b.at - a.at;
    return width * (std::abs(before - after) + 0.02 * width / range_ * (before + after));
  }

  /// Appends what has to be known between the last mark and the next.
  void separate(std::vector<Mark>& fine, const Mark& next, int depth) {
    const Mark last = fine.back();
    if (last.sample.pattern == next.sample.pattern || doubt(last, next) < tolerance_ / 100 ||
        next.at - last.at < 4e-15 * (std::abs(last.at) + std::abs(next.at)) || depth > kDeepest)
      return;
    const double middle = last.at + (next.at - last.at) / 2;
    const Mark between{middle, function_(middle, last.sample, next.sample)};
    separate(fine, between, depth + 1);
    fine.push_back(between);
    separate(fine, next, depth + 1);
  }

  /// Each half of a gap goes to its side: to the leaf there, or to one of no width.
  void add_gap(const Mark& from, const Mark& to) {
    const auto& [a, left] = from;
    const auto& [b, right] = to;
    error += doubt(from, to);
    if (half_gap_ == 0 && !leaves.empty() && leaves.back().right.pattern == left.pattern)
      add_half(leaves.back(), left, (b - a) / 2);
    else
      add_point(a, left, (b - a) / 2);
    half_gap_ = (b - a) / 2;
    gap_end_ = b;
    after_gap_ = right;
  }

  static void add_half(Leaf<Sample>& leaf, const Sample& sample, double width) {
    for (std::size_t i = 0; i < sample.numbers.size(); ++i)
      leaf.integrals[i] += width * sample.numbers[i];
  }

  void add_point(double at, const Sample& sample, double width) {
    Leaf<Sample> leaf{at, at, sample, sample, sample, {}, 0};
    leaf.integrals.assign(sample.numbers.size(), 0.0);
    add_half(leaf, sample, width + half_gap_);
    half_gap_ = 0;
    leaves.push_back(std::move(leaf));
  }

  void piece_or_run(const Mark& from, const Mark& to, int depth) {
    if (from.sample.pattern == to.sample.pattern)
      piece(from, to, depth);
    else
      run({from, to}, depth);
  }

  void piece(const Mark& from, const Mark& to, int depth) {
    const auto& [a, left] = from;
    const auto& [b, right] = to;
    const std::size_t count = left.numbers.size();
    Leaf<Sample> leaf{a, b, left, right, {}, std::vector<double>(count, 0.0), 0};
    const double width = b - a;
    std::vector<double> gauss(count, 0.0);
    std::array<double, 15> totals{}, weights{};
    for (int i = 0; i < 15; ++i) {
      const int k = i < 8 ? i : 14 - i;
      // s(3 - 2s)s is level at both ends, so that square roots there become smooth.
      const double s = (1 + (i < 8 ? -kNodes[k] : kNodes[k])) / 2;
      const double at = a + width * s * s * (3 - 2 * s);
      Sample sample = function_(at, left, right);
      if (sample.pattern != left.pattern) {
        if (at > a && at < b) run({from, {at, std::move(sample)}, to}, depth + 1);
        return;
      }
      const double speed = 3 * s * (1 - s) * width;  // half of 6 s (1 - s)
      for (std::size_t c = 0; c < count; ++c) {
        leaf.integrals[c] += kKronrod[k] * speed * sample.numbers[c];
        if (k % 2 == 1) gauss[c] += kGauss[k / 2] * speed * sample.numbers[c];
      }
      totals[i] = speed * total(sample.numbers);
      weights[i] = kKronrod[k];
      if (i == 7) leaf.middle = std::move(sample);
    }
    const double mean = total(leaf.integrals) / 2;
    double spread = 0;
    for (int i = 0; i < 15; ++i) spread += weights[i] * std::abs(totals[i] - mean);
    double difference = 0;
    for (std::size_t c = 0; c < count; ++c) difference += std::abs(leaf.integrals[c] - gauss[c]);
    leaf.error =
        spread > 0 ? spread * std::min(1.0, std::pow(200 * difference / spread, 1.5)) : difference;
    const double allowed = tolerance_ / 8 * std::max(std::sqrt(width / range_), 0.02);
    if (leaf.error > allowed && depth < kDeepest && width > 1e-9 * range_) {
      const Mark middle{a + width / 2, function_(a + width / 2, left, right)};
      piece_or_run(from, middle, depth + 1);
      piece_or_run(middle, to, depth + 1);
      return;
    }
    if (half_gap_ > 0) add_half(leaf, after_gap_, half_gap_);
    half_gap_ = 0;
    error += leaf.error;
    leaves.push_back(std::move(leaf));
  }

  const Function& function_;
  double range_, tolerance_;
  double half_gap_ = 0, gap_end_ = 0;  // of the last gap, not yet given to a leaf
  Sample after_gap_;
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
  static constexpr double kShare = 8;  // part of the tolerance that planes take
  static constexpr int kFirst = 64;    // planes to begin with

  /// Lines in each plane to begin with: what is thinner than they are apart is missed, and at the
  /// finest tolerances that shows.
  [[nodiscard]] int first_lines() const { return search_.tolerance < 1e-6 ? 320 : 160; }

  Line line(double x, double y) const {
    Line result;
    limits_.spans(x, y, result.spans);
    ++lines_;
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
  // put right by what was found.
  constexpr int kTurns = 5;
  Bounds where = extent;
  std::optional<ExactMeasure> measure;
  for (int turn = 0; turn < kTurns; ++turn) {
    measure = Measurer(limits, where, size, search).run(inside);
    if (!measure || !(measure->value > 0) || measure->lines > search.lines) break;
    const Vector3 wide = where.upper - where.lower;
    const Vector3 found = measure->extent.upper - measure->extent.lower;
    const bool tight = found.x() >= wide.x() / 2 && found.y() >= wide.y() / 2;
    if (tight && (measure->reached || measure->value >= size)) break;
    size = std::min(size, measure->value);
    where = measure->extent;
  }
  return measure;
}

}  // namespace polyglide
