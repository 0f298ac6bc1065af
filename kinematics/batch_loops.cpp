#include "kinematics/batch_loops.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/condition.hpp"

// GCC's -O2 vectorises next to nothing. Sanitizers cannot start before the
// resolvers that choose a clone have run.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && \
    !defined(__SANITIZE_ADDRESS__)
#define POLYGLIDE_VECTORISED \
  __attribute__((optimize("O3", "no-math-errno"), target_clones("default", "arch=x86-64-v3")))
#else
#define POLYGLIDE_VECTORISED
#endif

namespace polyglide::batch {
namespace {

constexpr double kTiny = 1e-300;  // keeps 0/0 out of branch-free code

}  // namespace

POLYGLIDE_VECTORISED
void solve_rod(int count, const double* __restrict x, const double* __restrict y,
               const double* __restrict z, const Rod& rod, double* __restrict place,
               double* __restrict along, double* __restrict code) {
  const Vector a = rod.offset, g = rod.guide;
  const double square = rod.length * rod.length, side = rod.side, scale = 1 / rod.length;
  const double reach = rod.reach_code;
  double *ux = along, *uy = ux + kStride, *uz = uy + kStride;
  for (int i = 0; i < count; ++i) {
    const double vx = a.x + x[i], vy = a.y + y[i], vz = a.z + z[i];
    const double s = vx * g.x + vy * g.y + vz * g.z;
    const double px = vx - s * g.x, py = vy - s * g.y, pz = vz - s * g.z;
    const double left = square - (px * px + py * py + pz * pz);
    const double rise = side * std::sqrt(left > 0 ? left : 0);
    const double failed = left < 0 ? reach : -1;
    code[i] = code[i] < 0 ? failed : code[i];
    place[i] = s + rise;
    ux[i] = (px - rise * g.x) * scale;
    uy[i] = (py - rise * g.y) * scale;
    uz[i] = (pz - rise * g.z) * scale;
  }
}

POLYGLIDE_VECTORISED
void solve_strut(int count, const double* __restrict x, const double* __restrict y,
                 const double* __restrict z, const Strut& strut, double* __restrict place,
                 double* __restrict along, double* __restrict code) {
  const Vector a = strut.offset;
  const double length = strut.length, reach = strut.reach_code;
  double *ux = along, *uy = ux + kStride, *uz = uy + kStride;
  for (int i = 0; i < count; ++i) {
    const double vx = a.x + x[i], vy = a.y + y[i], vz = a.z + z[i];
    const double distance = std::sqrt(vx * vx + vy * vy + vz * vz);
    const double failed = distance > 0 ? -1 : reach;
    const double scale = 1 / (distance + kTiny);
    code[i] = code[i] < 0 ? failed : code[i];
    place[i] = distance - length;
    ux[i] = vx * scale;
    uy[i] = vy * scale;
    uz[i] = vz * scale;
  }
}

POLYGLIDE_VECTORISED
void check_range(int count, const double* __restrict place, double min, double min_code, double max,
                 double max_code, double* __restrict code) {
  for (int i = 0; i < count; ++i) {
    const double above = place[i] > max ? max_code : -1;
    const double failed = place[i] < min ? min_code : above;
    code[i] = code[i] < 0 ? failed : code[i];
  }
}

POLYGLIDE_VECTORISED
void check_agreement(int count, const double* __restrict place, const double* __restrict other,
                     double tolerance, double failure, double* __restrict code) {
  for (int i = 0; i < count; ++i) {
    const double failed = std::abs(place[i] - other[i]) > tolerance ? failure : -1;
    code[i] = code[i] < 0 ? failed : code[i];
  }
}

POLYGLIDE_VECTORISED
void check_cone(int count, const double* __restrict along, Vector axis, double cosine,
                double failure, double* __restrict code) {
  const double *ux = along, *uy = ux + kStride, *uz = uy + kStride;
  for (int i = 0; i < count; ++i) {
    const double failed = ux[i] * axis.x + uy[i] * axis.y + uz[i] * axis.z < cosine ? failure : -1;
    code[i] = code[i] < 0 ? failed : code[i];
  }
}

POLYGLIDE_VECTORISED
void check_plane(int count, const double* __restrict x, const double* __restrict y,
                 const double* __restrict z, Vector normal, const double* __restrict place,
                 double slope, double offset, double failure, double* __restrict code) {
  for (int i = 0; i < count; ++i) {
    const double height = normal.x * x[i] + normal.y * y[i] + normal.z * z[i] + slope * place[i];
    const double failed = height > offset ? failure : -1;
    code[i] = code[i] < 0 ? failed : code[i];
  }
}

POLYGLIDE_VECTORISED
void rod_row(int count, const double* __restrict along, Vector g, double* __restrict row) {
  const double *ux = along, *uy = ux + kStride, *uz = uy + kStride;
  double *jx = row, *jy = jx + kStride, *jz = jy + kStride;
  for (int i = 0; i < count; ++i) {
    const double gain = 1 / (ux[i] * g.x + uy[i] * g.y + uz[i] * g.z);
    jx[i] = ux[i] * gain;
    jy[i] = uy[i] * gain;
    jz[i] = uz[i] * gain;
  }
}

POLYGLIDE_VECTORISED
void condition3(int count, int rows, const double* __restrict entries, double* __restrict inverse) {
  double xx[kStride], xy[kStride], xz[kStride], yy[kStride], yz[kStride], zz[kStride];
  for (int i = 0; i < count; ++i) xx[i] = xy[i] = xz[i] = yy[i] = yz[i] = zz[i] = 0;
  for (int row = 0; row < rows; ++row) {
    const double *x = entries + 3 * row * kStride, *y = x + kStride, *z = y + kStride;
    for (int i = 0; i < count; ++i) {
      xx[i] += x[i] * x[i];
      xy[i] += x[i] * y[i];
      xz[i] += x[i] * z[i];
      yy[i] += y[i] * y[i];
      yz[i] += y[i] * z[i];
      zz[i] += z[i] * z[i];
    }
  }
  for (int i = 0; i < count; ++i)
    inverse[i] = inverse_condition(xx[i], xy[i], xz[i], yy[i], yz[i], zz[i]);
}

POLYGLIDE_VECTORISED
void determinant3(int count, const double* __restrict entries, double* __restrict determinant) {
  const double *a = entries, *b = a + kStride, *c = b + kStride;
  const double *d = c + kStride, *e = d + kStride, *f = e + kStride;
  const double *g = f + kStride, *h = g + kStride, *k = h + kStride;
  for (int i = 0; i < count; ++i)
    determinant[i] = a[i] * (e[i] * k[i] - f[i] * h[i]) - b[i] * (d[i] * k[i] - f[i] * g[i]) +
                     c[i] * (d[i] * h[i] - e[i] * g[i]);
}

/// Clears entry (p, q): the smaller root of the rotation's tangent, without cancellation.
POLYGLIDE_VECTORISED
static void rotate_pivot(double* __restrict pp, double* __restrict qq, double* __restrict pq,
                         double* __restrict cosine, double* __restrict sine) {
  for (int i = 0; i < kLanes; ++i) {
    const double half = (qq[i] - pp[i]) / 2, off = pq[i];
    const double root = std::sqrt(half * half + off * off) + kTiny;
    const double t = off / (half + std::copysign(root, half));
    const double c = 1 / std::sqrt(1 + t * t);
    cosine[i] = c;
    sine[i] = t * c;
    pp[i] -= t * off;
    qq[i] += t * off;
    pq[i] = 0;
  }
}

POLYGLIDE_VECTORISED
static void rotate_rest(double* __restrict rp, double* __restrict rq,
                        const double* __restrict cosine, const double* __restrict sine) {
  for (int i = 0; i < kLanes; ++i) {
    const double a = rp[i], b = rq[i];
    rp[i] = cosine[i] * a - sine[i] * b;
    rq[i] = sine[i] * a + cosine[i] * b;
  }
}

POLYGLIDE_VECTORISED
void condition_n(int n, Grams& grams, double* __restrict inverse) {
  constexpr int kSweeps = 6;
  auto& m = grams.entry;
  double cosine[kLanes], sine[kLanes];
  // Entry (i, j) of the symmetric matrix, kept in the upper triangle.
  const auto at = [&m](int i, int j) -> double* { return i < j ? m[i][j] : m[j][i]; };
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int p = 0; p < n - 1; ++p)
      for (int q = p + 1; q < n; ++q) {
        rotate_pivot(m[p][p], m[q][q], m[p][q], cosine, sine);
        for (int r = 0; r < n; ++r) {
          if (r == p || r == q) continue;
          rotate_rest(at(r, p), at(r, q), cosine, sine);
        }
      }
  double smallest[kLanes], largest[kLanes];
  std::copy_n(m[0][0], kLanes, smallest);
  std::copy_n(m[0][0], kLanes, largest);
  for (int k = 1; k < n; ++k)
    for (int i = 0; i < kLanes; ++i) {
      smallest[i] = std::min(smallest[i], m[k][k][i]);
      largest[i] = std::max(largest[i], m[k][k][i]);
    }
  for (int i = 0; i < kLanes; ++i) {
    const double ratio = smallest[i] / (largest[i] + kTiny);
    inverse[i] = std::sqrt(ratio > 0 && ratio <= 1 ? ratio : 0);
  }
}

}  // namespace polyglide::batch
