#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
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
/// constant pi, and sin cos tan asin acos atan atan2 sqrt abs hypot min max. Powers
/// bind before signs: -2^2 = -4. At most 500 characters.
/// Thread-safe; each thread keeps what it has compiled, so the same text again
/// costs about 0.2 µs.
[[nodiscard]] Evaluation evaluate(const std::string& text, const Scope& scope);

/// What is wrong with an expression whatever its names stand for, as a rule; "" when nothing is.
[[nodiscard]] std::string mistake_in(const std::string& text, bool degrees);

/// Names with their values at many points, one array each.
using Columns = std::vector<std::pair<std::string, const double*>>;

/// The values at `count` points of an expression without mistake_in(). What has
/// no value at a point gives NaN or an infinity there. About 0.05 µs a point.
/// @param columns the names that the text uses; others are not read.
void evaluate(const std::string& text, bool degrees, const Columns& columns, std::size_t count,
              double* values);

/// The names an expression uses, without functions and pi, in order of appearance.
[[nodiscard]] std::vector<std::string> names_in(std::string_view text);

/// The text with every word for which `replace` has a text replaced by it. Words are names
/// that may hold points, such as "leg1.guide"; functions and pi are left alone.
[[nodiscard]] std::string with_words(
    std::string_view text,
    const std::function<std::optional<std::string>(const std::string&)>& replace);

/// Is this word a function or constant of expressions, so not free for a parameter?
[[nodiscard]] bool is_reserved_name(std::string_view word);

}  // namespace polyglide
