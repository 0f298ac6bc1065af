#include "kinematics/screw_words.hpp"

#include <fmt/format.h>

#include "kinematics/rank.hpp"

namespace polyglide {
namespace {

std::string vector_text(const Vector3& v, double scale) {
  const auto tidy = [](double value) { return std::abs(value) < 5e-4 ? 0.0 : value; };
  return fmt::format("({:.3g}, {:.3g}, {:.3g})", tidy(v.x() * scale), tidy(v.y() * scale),
                     tidy(v.z() * scale));
}

/// Direction with its largest part positive, so that the same line reads the same.
Vector3 upright(const Vector3& direction) {
  int largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  return direction[largest] < 0 ? Vector3(-direction) : direction;
}

struct ScrewWords {
  const char *none, *moment, *line, *screw;
};

std::string describe(const Screw& screw, const ScrewWords& words) {
  const ScrewLine line = line_of(screw);
  if (line.kind == ScrewLine::Kind::none) return words.none;
  if (line.kind == ScrewLine::Kind::pure_moment)
    return fmt::format("{} {}", words.moment, vector_text(line.axis, 1));
  const std::string where =
      fmt::format("{} through {} mm", vector_text(line.axis, 1), vector_text(line.point, 1e3));
  if (line.kind == ScrewLine::Kind::line) return fmt::format("{} {}", words.line, where);
  return fmt::format("{} of pitch {:.3g} mm/rad about the axis along {}", words.screw,
                     line.pitch * 1e3, where);
}

/// Orthonormal basis of the column space, base axes first where they lie in it.
Eigen::Matrix3Xd plain_directions(const Eigen::MatrixXd& span, int rank) {
  const Eigen::MatrixXd space = svd_of(span).u.leftCols(rank);
  Eigen::Matrix3Xd basis(3, rank);
  int found = 0;
  const auto add = [&](Vector3 direction) {
    for (int i = 0; i < found; ++i) direction -= basis.col(i).dot(direction) * basis.col(i);
    if (found < rank && direction.norm() > 0.1) basis.col(found++) = direction.normalized();
  };
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 unit = Vector3::Unit(axis);
    if ((unit - space * (space.transpose() * unit)).norm() < 1e-6) add(unit);
  }
  for (int axis = 0; axis < 3; ++axis) add(space * (space.transpose() * Vector3::Unit(axis)));
  for (int i = 0; i < rank; ++i) add(space.col(i));
  return basis.leftCols(found);
}

}  // namespace

ScrewLine line_of(const Screw& screw) {
  const Vector3 axis_part = screw.head<3>(), moment = screw.tail<3>();
  const double strength = axis_part.norm();
  if (strength < 1e-9 * (1 + moment.norm())) {
    if (moment.norm() < 1e-12) return {};
    return {ScrewLine::Kind::pure_moment, upright(moment.normalized())};
  }
  const Vector3 axis = axis_part / strength;
  const Vector3 point = axis_part.cross(moment) / (strength * strength);
  const double pitch = axis.dot(moment) / strength;
  if (std::abs(pitch) < 1e-6 * (1 + point.norm()))
    return {ScrewLine::Kind::line, upright(axis), point};
  return {ScrewLine::Kind::screw, upright(axis), point, pitch};
}

std::string describe_twist(const Screw& twist) {
  return describe(
      twist, {"no motion", "translation along", "rotation about the axis along", "screw motion"});
}

std::string describe_wrench(const Screw& wrench) {
  return describe(wrench, {"no wrench", "couple about", "force along", "wrench"});
}

std::vector<Screw> plain_basis(const Eigen::MatrixXd& system, const Vector3& point, double size) {
  std::vector<Screw> basis;
  if (system.cols() == 0) return basis;
  const Svd whole = svd_of(system);
  const int rank = decide_rank(whole.values).rank;
  const Eigen::MatrixXd space = whole.u.leftCols(rank);
  const Svd axes = svd_of(space.topRows(3));
  const int turning = decide_rank(axes.values, 1).rank;
  const Eigen::MatrixXd moments = space.bottomRows(3) * axes.v.rightCols(rank - turning);

  Eigen::Matrix3Xd free(3, 0);
  if (moments.cols() > 0) free = plain_directions(moments, static_cast<int>(moments.cols()));
  for (Eigen::Index i = 0; i < free.cols(); ++i) {
    Screw screw;
    screw << Vector3::Zero(), free.col(i);
    basis.push_back(screw);
  }
  if (turning == 0) return basis;
  const Eigen::Matrix3Xd directions = plain_directions(space.topRows(3), turning);
  const Eigen::MatrixXd inverse = axes.v.leftCols(turning) *
                                  axes.values.head(turning).cwiseInverse().asDiagonal() *
                                  axes.u.leftCols(turning).transpose();
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const Vector3 axis = directions.col(i);
    Vector3 moment = space.bottomRows(3) * (inverse * axis);
    moment -= free * (free.transpose() * moment);
    Screw screw;
    screw << axis, size * moment + point.cross(axis);
    basis.push_back(screw);
  }
  return basis;
}

}  // namespace polyglide
