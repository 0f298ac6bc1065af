#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

// Integrals of functions that are smooth but for kinks and gaps at places not known beforehand.
namespace polyglide {

/// Gauss–Kronrod 7/15 on [-1, 1] (QUADPACK, Piessens et al. 1983).
inline constexpr std::array<double, 8> kNodes{
    0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
    0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
    0.586087235467691130294144691693,    0.405845151377397166906606412076961,
    0.207784955007898467600689403773245, 0.0};
inline constexpr std::array<double, 8> kKronrod{
    0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
    0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
    0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
    0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
inline constexpr std::array<double, 4> kGauss{
    0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
    0.381830050505118944950369775488975, 0.417959183673469387755102040816327};

/// A piece [a, b] of a function whose value at a place is a Sample: a few `numbers` and a
/// `pattern`. Where the pattern is the same, the numbers belong together and are smooth.
template <typename Sample>
struct Leaf {
  double a = 0, b = 0;
  Sample left, right, middle;
  std::vector<double> integrals;  // per number, with half of the gaps beside
  double error = 0;
};

inline double sum_of(const std::vector<double>& numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), 0.0);
}

/// Cuts [a, b] where the pattern changes, and integrates between the cuts. What is narrower than
/// the marks given to run() are apart can be missed. Square roots at the cuts do no harm.
/// @param Function Sample (double at, const Sample& before, const Sample& after), where the samples
/// are those of the piece that the place is in.
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

  std::vector<Leaf<Sample>> leaves;  ///< ascending
  double error = 0;                  ///< estimate, of all leaves and of the gaps between

 private:
  static constexpr int kDeepest = 60;

  /// What a trapezium makes wrong of a kink, or of a jump.
  double doubt(const Mark& a, const Mark& b) const {
    const double before = sum_of(a.sample.numbers), after = sum_of(b.sample.numbers);
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
      totals[i] = speed * sum_of(sample.numbers);
      weights[i] = kKronrod[k];
      if (i == 7) leaf.middle = std::move(sample);
    }
    const double mean = sum_of(leaf.integrals) / 2;
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

}  // namespace polyglide
