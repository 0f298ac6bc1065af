#include "kinematics/distance_newton.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace polyglide {
namespace {

double unit(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

/// Uniform among rotations (Shoemake 1992).
Eigen::Quaterniond random_rotation(std::mt19937_64& random) {
  const double u = unit(random), a = 2 * M_PI * unit(random), b = 2 * M_PI * unit(random);
  const double p = std::sqrt(1 - u), q = std::sqrt(u);
  return {q * std::cos(b), p * std::sin(a), p * std::cos(a), q * std::sin(b)};
}

Eigen::Matrix3d turn_by(const Vector3& turn) {
  const double angle = turn.norm();
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

}  // namespace

DistancePlatform::DistancePlatform(const Machine& machine, const std::vector<int>& legs,
                                   const Eigen::VectorXd& drives)
    : size_(machine.model.size) {
  const Vector3& tool = machine.model.mechanism.tool;
  for (int i = 0; i < 6; ++i) {
    const Leg& leg = machine.legs->legs[legs[i]];
    const double q = drives[leg.drive];
    arms_[i] = (leg.platform_point - tool) / size_;
    centres_[i] = (leg.base_point - tool) / size_;
    radii_[i] = leg.length / size_;
    if (leg.kind == Leg::Kind::strut)
      radii_[i] += q / size_;
    else
      centres_[i] += q / size_ * leg.direction;
    middle_ += centres_[i] / 6;
  }
  reach_ = *std::max_element(radii_.begin(), radii_.end());
}

void DistancePlatform::linearise(const Eigen::Matrix3d& turn, const Vector3& position,
                                 Vector6& error, Matrix6& jacobian) const {
  for (int i = 0; i < 6; ++i) {
    const Vector3 arm = turn * arms_[i];
    const Vector3 gap = arm + position - centres_[i];
    error[i] = (gap.squaredNorm() - radii_[i] * radii_[i]) / 2;
    jacobian.row(i) << gap.transpose(), arm.cross(gap).transpose();
  }
}

std::optional<Pose> DistancePlatform::random_root(std::uint64_t seed, std::uint64_t number) const {
  std::mt19937_64 random(seed * 0x9e3779b97f4a7c15ULL + number);
  Eigen::Matrix3d turn = random_rotation(random).toRotationMatrix();
  Vector3 arms = Vector3::Zero();
  for (const Vector3& arm : arms_) arms += turn * arm / 6;
  const Vector3 away = Vector3(unit(random), unit(random), unit(random)) * 2 - Vector3::Ones();
  Vector3 position = middle_ - arms + reach_ * away;
  constexpr int kMost = 50;
  constexpr double kLongest = 0.6;
  Vector6 error;
  Matrix6 jacobian;
  bool near = false;
  for (int i = 0; i < kMost; ++i) {
    linearise(turn, position, error, jacobian);
    Vector6 step = -jacobian.partialPivLu().solve(error);
    const double length = step.cwiseAbs().maxCoeff();
    if (!(length < 1e12)) return std::nullopt;
    if (length > kLongest) step *= kLongest / length;
    position += step.head<3>();
    turn = turn_by(step.tail<3>()) * turn;
    // One more step after convergence leaves rounding only.
    if (near) {
      Pose pose{position * size_, Eigen::Quaterniond(turn).normalized()};
      return residual(pose) < 1e-10 ? std::optional(pose) : std::nullopt;
    }
    near = length < 1e-9;
  }
  return std::nullopt;
}

double DistancePlatform::residual(const Pose& pose) const {
  const Eigen::Matrix3d turn = pose.rotation.toRotationMatrix();
  double largest = 0;
  for (int i = 0; i < 6; ++i)
    largest = std::max(
        largest,
        std::abs((turn * arms_[i] + pose.position / size_ - centres_[i]).norm() - radii_[i]));
  return largest;
}

int DistancePlatform::side(const Pose& pose) const {
  Vector6 error;
  Matrix6 jacobian;
  linearise(pose.rotation.toRotationMatrix(), pose.position / size_, error, jacobian);
  double scale = 1;
  for (int i = 0; i < 6; ++i) scale *= jacobian.row(i).norm();
  const double determinant = jacobian.determinant();
  if (!(std::abs(determinant) > 1e-12 * scale)) return 0;
  return determinant > 0 ? 1 : -1;
}

bool DistancePlatform::regular_between(const Pose& a, const Pose& b, int samples) const {
  const int sign = side(a);
  if (sign == 0 || side(b) != sign) return false;
  for (int i = 1; i < samples; ++i) {
    const double along = static_cast<double>(i) / samples;
    const Pose pose{a.position + along * (b.position - a.position),
                    a.rotation.slerp(along, b.rotation)};
    if (side(pose) != sign) return false;
  }
  return true;
}

}  // namespace polyglide
