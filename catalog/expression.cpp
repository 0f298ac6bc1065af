#include "catalog/expression.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <memory>
#include <numbers>
#include <unordered_map>

#include "catalog/problems.hpp"

namespace polyglide {
namespace {

constexpr std::size_t kLongest = 500;
constexpr std::size_t kMostCompiled = 2048;  ///< per thread; then it starts anew
constexpr double kDegree = std::numbers::pi / 180;
constexpr std::array kReserved = {"sin",  "cos", "tan",   "asin", "acos", "atan", "atan2",
                                  "sqrt", "abs", "hypot", "min",  "max",  "pi"};

bool starts_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

/// The length of the number at the start of the text ("1e3" holds no name "e3").
std::size_t number_length(std::string_view text) {
  std::size_t i = 0;
  const auto digits = [&] {
    while (i < text.size() && std::isdigit(static_cast<unsigned char>(text[i]))) ++i;
  };
  digits();
  if (i < text.size() && text[i] == '.') ++i;
  digits();
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    std::size_t exponent = i + 1;
    if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
    if (exponent < text.size() && std::isdigit(static_cast<unsigned char>(text[exponent]))) {
      i = exponent;
      digits();
    }
  }
  return i;
}

/// A parser that knows our functions only: muParser's assignments, comparisons
/// and further functions have no meaning in a drawing.
mu::Parser bare_parser(bool degrees) {
  mu::Parser parser;
  parser.ClearFun();
  parser.ClearConst();
  parser.DefineConst("pi", std::numbers::pi);
  if (degrees) {
    parser.DefineFun(
        "sin", +[](double x) { return std::sin(x * kDegree); });
    parser.DefineFun(
        "cos", +[](double x) { return std::cos(x * kDegree); });
    parser.DefineFun(
        "tan", +[](double x) { return std::tan(x * kDegree); });
    parser.DefineFun(
        "asin", +[](double x) { return std::asin(x) / kDegree; });
    parser.DefineFun(
        "acos", +[](double x) { return std::acos(x) / kDegree; });
    parser.DefineFun(
        "atan", +[](double x) { return std::atan(x) / kDegree; });
    parser.DefineFun(
        "atan2", +[](double y, double x) { return std::atan2(y, x) / kDegree; });
  } else {
    parser.DefineFun(
        "sin", +[](double x) { return std::sin(x); });
    parser.DefineFun(
        "cos", +[](double x) { return std::cos(x); });
    parser.DefineFun(
        "tan", +[](double x) { return std::tan(x); });
    parser.DefineFun(
        "asin", +[](double x) { return std::asin(x); });
    parser.DefineFun(
        "acos", +[](double x) { return std::acos(x); });
    parser.DefineFun(
        "atan", +[](double x) { return std::atan(x); });
    parser.DefineFun(
        "atan2", +[](double y, double x) { return std::atan2(y, x); });
  }
  parser.DefineFun(
      "sqrt", +[](double x) { return std::sqrt(x); });
  parser.DefineFun(
      "abs", +[](double x) { return std::abs(x); });
  parser.DefineFun(
      "hypot", +[](double x, double y) { return std::hypot(x, y); });
  parser.DefineFun(
      "min", +[](double x, double y) { return std::min(x, y); });
  parser.DefineFun(
      "max", +[](double x, double y) { return std::max(x, y); });
  return parser;
}

/// One compiled text. Names are bound to slots, filled before each evaluation.
struct Compiled {
  mu::Parser parser;
  std::vector<std::string> names;
  std::vector<double> slots;
};

std::unique_ptr<Compiled> compile_expression(const std::string& text, bool degrees) {
  static thread_local const mu::Parser kDegrees = bare_parser(true), kRadians = bare_parser(false);
  auto compiled =
      std::make_unique<Compiled>(Compiled{degrees ? kDegrees : kRadians, names_in(text), {}});
  std::ranges::sort(compiled->names);
  const auto repeated = std::ranges::unique(compiled->names);
  compiled->names.erase(repeated.begin(), repeated.end());
  compiled->slots.resize(compiled->names.size(), 1);
  for (std::size_t i = 0; i < compiled->names.size(); ++i)
    compiled->parser.DefineVar(compiled->names[i], &compiled->slots[i]);
  compiled->parser.SetExpr(text);
  int results = 0;
  compiled->parser.Eval(results);
  if (results != 1) throw mu::Parser::exception_type("must be one expression, not several");
  return compiled;
}

using Cache = std::unordered_map<std::string, std::unique_ptr<Compiled>>;

Cache& compiled_expressions(bool degrees) {
  static thread_local std::array<Cache, 2> caches;
  return caches[degrees];
}

Evaluation failed(std::string error, std::string hint = "") {
  return {std::numeric_limits<double>::quiet_NaN(), std::move(error), std::move(hint)};
}

constexpr std::string_view kPunctuation = " .+-*/^(),";

/// What can be told about the characters of a text; "" when nothing is wrong.
std::string check_characters(const std::string& text) {
  if (text.size() > kLongest)
    return fmt::format("an expression must have at most {} characters", kLongest);
  const auto odd = std::ranges::find_if(
      text, [](char c) { return !in_name(c) && kPunctuation.find(c) == std::string_view::npos; });
  if (odd == text.end()) return "";
  return fmt::format(
      "an expression has numbers, names and + - * / ^ ( ) only; character {} is not allowed",
      odd - text.begin() + 1);
}

std::string no_expression(const mu::Parser::exception_type& error) {
  return "must be an expression without mistakes: " + error.GetMsg();
}

/// What can be told about a text before it is parsed; "" when nothing is wrong.
Evaluation check_text(const std::string& text, const Scope& scope) {
  if (const std::string wrong = check_characters(text); !wrong.empty()) return failed(wrong);
  for (const std::string& name : names_in(text)) {
    if (scope.find(name) != nullptr) continue;
    std::vector<std::string> known(kReserved.begin(), kReserved.end());
    for (const auto& [word, value] : scope.names) known.push_back(word);
    return failed(fmt::format("\"{}\" is neither a parameter nor a function", name),
                  did_you_mean(name, known));
  }
  return {};
}

}  // namespace

