#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "catalog/diagnostics.hpp"
#include "catalog/mechanism.hpp"

namespace polyglide {

enum class Quantity { none, length, angle };

/// A dimension a designer may turn. Values are in the *file's* unit (mm, deg
/// unless the file says otherwise), because expressions are written in it.
struct Parameter {
  std::string name;
  double value = 0;
  double min = 0, max = 0;  ///< bounds for tuning; min == max == value when fixed
  Quantity quantity = Quantity::none;
  std::string about;  ///< what the dimension is, for drawings and tables
};

/// Parameter values by name, in the file's unit. Names left out keep their value.
using ParameterValues = std::map<std::string, double>;

/// A machine as written: a layout file, or a mechanism file, whose numbers may
/// be expressions over `parameters`.
struct Layout {
  std::string name, title, source, about;
  Units units;
  std::vector<Parameter> parameters;  ///< in the order of the file
  nlohmann::json document;            ///< the whole file, validated
  std::string file;                   ///< for messages
};

/// Reads a layout or mechanism file (the "format" word tells which).
/// @throws InputError with every mistake: against the schema, of structure, and of
///         geometry at the parameter values of the file.
[[nodiscard]] Layout load_layout(const std::filesystem::path& file);

/// The same from a document in memory; `file` only labels messages. Parameters
/// come in alphabetical order, because such a document has no other.
[[nodiscard]] Layout parse_layout(nlohmann::json document, const std::string& file);

/// A layout from a document whose words are known to be right (a candidate of a
/// space that was checked): no schema check, no trial expansion. Structure and
/// geometry are checked when it is expanded. Cost: microseconds.
/// @throws InputError: parameter outside its limits, names given twice.
[[nodiscard]] Layout make_layout(nlohmann::json document, const std::string& file);

/// The names used by the expressions of a document or a part of it (parameters
/// and copy variables); words for bodies, joints and directions do not count.
[[nodiscard]] std::set<std::string> used_names(const nlohmann::json& part);

/// Substitutes parameters, evaluates expressions, copies limbs and places
/// carriages so that every rod has its length.
/// @param values overrides of parameter values, file units, inside [min, max]
///        unless min == max (then any value).
/// @throws InputError: unknown parameter, value out of range, expression error,
///         axis of length zero, rod that cannot reach ("loop does not close"), …
/// Cost: about 0.2 ms for a four-limb layout.
[[nodiscard]] Mechanism expand(const Layout& layout, const ParameterValues& values = {});

/// The mechanism as a "polyglide/mechanism/1" document, in its file units.
/// parse_layout + expand of it gives the same mechanism back.
[[nodiscard]] nlohmann::ordered_json to_json(const Mechanism& mechanism);

}  // namespace polyglide
