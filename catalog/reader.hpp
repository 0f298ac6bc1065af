#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "catalog/expression.hpp"
#include "catalog/mechanism.hpp"
#include "catalog/problems.hpp"

namespace polyglide {

/// A member of an object; a null value when there is none or it is no object.
[[nodiscard]] const nlohmann::json& member(const nlohmann::json& object, const char* key);

/// The text of a string value; `otherwise` for anything else.
[[nodiscard]] std::string text(const nlohmann::json& value, const std::string& otherwise = "");

/// The frame in which points and directions are written, and what the words for
/// directions mean in it.
struct Compass {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< frame to base
  Vector3 origin = Vector3::Zero();                        ///< of the frame, base frame [m]
  std::optional<Vector3> guide;  ///< unit, base frame; set once it is known
  std::optional<Vector3> rod;    ///< unit, base frame, carriage (or base) to platform
};

/// Turns the values of one document into numbers in SI units.
///
/// Every mistake in a value goes to `problems`, and NaN comes back, so that
/// reading goes on and finds the others. A value of the wrong JSON type, or a
/// missing one, gives NaN silently: check_schema has told about it.
class Reader {
 public:
  Reader(Problems& problems, const Scope& scope, const Units& units)
      : problems_(problems), scope_(scope), units_(units) {}

  [[nodiscard]] Problems& problems() const { return problems_; }
  [[nodiscard]] const Units& units() const { return units_; }
  [[nodiscard]] const Scope& scope() const { return scope_; }

  /// A number or an expression, as written.
  [[nodiscard]] double number(const nlohmann::json& value) const;
  /// A length in metres.
  [[nodiscard]] double length(const nlohmann::json& value) const;
  /// An angle in radians.
  [[nodiscard]] double angle(const nlohmann::json& value) const;
  /// A length that must be greater than zero [m].
  [[nodiscard]] double positive_length(const nlohmann::json& value) const;
  /// Three coordinates in the compass's frame → point in the base frame [m].
  [[nodiscard]] Vector3 point(const nlohmann::json& value, const Compass& compass) const;
  /// Three coordinates in the compass's frame → vector in the base frame [m];
  /// zero for a missing value.
  [[nodiscard]] Vector3 offset(const nlohmann::json& value, const Compass& compass) const;
  /// A vector, a word ("tangential", "-x") or {lean, toward} → unit vector in the
  /// base frame.
  [[nodiscard]] Vector3 direction(const nlohmann::json& value, const Compass& compass) const;
  /// [min, max] times `unit`; null at either end means unlimited.
  [[nodiscard]] Range interval(const nlohmann::json& value, double unit) const;

 private:
  [[nodiscard]] Vector3 triple(const nlohmann::json& value) const;
  [[nodiscard]] Vector3 direction_word(const nlohmann::json& value, const Compass& compass) const;
  [[nodiscard]] Vector3 leaning(const nlohmann::json& value, const Compass& compass) const;

  Problems& problems_;
  const Scope& scope_;
  const Units& units_;
};

/// A vector of unit length in the same direction, bit for bit the same when it
/// has unit length already (so that written and read directions stay equal).
[[nodiscard]] Vector3 unit_vector(const Vector3& vector);

}  // namespace polyglide
