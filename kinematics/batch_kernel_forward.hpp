#pragma once

#include "kinematics/batch_kernel_legs.hpp"
#include "kinematics/singular_values.hpp"

/// Forward kinematics of a pack of drive positions by Newton's method.
namespace polyglide::batch::detail {

/// The legs that give the drives, with the drives put in: the platform joint of leg d is
/// to be where |t + shift + R·arm| = target.
template <class V>
struct Targets {
  const LegData* legs[kMostDrives];
  Vec<V> shift[kMostDrives];
  V square[kMostDrives];  ///< target²
};

template <class V>
inline Targets<V> targets_of(const KernelModel& model, const ForwardColumns& io, int i) {
  Targets<V> targets;
  for (const LegData& leg : model.legs) {
    if (!leg.primary) continue;
    const int d = leg.drive;
    const V q = Lanes<V>::load(io.drives + d * io.stride + i);
    V length(leg.length);
    Vec<V> shift = spread<V>(leg.shift);
    if (leg.kind == LegKind::strut) {
      length = length + q;
    } else if (leg.kind == LegKind::guide_rod) {
      shift = shift + scaled(spread<V>(leg.direction), V(0) - q);
    } else {
      V sine, cosine;
      simd::sincos(q, sine, cosine);
      shift = shift + scaled(spread<V>(leg.outward), V(-leg.radius) * cosine) +
              scaled(spread<V>(leg.onward), V(-leg.radius) * sine);
    }
    targets.legs[d] = &leg;
    targets.shift[d] = shift;
    targets.square[d] = length * length;
  }
  return targets;
}

template <class V>
struct Guess {
  Vec<V> t;
  V w, x, y, z;  ///< quaternion
};

/// Rows of ½∂|v|² and errors ½(|v|² - target²); returns the greatest, relative to target².
template <class V, int N>
inline V leg_errors(const KernelModel& model, const Targets<V>& targets, const Guess<V>& guess,
                    V (&rows)[kMostDrives][6], V (&errors)[kMostDrives]) {
  const Rotation<V> rotation = rotation_of<V>(guess.w, guess.x, guess.y, guess.z);
  V worst(0), sum(0);
  for (int d = 0; d < model.drives; ++d) {
    const Vec<V> arm = rotation(targets.legs[d]->arm);
    const Vec<V> v = guess.t + targets.shift[d] + arm;
    errors[d] = V(0.5) * (dot(v, v) - targets.square[d]);
    rows[d][0] = v.x, rows[d][1] = v.y, rows[d][2] = v.z;
    if (model.moments) {
      const Vec<V> moment = scaled(cross(arm, v), V(model.scale));
      rows[d][3] = moment.x, rows[d][4] = moment.y, rows[d][5] = moment.z;
    }
    const V error = abs(errors[d]) / (targets.square[d] + V(kTiny));
    worst = max(worst, error);
    sum = sum + error;
  }
  // Not-a-number must win.
  worst = select(MaskOf<V>(sum - sum == V(0)), worst, sum);
  return worst;
}

/// One step of Newton's method on the normal equations, zero in lanes that are done.
template <class V, int N>
inline void newton_step(const KernelModel& model, const V (&rows)[kMostDrives][6],
                        const V (&errors)[kMostDrives], const MaskOf<V>& done, Guess<V>& guess) {
  V gram[N][N], right[N];
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k) {
    right[k] = V(0);
#pragma GCC unroll 8
    for (int l = 0; l <= k; ++l) gram[k][l] = V(0);
  }
  for (int d = 0; d < model.drives; ++d) {
    V row[N];
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) row[k] = rows[d][N == 6 ? k : model.axes[k]];
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) {
      right[k] = right[k] + row[k] * errors[d];
#pragma GCC unroll 8
      for (int l = 0; l <= k; ++l) gram[k][l] = gram[k][l] + row[k] * row[l];
    }
  }
  simd::factorise<V, N>(gram);
  simd::solve_factorised<V, N>(gram, right);
  V step[6]{V(0), V(0), V(0), V(0), V(0), V(0)};
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k)
    step[N == 6 ? k : model.axes[k]] = select(done, V(0), V(0) - right[k]);
  guess.t = guess.t + Vec<V>{step[0], step[1], step[2]};
  if (!model.moments) return;
  // The quaternion of a small turn is (1, half of it) as near as Newton's method needs.
  const V half(0.5 * model.scale);
  const V a = half * step[3], b = half * step[4], c = half * step[5];
  const V w = guess.w - a * guess.x - b * guess.y - c * guess.z;
  const V x = guess.x + a * guess.w + b * guess.z - c * guess.y;
  const V y = guess.y + b * guess.w + c * guess.x - a * guess.z;
  const V z = guess.z + c * guess.w + a * guess.y - b * guess.x;
  const V scale = V(1) / sqrt(w * w + x * x + y * y + z * z);
  guess.w = w * scale, guess.x = x * scale, guess.y = y * scale, guess.z = z * scale;
}

template <class V, int N>
void run_forward(const KernelModel& model, const ForwardColumns& io, int count) {
  constexpr int kSteps = 15;
  constexpr double kAccurate = 1e-14;
  V rows[kMostDrives][6], errors[kMostDrives];
  for (int i = 0; i < count; i += Lanes<V>::count) {
    const Targets<V> targets = targets_of<V>(model, io, i);
    const auto load = [i](const double* column) { return Lanes<V>::load(column + i); };
    Guess<V> guess{{load(io.x), load(io.y), load(io.z)},
                   load(io.quaternion[0]),
                   load(io.quaternion[1]),
                   load(io.quaternion[2]),
                   load(io.quaternion[3])};
    V worst = leg_errors<V, N>(model, targets, guess, rows, errors);
    for (int step = 0; step < kSteps; ++step) {
      const auto done = MaskOf<V>(!(worst > V(kAccurate)));
      if (!any(!done)) break;
      newton_step<V, N>(model, rows, errors, done, guess);
      worst = leg_errors<V, N>(model, targets, guess, rows, errors);
    }
    Lanes<V>::store(io.x + i, guess.t.x);
    Lanes<V>::store(io.y + i, guess.t.y);
    Lanes<V>::store(io.z + i, guess.t.z);
    const V* parts[4]{&guess.w, &guess.x, &guess.y, &guess.z};
    for (int k = 0; k < 4; ++k) Lanes<V>::store(io.quaternion[k] + i, *parts[k]);
    Lanes<V>::store(io.residual + i, worst);
  }
}
}  // namespace polyglide::batch::detail
