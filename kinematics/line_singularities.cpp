#include <algorithm>
#include <cmath>

#include "kinematics/line_limits.hpp"
#include "kinematics/real_roots.hpp"

// Where a line crosses det J = 0.
namespace polyglide {
namespace {

/// Where a function whose values at a < b < c have one sign, b's the least, has the other sign
/// between.
struct Turn {
  double at, value;
};

/// By parabolas through three points; nullopt when the turn stays on its side.
template <typename Function>
std::optional<Turn> crossed_turn(const Function& f, double a, double fa, double b, double fb,
                                 double c, double fc) {
  const double sign = fb < 0 ? -1 : 1;
  fa *= sign, fb *= sign, fc *= sign;
  if (!(fb < fa && fb < fc)) return std::nullopt;
  for (int i = 0; i < 8; ++i) {
    const double p = (b - a) * (fb - fc), q = (b - c) * (fb - fa);
    const double lowest = b - ((b - a) * p - (b - c) * q) / (2 * (p - q));
    if (!(lowest > a && lowest < c) || std::abs(lowest - b) < 1e-9 * (c - a)) return std::nullopt;
    const double value = f(lowest), here = sign * value;
    if (here < 0) return Turn{lowest, value};
    if (here < fb) {
      (lowest < b ? c : a) = b;
      (lowest < b ? fc : fa) = fb;
      b = lowest;
      fb = here;
    } else {
      (lowest < b ? a : c) = lowest;
      (lowest < b ? fa : fc) = here;
    }
  }
  return std::nullopt;
}

}  // namespace

double LineLimits::determinant(const Vector3& place) const {
  const auto n = static_cast<Eigen::Index>(axes_.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> rows(n, n);
  for (Eigen::Index d = 0; d < n; ++d) {
    const Rod& rod = drives_[d];
    const Vector3 force = solve(rod, place).rod / rod.length;
    const Vector3 moment = rod.arm.cross(force) / scale_;
    for (Eigen::Index k = 0; k < n; ++k)
      rows(d, k) = axes_[k] < 3 ? force[axes_[k]] : moment[axes_[k] - 3];
  }
  return n == 3 ? Eigen::Matrix3d(rows).determinant() : rows.determinant();
}

bool LineLimits::keep_side_of(const Vector3& place) {
  if (drives_.size() != axes_.size()) return false;
  const double at = determinant(place);
  if (!(std::abs(at) > 1e-12)) return false;
  side_ = at > 0 ? 1 : -1;
  return true;
}

void LineLimits::cut_at_singularities(const Vector3& start, std::vector<Span>& spans) const {
  const Vector3 way = frame_.col(2);
  const auto at = [&](double z) { return side_ * determinant(start + z * way); };
  thread_local std::vector<Span> kept;
  kept.clear();
  for (const Span& span : spans) {
    // Closer at the ends, where the rise of a rod may go with the root of the distance.
    constexpr int kSamples = 16;
    const auto place = [&](double i) {
      return span.from + (span.to - span.from) * (1 - std::cos(M_PI * i / kSamples)) / 2;
    };
    std::array<double, kSamples + 1> z, f;
    for (int i = 0; i <= kSamples; ++i) f[i] = at(z[i] = place(i));
    std::array<double, 2 * kSamples> roots;
    int count = 0;
    for (int i = 0; i < kSamples; ++i) {
      if ((f[i] < 0) != (f[i + 1] < 0)) {
        roots[count++] = zero_between(at, z[i], z[i + 1], f[i], f[i + 1]);
        continue;
      }
      if (i == 0 || (f[i - 1] < 0) != (f[i] < 0)) continue;
      // A turn towards zero between samples of one sign may cross it twice.
      const auto turn = crossed_turn(at, z[i - 1], f[i - 1], z[i], f[i], z[i + 1], f[i + 1]);
      if (!turn) continue;
      roots[count++] = zero_between(at, z[i - 1], turn->at, f[i - 1], turn->value);
      roots[count++] = zero_between(at, turn->at, z[i + 1], turn->value, f[i + 1]);
    }
    std::sort(roots.begin(), roots.begin() + count);
    double from = span.from;
    int first = span.first;
    for (int i = 0; i <= count; ++i) {
      const double to = i < count ? roots[i] : span.to;
      if (to - from > kTouch * size_ && at((from + to) / 2) > 0)
        kept.push_back({from, to, first, i < count ? kSingular : span.last});
      from = to;
      first = kSingular;
    }
  }
  spans.swap(kept);
}

}  // namespace polyglide
