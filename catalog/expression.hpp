#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace polyglide {

/// The names an expression may use, with their values.
struct Scope {
  bool degrees = true;  ///< unit of the angles that sin … atan2 take and give; else radians
  std::vector<std::pair<std::string, double>> names;

  /// nullptr when there is no such name.
  [[nodiscard]] const double* find(std::string_view name) const;
};

/// Outcome of an expression: a value, or what is wrong with the text.
/// The value is NaN without an error when a name it uses is itself NaN: that
/// mistake has been reported where it was made.
struct Evaluation {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string error;  ///< the rule that is broken; empty when there is a value
  std::string hint;   ///< the nearest known name, if one is near
};

/// Evaluates "R*cos(30) + w/2": numbers, names of the scope, + - * / ^ ( ), the
/// constant pi, and sin cos tan asin acos atan atan2 sqrt abs min max. Powers
/// bind before signs: -2^2 = -4. At most 500 characters.
/// Thread-safe; each thread keeps what it has compiled, so the same text again
/// costs about 0.2 µs.
[[nodiscard]] Evaluation evaluate(const std::string& text, const Scope& scope);

/// The names an expression uses, without functions and pi, in order of appearance.
[[nodiscard]] std::vector<std::string> names_in(std::string_view text);

/// Is this word a function or constant of expressions, so not free for a parameter?
[[nodiscard]] bool is_reserved_name(std::string_view word);

}  // namespace polyglide
