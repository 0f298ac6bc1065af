#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "kinematics/solve.hpp"

namespace polyglide {

/// What to answer at every pose of a batch: a sum of these. What is not wanted costs
/// nothing. J is the task Jacobian, drive rates = J · task rates, rotations multiplied by the
/// characteristic length; σ its singular values, n its number of columns.
struct Wanted {
  enum : unsigned {
    condition = 1,    ///< 1/κ = σ_min/σ_max
    orientation = 2,  ///< sign of det J
    frobenius = 4,  ///< 1/κ_F = n/√(tr JᵀJ · tr (JᵀJ)⁻¹) (Angeles & López-Cajún 1992)
    smallest = 8,   ///< σ_min: 1/σ_min is the greatest task speed per drive speed
    transmission = 16,  ///< least cosine of a pressure angle (Takeda & Funabashi 1995)
    stiffness = 32,     ///< extremes of σ²: task stiffness per drive stiffness (Gosselin 1990)
    drives = 64,        ///< drive positions from home
    jacobian = 128      ///< J itself
  };
};

/// Poses of one machine, structure-of-arrays; `angles` and `quaternion` are absent (empty) or
/// as long as x.
struct PoseBatch {
  std::vector<double> x, y, z;  ///< tool displacement from home [m]
  /// Common to the batch; not read when the poses have rotations of their own.
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  unsigned wanted = Wanted::condition | Wanted::orientation;
  /// Rotation of every pose, as pose_of() reads it: Rz(c)·Ry(b)·Rx(a), {a, b, c} [rad]. Those
  /// left empty are zero. |angle| < 1e5.
  std::array<std::vector<double>, 3> angles = {};
  /// Instead of angles: quaternions w x y z of any length above zero.
  std::array<std::vector<double>, 4> quaternion = {};
  /// "" is the best the processor has; else "scalar", "x86_64", "v3" or "v4", for tests.
  std::string instructions = {};
  [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// Answers, one per pose; columns that were not wanted are empty. Where a pose is not
/// reachable indices are 0, drives and Jacobian meaningless.
struct BatchResult {
  std::vector<int> limit;                 ///< -1 reachable, else index into Evaluator::limit_names
  std::vector<double> inverse_condition;  ///< 1/κ, 0 when singular
  std::vector<signed char> orientation;   ///< sign of det J where J is square, else 0;
                                          ///< rounding decides it where 1/κ < 1e-10
  std::vector<double> frobenius;          ///< 1/κ_F <= 1
  std::vector<double> smallest;           ///< σ_min [drive unit/m]
  /// Least over the legs of cos μ in and out. In: between the rod and the motion of its
  /// carriage or crank end; out, for square J: between the rod and the motion of its platform
  /// joint when its drive alone moves. Closed form only; else 0.
  std::vector<double> transmission;
  std::vector<double> softest, stiffest;  ///< σ_min², σ_max²: N/m per N/m of a linear drive
  std::vector<double> drives;             ///< [drive · size + pose], from home [m, rad]
  std::vector<double> jacobian;  ///< [(drive · n + column) · size + pose], columns as task axes
};

/// Drive positions of one machine, and where the search for its poses starts.
struct DriveBatch {
  std::size_t size = 0;
  std::vector<double> drives;  ///< [drive · size + pose], from home [m, rad]
  /// Poses near the solutions, from home: x y z [m], quaternion w x y z; empty: home.
  std::array<std::vector<double>, 7> start;
  std::string instructions;  ///< as in PoseBatch
};

/// Poses found, and how well.
struct ForwardResult {
  std::array<std::vector<double>, 7> pose;  ///< as DriveBatch::start
  /// Closed form: greatest relative error of a squared leg length; else closure error,
  /// infinity when none was found. Below 1e-9 where a pose was found.
  std::vector<double> residual;
};

/// Whether the poses have rotations of their own.
[[nodiscard]] bool has_rotations(const PoseBatch& poses);

/// One pose of a batch.
[[nodiscard]] Pose pose_at(const PoseBatch& poses, std::size_t i);

class BatchModel;
class BatchClearances;
class BatchExpressions;

/// Evaluates many poses of one machine. Leg machines with a pure task space (guide + rod,
/// crank + rod, strut) run through a vector kernel chosen for the processor; the rest is
/// solved by Newton's method, started from the pose before. Immutable; share between threads.
///
/// Instruction sets differ in rounding, by about 1e-15; results on one processor do not depend on
/// threads, nor those of a pose on the other poses of the batch.
class Evaluator {
 public:
  /// @param ignored limits that do not count, as in is_ignored(): a full name, a first word
  ///        ("stroke", "cone", "clearance") or the name that the file gives a limit ("triangle").
  explicit Evaluator(const Machine& machine, const std::vector<std::string>& ignored = {});

  /// Human names of what can stop a pose: "reach leg1.rod" (just "reach" without closed form),
  /// "stroke leg1.guide min", "stroke leg1.guide max", "range …", "cone leg1.bottom",
  /// "triangle", "clearance leg1.rod leg2.rod", …; "motion": a coordinate that a pure machine
  /// cannot command; "not finite": a coordinate that is no number.
  [[nodiscard]] const std::vector<std::string>& limit_names() const { return limit_names_; }

  /// Cost per pose and core with AVX-512: about 10 ns (three translational legs) to 100 ns (six
  /// legs); the general way some 0.1 to 10 ms. See bench/README.md.
  /// @throws std::invalid_argument for columns of different length.
  void evaluate(const PoseBatch& poses, BatchResult& result) const;

  /// Poses for drive positions: Newton's method from every start, without regard to limits.
  /// From home it finds home's assembly mode for drives near home; follow a path by giving each
  /// batch the last one's poses. Cost with AVX-512: 0.1 to 0.2 µs for six legs, below 1 µs for one
  /// pose in a call of its own.
  /// @throws std::invalid_argument for columns of wrong length.
  void forward(const DriveBatch& drives, ForwardResult& result) const;

  /// Drives at one reachable pose; limit as above.
  [[nodiscard]] int inverse(const Pose& pose, Eigen::VectorXd& drives) const;

  /// The machine, with the strokes of its legs unlimited where they are ignored.
  [[nodiscard]] const Machine& machine() const { return machine_; }

  /// Whether poses are answered in closed form, so millions of them are no matter.
  [[nodiscard]] bool closed_form() const { return model_ != nullptr; }

 private:
  void evaluate_legs(const PoseBatch& poses, BatchResult& result) const;
  void check_late_limits(const PoseBatch& poses, std::size_t first, std::size_t last,
                         BatchResult& result) const;
  void evaluate_general(const PoseBatch& poses, BatchResult& result) const;
  void forward_legs(const DriveBatch& drives, ForwardResult& result) const;
  void forward_general(const DriveBatch& drives, ForwardResult& result) const;
  int limit_index(const std::string& name) const;

  Machine machine_;
  std::vector<std::string> ignored_;
  std::vector<std::string> limit_names_;
  std::shared_ptr<const BatchModel> model_;
  // With the model only, and only where there are such limits.
  std::shared_ptr<const BatchExpressions> expressions_;
  std::shared_ptr<const BatchClearances> clearances_;
};

}  // namespace polyglide
