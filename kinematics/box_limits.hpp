#pragma once

#include <bitset>
#include <memory>
#include <optional>
#include <string>

#include "kinematics/interval_matrix.hpp"
#include "kinematics/interval_rotation.hpp"
#include "kinematics/quadrics.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {

/// Task coordinates [x y z a b c] from home, each a range [m, rad]; rotation Rz(c)·Ry(b)·Rx(a).
using PoseBox = std::array<Interval, 6>;

/// The middle() of every coordinate.
[[nodiscard]] inline PoseBox middle_of(const PoseBox& box) {
  PoseBox result;
  for (int k = 0; k < 6; ++k) result[k] = Interval(middle(box[k]));
  return result;
}

/// Where nothing is known.
inline const Interval kAnything(-std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::infinity());

/// One limit as "value <= 0 is allowed", on a box of poses. Scale as the limit's own [m, m²].
struct LimitBound {
  Interval value;
  std::array<Interval, 6> gradient;  ///< by the six coordinates; not finite where not smooth
};

/// The limits and the Jacobian of a machine, enclosed on boxes of poses, 1e-9 of slack included.
/// Gradients enclose how a limit changes from the middle() of the box, for the value that enclose()
/// gives there. Fixed; share between threads. Needs UpwardRounding.
class BoxLimits {
 public:
  static constexpr std::size_t kMost = 256;
  using Mask = std::bitset<kMost>;

  /// Where the joints of a machine without closed form are while the platform is in a box.
  struct Branch {
    virtual ~Branch() = default;
  };
  /// Null where a closed form says it, and for home.
  using BranchPointer = std::shared_ptr<const Branch>;

  virtual ~BoxLimits() = default;

  /// Of following the joints, some µs per box; 0 where a closed form says where they are. Where
  /// they are followed, large boxes say nothing.
  [[nodiscard]] virtual double effort() const { return 0; }

  [[nodiscard]] std::size_t size() const { return names_.size(); }
  /// Name of limit i, as Evaluator's: several may share one.
  [[nodiscard]] const std::string& name(std::size_t i) const { return names_[i]; }

  /// The joints in `box`, followed from a box that holds it or from home; what the other functions
  /// are to be given with this box or its middle.
  [[nodiscard]] virtual BranchPointer follow(const PoseBox& /*box*/,
                                             const BranchPointer& /*from*/) const {
    return nullptr;
  }

  /// Encloses the limits in `wanted`; the others are left as they are.
  virtual void enclose(const PoseBox& box, const Mask& wanted, std::vector<LimitBound>& bounds,
                       const BranchPointer& branch) const = 0;

  /// The limits of places alone, as at the angles zero, that are of second degree. `rest`: the
  /// limits that are not among them.
  [[nodiscard]] virtual std::vector<QuadricLimit> quadrics(Mask& rest) const {
    rest.reset();
    for (std::size_t i = 0; i < size(); ++i) rest.set(i);
    return {};
  }

  /// Task Jacobian, drives × task axes, rotations per characteristic length. Entries are unbounded
  /// where a limb may be at the end of its reach.
  [[nodiscard]] virtual IntervalMatrix jacobian(const PoseBox& box,
                                                const BranchPointer& branch) const = 0;

  /// The Jacobian with every row multiplied by a positive number, so that it stays bounded at the
  /// end of a rod's reach if that is known: same rank, same sign of the determinant inside the
  /// reach.
  [[nodiscard]] virtual IntervalMatrix rod_rows(const PoseBox& box,
                                                const BranchPointer& branch) const {
    return jacobian(box, branch);
  }

  /// rod_rows() and how they change with x, y and z. Angles zero.
  struct MovingRows {
    IntervalMatrix rows;
    std::array<IntervalMatrix, 3> rates;  ///< not finite where a rod may be at the end of its reach
  };
  /// nullopt where that is not known.
  [[nodiscard]] virtual std::optional<MovingRows> moving_rows(const PoseBox& /*box*/) const {
    return std::nullopt;
  }

 protected:
  /// [m, rad] A pose on its limit is allowed.
  static constexpr double kSlack = 1e-9;

  std::size_t add(const std::string& name) {
    names_.push_back(name);
    return names_.size() - 1;
  }

 private:
  std::vector<std::string> names_;
};

/// In closed form where there is one, else through the closure of loops; null where a limit has no
/// enclosure or nothing can be followed from home.
/// @param machine kept by reference
/// @param fixed of the boxes: their own rotation is applied after it
/// @param turning whether boxes with other angles than zero will be asked
[[nodiscard]] std::unique_ptr<const BoxLimits> make_box_limits(
    const Machine& machine, const std::vector<std::string>& ignored,
    const Eigen::Quaterniond& fixed, bool turning);

}  // namespace polyglide
