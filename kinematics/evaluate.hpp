#pragma once

#include <memory>
#include <string>
#include <vector>

#include "kinematics/solve.hpp"

namespace polyglide {

/// What is asked at every pose of a batch, structure-of-arrays.
struct PoseBatch {
  std::vector<double> x, y, z;  ///< tool displacement from home [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< common to the batch
  bool conditioning = true;  ///< false: where J is square and regular, 1 may stand for 1/κ
  [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// Answers, one per pose.
struct BatchResult {
  std::vector<int> limit;                 ///< -1 reachable, else index into Evaluator::limit_names
  std::vector<double> inverse_condition;  ///< 1/κ of the task Jacobian, 0 where not reachable
  std::vector<signed char> orientation;   ///< sign of det J where J is square and reachable, else 0
};

class LegKernel;

/// Evaluates many poses of one machine. Closed form for leg machines with a pure
/// task space; warm-started Newton for the rest. Immutable; share between threads.
class Evaluator {
 public:
  /// @param ignored limits that do not count, as in is_ignored(): a full name, a first word
  ///        ("stroke", "cone") or the name of a half-space limit ("triangle").
  explicit Evaluator(const Machine& machine, const std::vector<std::string>& ignored = {});

  /// Human names of what can stop a pose: "reach leg1.rod" (just "reach" without closed form),
  /// "stroke leg1.guide min", "stroke leg1.guide max", "range …", "cone leg1.bottom",
  /// "triangle", …, and "motion": a coordinate that a pure machine cannot command.
  [[nodiscard]] const std::vector<std::string>& limit_names() const { return limit_names_; }

  /// Results do not depend on threads. Cost per pose and core: about 40 ns (three
  /// translational legs) to 2 µs (six legs); the general way some 0.1 to 10 ms.
  void evaluate(const PoseBatch& poses, BatchResult& result) const;

  /// Drives at one reachable pose; limit as above.
  [[nodiscard]] int inverse(const Pose& pose, Eigen::VectorXd& drives) const;

  /// The machine, with the strokes of its legs unlimited where they are ignored.
  [[nodiscard]] const Machine& machine() const { return machine_; }

  /// Whether poses are answered in closed form, so millions of them are no matter.
  [[nodiscard]] bool closed_form() const { return kernel_ != nullptr; }

 private:
  void evaluate_legs(const PoseBatch& poses, BatchResult& result) const;
  void evaluate_general(const PoseBatch& poses, BatchResult& result) const;
  int limit_index(const std::string& name) const;

  Machine machine_;
  std::vector<std::string> ignored_;
  std::vector<std::string> limit_names_;
  std::shared_ptr<const LegKernel> kernel_;
};

}  // namespace polyglide
