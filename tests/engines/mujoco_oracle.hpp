#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engines/constraint_system.hpp"

struct mjModel_;
struct mjData_;

namespace polyglide::engines {

/// A model loaded by MuJoCo. Only positions are ever computed, nothing is stepped.
class MujocoModel {
 public:
  /// @param xml MJCF or URDF text.
  /// @throws std::runtime_error with MuJoCo's message when it refuses the text.
  explicit MujocoModel(const std::string& xml);

  /// Sets coordinates: one number per hinge or slide, four (w, x, y, z) per ball.
  /// @throws std::runtime_error for a joint that the model does not have.
  void set(const std::string& joint, const std::vector<double>& values);

  /// Constraints at the coordinates set, or at those of the file. The platform is the
  /// body that carries the site `tool`.
  [[nodiscard]] ConstraintSystem constraints();

  /// Constraint rows that the model's equalities must have when all are active.
  [[nodiscard]] int expected_rows() const;

  [[nodiscard]] int velocities() const;
  /// Of the body's frame: position [m], then its quaternion (w, x, y, z).
  [[nodiscard]] std::vector<double> body_pose(const std::string& body);
  /// 6 × velocities, row by row: angular, then linear velocity of the body's origin.
  [[nodiscard]] std::vector<double> body_jacobian(const std::string& body);
  /// Index of the velocity of a hinge or slide.
  [[nodiscard]] int velocity_index(const std::string& joint) const;
  [[nodiscard]] bool is_slide(int velocity) const;

 private:
  [[nodiscard]] int find(int kind, const std::string& name) const;
  void place();
  std::shared_ptr<mjModel_> model_;
  std::shared_ptr<mjData_> data_;
};

}  // namespace polyglide::engines