const double* Scope::find(std::string_view name) const {
  for (const auto& [word, value] : names)
    if (word == name) return &value;
  return nullptr;
}

Evaluation evaluate(const std::string& text, const Scope& scope) {
  Cache& cache = compiled_expressions(scope.degrees);
  auto found = cache.find(text);
  if (found == cache.end()) {
    if (Evaluation wrong = check_text(text, scope); !wrong.error.empty()) return wrong;
    if (cache.size() >= kMostCompiled) cache.clear();
    try {
      found = cache.emplace(text, compile_expression(text, scope.degrees)).first;
    } catch (const mu::Parser::exception_type& error) {
      return failed(no_expression(error));
    }
  }
  Compiled& compiled = *found->second;
  for (std::size_t i = 0; i < compiled.names.size(); ++i) {
    const double* value = scope.find(compiled.names[i]);
    if (value == nullptr) return check_text(text, scope);
    if (std::isnan(*value)) return {};
    compiled.slots[i] = *value;
  }
  const double value = compiled.parser.Eval();
  if (!std::isfinite(value)) return failed("an expression must give a finite number");
  return {value, "", ""};
}

std::string mistake_in(const std::string& text, bool degrees) {
  if (std::string wrong = check_characters(text); !wrong.empty()) return wrong;
  try {
    compile_expression(text, degrees);
  } catch (const mu::Parser::exception_type& error) {
    return no_expression(error);
  }
  return "";
}

void evaluate(const std::string& text, bool degrees, const Columns& columns, std::size_t count,
              double* values) {
  Cache& cache = compiled_expressions(degrees);
  auto found = cache.find(text);
  if (found == cache.end()) {
    if (cache.size() >= kMostCompiled) cache.clear();
    found = cache.emplace(text, compile_expression(text, degrees)).first;
  }
  Compiled& compiled = *found->second;
  std::vector<std::pair<double*, const double*>> used;
  for (std::size_t k = 0; k < compiled.names.size(); ++k)
    for (const auto& [name, column] : columns)
      if (name == compiled.names[k]) used.emplace_back(&compiled.slots[k], column);
  // muParser's own bulk mode would start threads within ours.
  for (std::size_t i = 0; i < count; ++i) {
    for (const auto& [slot, column] : used) *slot = column[i];
    values[i] = compiled.parser.Eval();
  }
}

std::string with_words(
    std::string_view text,
    const std::function<std::optional<std::string>(const std::string&)>& replace) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    if (starts_name(text[i])) {
      while (end < text.size() && (in_name(text[end]) || text[end] == '.')) ++end;
      const std::string word(text.substr(i, end - i));
      result += is_reserved_name(word) ? word : replace(word).value_or(word);
    } else {
      end += std::max<std::size_t>(1, number_length(text.substr(i)));
      result += text.substr(i, end - i);
    }
    i = end;
  }
  return result;
}

std::vector<std::string> names_in(std::string_view text) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < text.size();) {
    if (starts_name(text[i])) {
      std::size_t end = i;
      while (end < text.size() && in_name(text[end])) ++end;
      if (const auto name = text.substr(i, end - i); !is_reserved_name(name))
        names.emplace_back(name);
      i = end;
    } else {
      i += std::max<std::size_t>(1, number_length(text.substr(i)));
    }
  }
  return names;
}

bool is_reserved_name(std::string_view word) {
  return std::ranges::find(kReserved, word) != kReserved.end();
}

}  // namespace polyglide
