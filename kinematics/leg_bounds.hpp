#pragma once

#include "kinematics/box_limits.hpp"
#include "kinematics/leg_places.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {

/// The limits and the Jacobian of a leg machine in closed form, with the same definitions as
/// LegKernel's.
///
/// Gradients are closed forms: with v from a rod's carriage joint at home to its platform joint, p
/// its part across the guide g, h = sqrt(L² - p²): the drive is v·g + side·h and changes with g -
/// side·p/h; v changes with t, and with the angles by w × arm. A rod n on a crank, whose end moves
/// with e per angle: the angle solves A cos θ + B sin θ = C and changes with n/(n·e).
class LegBounds final : public BoxLimits {
 public:
  /// nullopt for machines without closed form, or whose rods must agree about a carriage in a way
  /// that intervals cannot prove, or with more than kMost limits; or with one that has no
  /// enclosure: an expression, or a clearance of a mesh.
  /// @param fixed applied before the box's rotation.
  /// @param turning whether boxes with other angles than zero will be asked.
  [[nodiscard]] static std::optional<LegBounds> make(const Machine& machine,
                                                     const std::vector<std::string>& ignored,
                                                     const Eigen::Quaterniond& fixed, bool turning);

  void enclose(const PoseBox& box, const Mask& wanted, std::vector<LimitBound>& bounds,
               const BranchPointer& branch = {}) const override;

  /// All that rods, strokes, cones and planes say is of second degree.
  [[nodiscard]] std::vector<QuadricLimit> quadrics(Mask& rest) const override;

  [[nodiscard]] IntervalMatrix jacobian(const PoseBox& box,
                                        const BranchPointer& branch = {}) const override;
  [[nodiscard]] IntervalMatrix rod_rows(const PoseBox& box,
                                        const BranchPointer& branch = {}) const override;
  [[nodiscard]] std::optional<MovingRows> moving_rows(const PoseBox& box) const override;

 private:
  struct Cone {
    std::size_t limit;
    bool on_platform;
    Vector3 axis;
    Interval cosine;
  };
  struct Row {
    Leg leg;
    bool primary;
    IntervalVector arm, base;  // platform joint, base joint (of a crank its centre) from the tool
    Interval length;
    Interval radius;                 // of a crank, with the unit vectors from its centre
    IntervalVector outward, onward;  // to the rod's joint at home, and the way that it goes
    std::size_t reach = 0, min = kMost, max = kMost;
    std::vector<Cone> cones;
  };
  struct Plane {
    std::size_t limit;
    Vector3 normal;
    Interval offset;  // of the plane, without what the point adds
    bool on_platform;
    Vector3 arm;  // point from the tool
    int drive = -1;
    Interval slope;
  };
  /// Pieces of two shapes that must be `apart`.
  struct Clearance {
    std::size_t limit;
    Interval apart;
    std::vector<LegPlace> a, b;
  };
  /// What the rotation of a box makes of the machine.
  struct Turned {
    IntervalRotation rotation;
    std::array<IntervalVector, 3> axes;  // about which the angles a, b, c turn
    std::array<bool, 3> varies{};
  };
  struct Moved;
  /// A rod or strut solved for its drive, on all of a box.
  struct Drive {
    Interval place;
    IntervalVector row;    // derivative of place by the joint's position; unbounded unless smooth
    IntervalVector along;  // the same times a positive number, always bounded
    IntervalVector rod;    // from base to platform joint
    IntervalVector speed;  // of the base joint, per drive
    IntervalRotation turn = no_rotation();  // of a crank
    Interval reach;                         // <= 0 where it reaches, with its derivative
    IntervalVector reach_row;
    bool smooth = false;
    IntervalVector arm;  // from the tool to the platform joint
  };

  LegBounds() = default;
  void add_row(const Machine& machine, int index, const std::vector<std::string>& ignored);
  void add_planes(const Machine& machine, const std::vector<std::string>& ignored);
  /// False when one cannot be enclosed.
  bool add_clearances(const Machine& machine, const std::vector<std::string>& ignored);
  [[nodiscard]] Turned turn(const PoseBox& box) const;
  IntervalMatrix matrix(const PoseBox& box, bool scaled) const;
  Drive solve(const Row& row, const PoseBox& box, const Turned& turned, const Mask& wanted,
              std::vector<LimitBound>* bounds) const;
  /// The limits of a rod that was solved.
  void bound_limits(const Row& row, const IntervalVector& v, const Drive& drive, const Turned& turn,
                    const Mask& wanted, std::vector<LimitBound>& bounds) const;
  /// @param v from the base joint at home, or a crank's centre, to the platform joint
  static Drive drive_of_guide(const Row& row, const IntervalVector& v);
  static Drive drive_of_strut(const Row& row, const IntervalVector& v);
  static Drive drive_of_crank(const Row& row, const IntervalVector& v);
  /// What is known of a crank's angle and of A² + B² - C² beforehand.
  struct CrankKnown {
    Interval place{-4, 4}, cosine{-1, 1}, sine{-1, 1};
    Interval left{-std::numeric_limits<double>::infinity(),
                  std::numeric_limits<double>::infinity()};
  };
  static Drive crank_at(const Row& row, const IntervalVector& v, const CrankKnown& known);
  /// A limit's value, and its derivative by v.
  using Ranged = std::pair<Interval, IntervalVector>;
  static Ranged crank_end(const Row& row, const IntervalVector& v, const Drive& drive,
                          const Interval& end, bool most);
  /// cos(limit)·|rod| - axis·rod <= 0, and its derivative by v.
  static Ranged lean(const Row& row, const Cone& cone, const Drive& drive,
                     const IntervalVector& axis);
  /// Where bodies are in a box.
  struct Place {
    PoseBox box;
    Turned turning;
    std::vector<Drive> drives;
  };
  [[nodiscard]] Place place(const PoseBox& box) const;
  [[nodiscard]] Moved move(const LegPlace& corner, const Place& place) const;
  void enclose_clearances(const PoseBox& box, const Mask& wanted,
                          std::vector<LimitBound>& bounds) const;
  [[nodiscard]] LimitBound enclose_pair(const Clearance& pair, const Place& whole,
                                        const Place& middle) const;

  std::vector<Row> rows_;
  std::vector<Plane> planes_;
  std::vector<Clearance> clearances_;
  std::vector<Leg> legs_;
  Vector3 tool_ = Vector3::Zero();
  Eigen::Quaterniond fixed_ = Eigen::Quaterniond::Identity();
  std::vector<int> axes_;
  int drives_ = 0;
  double characteristic_length_ = 1;
};

}  // namespace polyglide
