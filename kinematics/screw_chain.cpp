#include "kinematics/screw_chain.hpp"

namespace polyglide {
namespace {

IntervalVector operator+(const IntervalVector& a, const IntervalVector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

IntervalVector operator*(const Interval& factor, const IntervalVector& a) {
  return {factor * a[0], factor * a[1], factor * a[2]};
}

IntervalVector between(const Vector3& from, const Vector3& to) {
  return {Interval(to[0]) - from[0], Interval(to[1]) - from[1], Interval(to[2]) - from[2]};
}

IntervalRotation transposed(const IntervalRotation& r) {
  IntervalRotation result;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) result[i][j] = r[j][i];
  return result;
}

}  // namespace

ScrewChain joint_chain(const Model& model, int joint, const Posture& posture) {
  const Joint& data = model.mechanism.joints[joint];
  const int first = model.first_freedom[joint];
  ScrewChain chain;
  if (data.type == JointType::spherical) {
    for (int i : {2, 1, 0}) {
      ScrewFactor& factor = chain.emplace_back();
      factor.variable = first + i;
      factor.axis = vector_of(Vector3::Unit(i));
      factor.point = data.at;
    }
    const Eigen::Quaterniond& ball = posture.balls[joint];
    if (ball.vec().isZero(0)) return chain;
    chain.emplace_back().point = data.at;
    chain.back().fixed = rotation_of(ball);
    return chain;
  }
  for (int i = 0; i < freedoms(data.type); ++i) {
    const Freedom& freedom = model.freedoms[first + i];
    ScrewFactor& factor = chain.emplace_back();
    factor.variable = first + i;
    factor.translational = freedom.translational;
    factor.coordinate = posture.q[first + i];
    // Whole turns change nothing, unless the joint is a screw.
    if (!factor.translational && data.type != JointType::helical)
      factor.coordinate = std::remainder(factor.coordinate, 2 * M_PI);
    if (factor.translational) {
      factor.axis = vector_of(freedom.screw.tail<3>());
      continue;
    }
    factor.axis = unit_axis(freedom.screw.head<3>());
    factor.point = data.at;
    if (data.type == JointType::helical)
      factor.pitch = dot(factor.axis, vector_of(freedom.screw.tail<3>()));
  }
  return chain;
}

ScrewChain inverse(ScrewChain chain) {
  std::reverse(chain.begin(), chain.end());
  for (ScrewFactor& factor : chain) {
    factor.sign = -factor.sign;
    if (factor.variable < 0) factor.fixed = transposed(factor.fixed);
  }
  return chain;
}

ScrewChain chain_of(const Model& model, const std::vector<LoopStep>& steps,
                    const Posture& posture) {
  ScrewChain chain;
  for (const auto& [joint, sign] : steps) {
    ScrewChain part = joint_chain(model, joint, posture);
    if (sign < 0) part = inverse(std::move(part));
    chain.insert(chain.end(), part.begin(), part.end());
  }
  return chain;
}

void carry(const ScrewChain& chain, const Vector3& point, const std::vector<Interval>& box,
           double size, Carried& result) {
  result.rotation = no_rotation();
  result.shift = {0.0, 0.0, 0.0};
  result.screws.clear();
  // Per factor the way from its axis to the next, where the factors so far have carried it.
  thread_local std::vector<IntervalVector> ways;
  ways.clear();
  std::vector<CarriedScrew>& screws = result.screws;
  const auto next_point = [&](std::size_t i) -> Vector3 {
    for (++i; i < chain.size(); ++i)
      if (!chain[i].translational) return chain[i].point;
    return point;
  };
  const bool turns_first = !chain.empty() && !chain[0].translational;
  const Vector3 first = turns_first ? chain[0].point : next_point(0);
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const ScrewFactor& factor = chain[i];
    IntervalVector way{0.0, 0.0, 0.0};
    if (factor.variable >= 0) {
      const IntervalVector axis = Interval(factor.sign) * turned(result.rotation, factor.axis);
      Interval q = box[factor.variable];
      if (factor.translational) q *= size;
      q += factor.coordinate;
      screws.push_back({factor.variable, factor.translational, axis, axis});
      if (factor.translational) {
        way = q * axis;
      } else {
        way = q * factor.pitch * axis;
        result.rotation = product(
            result.rotation, rotation_about(factor.axis, static_cast<double>(factor.sign) * q));
      }
    } else {
      result.rotation = product(result.rotation, factor.fixed);
    }
    if (!factor.translational) {
      const Vector3 next = next_point(i);
      way = way + turned(result.rotation, between(factor.point, next));
    }
    ways.push_back(way);
  }
  // Backwards: the lever from each axis to the point.
  IntervalVector lever{0.0, 0.0, 0.0};
  std::size_t screw = screws.size();
  for (std::size_t i = chain.size(); i-- > 0;) {
    lever = lever + ways[i];
    if (chain[i].variable < 0) continue;
    CarriedScrew& moved = screws[--screw];
    if (moved.translational) {
      moved.w = {0.0, 0.0, 0.0};
      continue;
    }
    moved.v = cross(moved.w, lever) + chain[i].pitch * moved.w;
  }
  result.shift = lever + between(point, first);
}

void enclose_loop(const ScrewLoop& loop, const std::vector<Interval>& box, double size,
                  const std::vector<int>& columns, int row, Enclosure& result) {
  thread_local Carried out, back;
  carry(loop.out, loop.point, box, size, out);
  carry(loop.back, loop.point, box, size, back);
  // What is left of the rotation, and by whose rate of turn it changes: d(R) = ŵ R - R ŵ.
  const IntervalRotation r = product(out.rotation, transposed(back.rotation));
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    result.values[row + i] = (r[k][j] - r[j][k]) / 2.0;
    result.values[row + 3 + i] = (out.shift[i] - back.shift[i]) / size;
  }
  for (const bool outward : {true, false})
    for (const auto& [variable, translational, w, v] : outward ? out.screws : back.screws) {
      const int column = columns[variable];
      if (column < 0) continue;
      const double sign = outward ? 1 : -1;
      const Interval scale = translational ? Interval(sign) : sign / Interval(size);
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const Interval &by_j = outward ? r[i][j] : r[j][i], &by_k = outward ? r[i][k] : r[k][i];
        if (!translational)
          result.jacobian(row + i, column) +=
              sign * (w[i] * (r[j][j] + r[k][k]) - w[j] * by_j - w[k] * by_k) / 2.0;
        result.jacobian(row + 3 + i, column) += scale * v[i];
      }
    }
}

}  // namespace polyglide
