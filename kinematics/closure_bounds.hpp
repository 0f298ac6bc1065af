#pragma once

#include "kinematics/box_limits.hpp"
#include "kinematics/closure_system.hpp"
#include "kinematics/followed_root.hpp"
#include "kinematics/limb_reach.hpp"

namespace polyglide {

/// The limits and the Jacobian of any machine through the closure of its loops. The posture is
/// followed from home: for a box of poses each limb's joint coordinates are proved to be the only
/// solution in a box of their own (Krawczyk), and their derivatives by the pose are enclosed. Where
/// that fails, near the end of a limb's reach, or in boxes that are too large, nothing is known,
/// and "reach" is undecided.
class ClosureBounds final : public BoxLimits {
 public:
  /// nullopt where a limit has no enclosure (an expression, a clearance), or ClosureSystem is none.
  /// @param machine kept by reference. @param rotation added to the angles of every box.
  [[nodiscard]] static std::optional<ClosureBounds> make(const Machine& machine,
                                                         const std::vector<std::string>& ignored,
                                                         const Eigen::Quaterniond& rotation);

  [[nodiscard]] double effort() const override;
  [[nodiscard]] BranchPointer follow(const PoseBox& box, const BranchPointer& from) const override;
  void enclose(const PoseBox& box, const Mask& wanted, std::vector<LimitBound>& bounds,
               const BranchPointer& branch) const override;
  [[nodiscard]] IntervalMatrix jacobian(const PoseBox& box,
                                        const BranchPointer& branch) const override;

 private:
  /// The joints of all parts in a box.
  struct Followed final : Branch {
    PoseBox box;
    std::vector<FollowedRoot> roots;
  };
  /// Variables on a box and, per part, the rates of its unknowns; null where nothing is known.
  struct Known {
    std::vector<Interval> variables;
    std::vector<const IntervalMatrix*> rates;
    std::shared_ptr<const Followed> followed;  // keeps the rates

    [[nodiscard]] bool all() const {
      return std::ranges::all_of(rates, [](const IntervalMatrix* each) { return each != nullptr; });
    }
  };
  struct EndOfRange {
    std::size_t limit;
    int variable;
    Interval scale;
    double end;
    double sign;  ///< 1: a greatest value, -1: a least
  };
  struct Cone {
    std::size_t limit;
    ScrewChain chain;
    Vector3 axis;
    Interval cosine;
  };
  /// A limb stretched out, and its ends along the direction that is left out of it.
  struct Stretched {
    std::size_t most, min, max;  // kMost where there is none
    ReachBound bound;
  };
  struct Plane {
    std::size_t limit;
    ScrewChain chain;
    Vector3 point, normal;
    Interval offset;
  };

  ClosureBounds(const Machine& machine, ClosureSystem system);
  void add_limits(const std::vector<std::string>& ignored);
  void add_joint(int joint, const std::vector<std::string>& ignored);
  [[nodiscard]] std::vector<Interval> parameters_of(const PoseBox& box) const;
  [[nodiscard]] ParametricEnclosure equations_of(const ClosurePart& part) const;
  [[nodiscard]] Known pose_of_box(const PoseBox& box) const;
  [[nodiscard]] bool beyond_reach(const PoseBox& box) const;
  [[nodiscard]] Known known(const PoseBox& box, const BranchPointer& branch) const;
  void add_reach(const ReachBound& bound);
  void enclose_reach(const Known& known, const Mask& wanted, std::vector<LimitBound>& bounds) const;
  [[nodiscard]] Interval rate(const Known& known, int variable, int parameter) const;
  [[nodiscard]] Interval scale_of(int parameter) const;
  template <typename Change>
  void set(const Known& known, LimitBound& bound, const std::vector<CarriedScrew>& screws,
           const Change& change) const;
  [[nodiscard]] IntervalMatrix task_rates(const Known& known) const;

  const Machine* machine_;
  ClosureSystem system_;
  Eigen::Matrix<double, 6, 1> offset_;
  std::vector<FollowedRoot> home_;
  std::vector<EndOfRange> ends_;
  std::vector<Cone> cones_;
  std::vector<Plane> planes_;
  std::vector<Stretched> stretched_;
  ScrewChain platform_;
};

}  // namespace polyglide
