#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinematics/evaluate.hpp"

namespace polyglide {

/// Points asked together: tool displacements from home [m].
struct Points {
  std::vector<double> x, y, z;
  void reserve(std::size_t count) {
    x.reserve(count);
    y.reserve(count);
    z.reserve(count);
  }
  void add(const Vector3& point) {
    x.push_back(point.x());
    y.push_back(point.y());
    z.push_back(point.z());
  }
  [[nodiscard]] std::size_t size() const { return x.size(); }
  [[nodiscard]] Vector3 operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// Axis-parallel box of tool displacements.
struct Bounds {
  Vector3 lower = Vector3::Zero(), upper = Vector3::Zero();
};

/// A plane beyond which nothing belongs to the workspace, because J is singular on it.
struct SingularWall {
  Vector3 normal = Vector3::Zero();  ///< unit, away from home
  double offset = 0;                 ///< [m]
  /// How far a place lies beyond it [m].
  [[nodiscard]] double beyond(const Vector3& place) const { return normal.dot(place) - offset; }
};

/// Told how many poses were asked so far, from the thread that asks.
using PoseCounter = std::function<void(std::size_t poses)>;

/// Asks an evaluator about tool places at one orientation or at all of a set, and counts; asking
/// is safe from several threads. A place
/// belongs to the workspace when no limit stops it and no singular surface
/// separates it from home: for square J the sign of det J is home's, and 1/κ > 1e-6. Where det J
/// touches zero and keeps its sign a wall separates, once one was found and set.
class Probe {
 public:
  Probe(const Evaluator& evaluator, const Eigen::Quaterniond& rotation);
  /// A place belongs to the workspace when it does at every one of these orientations, of which
  /// there is at least one; its 1/κ is the least of them. Those that stop most come best first.
  Probe(const Evaluator& evaluator, std::vector<Eigen::Quaterniond> rotations);

  struct Answers {
    std::vector<int> limit;                 ///< -1 inside, else index into names()
    std::vector<double> inverse_condition;  ///< may be empty when it was not asked for
    std::vector<signed char> orientation;
    [[nodiscard]] bool inside(std::size_t i) const { return limit[i] < 0; }
  };
  [[nodiscard]] Answers ask(const Points& points, bool conditioning = true) const;
  /// The same for poses with orientations of their own.
  [[nodiscard]] Answers ask(PoseBatch poses, bool conditioning = true) const;
  /// Also false when a place lies beyond the reach set.
  [[nodiscard]] bool all_inside(const Points& points) const;
  /// Where nothing else bounds a shape it would grow for ever.
  void set_reach(const Bounds& reach) { reach_ = reach; }
  [[nodiscard]] bool beyond_reach(const Vector3& place) const;

  /// Limit names of the evaluator, then "singularity" and "search box".
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] int singularity() const { return static_cast<int>(names_.size()) - 2; }
  [[nodiscard]] int search_box() const { return static_cast<int>(names_.size()) - 1; }

  /// Sign of det J that counts; 0 = either, as when home itself is singular.
  [[nodiscard]] int side() const { return side_; }
  void set_side(int side) { side_ = side; }

  /// Whether singular surfaces are a limit and have two sides.
  [[nodiscard]] bool sides() const { return square_ && !crosses_; }
  [[nodiscard]] const std::optional<SingularWall>& wall() const { return wall_; }
  void set_wall(const SingularWall& wall) { wall_ = wall; }

  /// From now on singular surfaces are no limit.
  void cross_singularities() {
    crosses_ = true;
    side_ = 0;
  }

  [[nodiscard]] const Evaluator& evaluator() const { return evaluator_; }
  /// The orientation, of a set the first.
  [[nodiscard]] const Eigen::Quaterniond& rotation() const { return rotations_.front(); }
  [[nodiscard]] std::size_t orientations() const { return rotations_.size(); }
  [[nodiscard]] std::size_t poses() const { return poses_; }
  /// Poses that take long are counted aloud, some hundred at a time.
  void set_counter(PoseCounter counter) { counter_ = std::move(counter); }
  /// Which of x, y, z the machine can command.
  [[nodiscard]] const std::array<bool, 3>& active() const { return active_; }
  [[nodiscard]] int dimensions() const { return active_[0] + active_[1] + active_[2]; }

 private:
  [[nodiscard]] BatchResult evaluate(const PoseBatch& poses) const;

  const Evaluator& evaluator_;
  std::vector<Eigen::Quaterniond> rotations_;
  PoseCounter counter_;
  std::optional<Bounds> reach_;
  std::vector<std::string> names_;
  std::array<bool, 3> active_{};
  bool square_ = false;   ///< as many drives as task axes
  bool crosses_ = false;  ///< singular surfaces are no limit
  int side_ = 0;
  std::optional<SingularWall> wall_;
  mutable std::atomic<std::size_t> poses_ = 0;
};

}  // namespace polyglide
