#include "catalog/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "catalog/draft.hpp"
#include "catalog/json_file.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

constexpr const char* kMechanismFormat = "polyglide/mechanism/1";
constexpr const char* kLayoutFormat = "polyglide/layout/1";

Units read_units(const json& value) {
  static const std::map<std::string, double> kLengths = {
      {"mm", 1e-3}, {"cm", 1e-2}, {"m", 1.0}, {"in", 0.0254}};
  Units units;
  if (const auto found = kLengths.find(text(member(value, "length"))); found != kLengths.end()) {
    units.length = found->first;
    units.metres = found->second;
  }
  if (text(member(value, "angle")) == "rad") {
    units.angle = "rad";
    units.radians = 1;
  }
  return units;
}

Parameter read_parameter(const std::string& name, const json& value, Problems& problems) {
  Parameter parameter;
  parameter.name = name;
  const json& number = value.is_object() ? member(value, "value") : value;
  parameter.value = number.is_number() ? number.get<double>() : 0;
  parameter.min = parameter.max = parameter.value;
  const json& min = member(value, "min");
  const json& max = member(value, "max");
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  if (min.is_number() || max.is_number()) {
    parameter.min = min.is_number() ? min.get<double>() : -kUnlimited;
    parameter.max = max.is_number() ? max.get<double>() : kUnlimited;
    if (parameter.min > parameter.max)
      problems.add(value, "min must not be greater than max");
    else if (parameter.value < parameter.min || parameter.value > parameter.max)
      problems.add(number, fmt::format("the parameter \"{}\" must lie in [{:.12g}, {:.12g}]", name,
                                       parameter.min, parameter.max));
  }
  const std::string unit = text(member(value, "unit"));
  parameter.quantity = unit == "length"  ? Quantity::length
                       : unit == "angle" ? Quantity::angle
                                         : Quantity::none;
  parameter.about = text(member(value, "about"));
  return parameter;
}

/// Names of parameters, derived dimensions and copy variables share one scope.
void check_scope_names(const json& document, Problems& problems) {
  const json& parameters = member(document, "parameters");
  const json& derived = member(document, "derived");
  const auto check_free = [&](const std::string& name, const json& value) {
    if (is_reserved_name(name))
      problems.add(value, fmt::format("\"{}\" is a function or constant of expressions and cannot "
                                      "name anything else",
                                      name));
  };
  const auto check_new = [&](const json& names, const json& taken, const char* by) {
    for (const auto& [name, value] : names.items())
      if (taken.is_object() && taken.contains(name))
        problems.add(value,
                     fmt::format("the name \"{}\" is given twice: {} has it, too", name, by));
  };
  for (const json* names : {&parameters, &derived})
    if (names->is_object())
      for (const auto& [name, value] : names->items()) check_free(name, value);
  if (derived.is_object()) check_new(derived, parameters, "a parameter");

  std::vector<std::string> limb_names;
  for (const json& limb : member(document, "limbs")) {
    const json& name = member(limb, "name");
    if (std::ranges::find(limb_names, text(name)) != limb_names.end())
      problems.add(name, "the name of this limb is given twice");
    limb_names.push_back(text(name));
    const json& copies = member(limb, "copies");
    if (!copies.is_object()) continue;
    for (const auto& [variable, value] : copies.items()) check_free(variable, value);
    check_new(copies, parameters, "a parameter");
    check_new(copies, derived, "a derived dimension");
  }
}

Layout make(json document, const std::string& file, std::vector<Diagnostic>& mistakes) {
  Layout layout;
  layout.document = std::move(document);
  layout.file = file;
  Problems problems(layout.document, file);
  layout.name = text(member(layout.document, "name"));
  layout.title = text(member(layout.document, "title"));
  layout.source = text(member(layout.document, "source"));
  layout.about = text(member(layout.document, "about"));
  layout.units = read_units(member(layout.document, "units"));
  const json& parameters = member(layout.document, "parameters");
  if (parameters.is_object())
    for (const auto& [name, value] : parameters.items())
      layout.parameters.push_back(read_parameter(name, value, problems));
  check_scope_names(layout.document, problems);
  mistakes.insert(mistakes.end(), problems.diagnostics().begin(), problems.diagnostics().end());
  return layout;
}

/// The schema of the document's format; a wrong word is told, and the schema that
/// comes nearest taken, so that the rest can be checked.
std::string schema_of(const json& document, const std::string& file,
                      std::vector<Diagnostic>& mistakes) {
  const json& format = member(document, "format");
  if (format == kMechanismFormat) return "mechanism-1";
  if (format == kLayoutFormat) return "layout-1";
  if (!format.is_null())
    mistakes.push_back({file, "/format", shown(format),
                        fmt::format("must be \"{}\" or \"{}\"", kMechanismFormat, kLayoutFormat),
                        did_you_mean(text(format), {kMechanismFormat, kLayoutFormat})});
  return member(document, "limbs").is_null() ? "mechanism-1" : "layout-1";
}

bool holds_word(const std::string& key) {
  static constexpr std::array kWords = {
      "name", "title", "about",   "source",    "label",     "format", "units",    "joint",  "type",
      "form", "side",  "between", "body",      "unit",      "base",   "platform", "points", "axis",
      "axes", "along", "toward",  "direction", "cone_axis", "choose", "$schema",  "of",     "mesh"};
  return std::ranges::find(kWords, key) != kWords.end();
}

void collect_names(const json& part, const std::string& key, std::set<std::string>& names) {
  if (part.is_string()) {
    if (holds_word(key)) return;
    for (std::string& name : names_in(part.get_ref<const std::string&>()))
      names.insert(std::move(name));
  } else if (part.is_object()) {
    for (const auto& [name, value] : part.items()) collect_names(value, name, names);
  } else if (part.is_array()) {
    // Coordinates of an axis are expressions again; the two axes of a cross may be words.
    const bool words = key == "axes" || key == "between";
    for (const json& value : part)
      collect_names(value, words && value.is_string() ? key : "", names);
  }
}

}  // namespace

Layout parse_layout(json document, const std::string& file) {
  std::vector<Diagnostic> mistakes;
  const std::string schema = schema_of(document, file, mistakes);
  const bool known_format = mistakes.empty();
  for (Diagnostic& violation : check_schema(document, schema, file))
    if (known_format || violation.pointer != "/format") mistakes.push_back(std::move(violation));
  Layout layout = make(std::move(document), file, mistakes);
  Problems problems(layout.document, file);
  for (Diagnostic& mistake : mistakes) problems.add(std::move(mistake));
  static_cast<void>(assemble(layout, {}, problems));
  problems.raise();
  return layout;
}

Layout make_layout(json document, const std::string& file) {
  std::vector<Diagnostic> mistakes;
  Layout layout = make(std::move(document), file, mistakes);
  if (!mistakes.empty()) throw InputError(mistakes);
  return layout;
}

Layout load_layout(const std::filesystem::path& file) {
  const std::string content = read_text(file);
  Layout layout = parse_layout(parse_json(content, file.string()), file.string());
  // A json value sorts its names; people want their parameters in their order.
  const auto written = nlohmann::ordered_json::parse(content);
  if (!written.contains("parameters")) return layout;
  std::vector<std::string> order;
  for (const auto& [name, value] : written["parameters"].items()) order.push_back(name);
  std::ranges::sort(layout.parameters, {}, [&](const Parameter& parameter) {
    return std::ranges::find(order, parameter.name) - order.begin();
  });
  return layout;
}

std::set<std::string> used_names(const json& part) {
  std::set<std::string> names;
  collect_names(part, "", names);
  return names;
}

}  // namespace polyglide
