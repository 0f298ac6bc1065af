#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <regex>

#include "catalog/catalog.hpp"
#include "catalog/json_file.hpp"
#include "catalog/problems.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

/// A shipped schema, read once per process.
const json& schema_named(const std::string& name) {
  static std::mutex mutex;
  static std::map<std::string, json> schemas;
  const std::lock_guard lock(mutex);
  auto found = schemas.find(name);
  if (found == schemas.end()) {
    const auto file = data_directory() / "catalog" / "schema" / (name + ".schema.json");
    found = schemas.emplace(name, read_json(file)).first;
  }
  return found->second;
}

bool has_type(const json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "number") return value.is_number();
  if (type == "integer") return value.is_number_integer();
  if (type == "boolean") return value.is_boolean();
  return type == "null" && value.is_null();
}

bool matches(const std::string& pattern, const std::string& name) {
  constexpr std::size_t kLongestName = 100;  // std::regex recurses once per character
  return name.size() <= kLongestName && std::regex_search(name, std::regex(pattern));
}

/// "object", or "number or string" for a list.
std::string words(const json& list, const char* last_separator) {
  if (!list.is_array()) return list.get<std::string>();
  std::string text;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (i > 0) text += i + 1 == list.size() ? last_separator : ", ";
    text += list[i].is_string() ? list[i].get<std::string>() : list[i].dump();
  }
  return text;
}

std::vector<std::string> strings(const json& list) {
  std::vector<std::string> result;
  for (const json& value : list)
    if (value.is_string()) result.push_back(value.get<std::string>());
  return result;
}

/// A part of a schema that may be absent, without copying it.
const json& part(const json& schema, const char* keyword) {
  static const json kNothing = json::object();
  const auto found = schema.find(keyword);
  return found == schema.end() ? kNothing : *found;
}

/// One pass over a document. Each method checks one group of keywords of JSON
/// Schema draft-07 and appends what it finds.
class Checker {
 public:
  Checker(const json& root, const std::string& file) : root_(root), file_(file) {}

  std::vector<Diagnostic> run(const json& document) {
    check(document, root_, "", "");
    return std::move(found_);
  }

 private:
  void check(const json& value, const json& schema, const std::string& pointer,
             const std::string& about) {
    if (schema.is_boolean()) return;
    const std::string description = schema.value("description", about);
    if (const auto ref = schema.find("$ref"); ref != schema.end())
      return check(value, root_.at(json::json_pointer(ref->get<std::string>().substr(1))), pointer,
                   about.empty() ? description : about);
    about_ = about.empty() ? description : about;
    if (!check_type(value, schema, pointer)) return;
    check_words(value, schema, pointer);
    check_size(value, schema, pointer);
    check_branches(value, schema, pointer);
    if (value.is_object()) check_object(value, schema, pointer);
    if (value.is_array()) check_array(value, schema, pointer);
  }

  void add(const json& value, const std::string& pointer, std::string rule, std::string hint = "") {
    if (!about_.empty()) rule += " (" + about_ + ")";
    found_.push_back({file_, pointer, shown(value), std::move(rule), std::move(hint)});
  }

  bool check_type(const json& value, const json& schema, const std::string& pointer) {
    const auto type = schema.find("type");
    if (type == schema.end()) return true;
    if (type->is_string() && has_type(value, *type)) return true;
    if (type->is_array())
      for (const json& one : *type)
        if (has_type(value, one)) return true;
    add(value, pointer, "must be of type " + words(*type, " or "));
    return false;
  }

  void check_words(const json& value, const json& schema, const std::string& pointer) {
    if (const auto only = schema.find("const"); only != schema.end() && value != *only)
      add(value, pointer, "must be " + only->dump(),
          value.is_string() ? did_you_mean(value.get<std::string>(), strings({*only})) : "");
    const auto list = schema.find("enum");
    if (list == schema.end()) return;
    for (const json& word : *list)
      if (value == word) return;
    add(value, pointer, "must be one of " + words(*list, " or "),
        value.is_string() ? did_you_mean(value.get<std::string>(), strings(*list)) : "");
  }

  void check_size(const json& value, const json& schema, const std::string& pointer) {
    const auto rule = [&](const char* keyword, double measure, auto broken, const char* text) {
      const auto bound = schema.find(keyword);
      if (bound != schema.end() && broken(measure, bound->get<double>()))
        add(value, pointer, fmt::format("{} {}", text, bound->dump()));
    };
    if (value.is_number()) {
      const double number = value.get<double>();
      rule("minimum", number, std::less<>(), "must be at least");
      rule("maximum", number, std::greater<>(), "must be at most");
      rule("exclusiveMinimum", number, std::less_equal<>(), "must be greater than");
    }
    const auto size = static_cast<double>(
        value.is_string() ? value.get_ref<const std::string&>().size() : value.size());
    if (value.is_string()) {
      rule("minLength", size, std::less<>(), "the least number of characters is");
    } else if (value.is_array()) {
      rule("minItems", size, std::less<>(), "the least number of entries is");
      rule("maxItems", size, std::greater<>(), "the greatest number of entries is");
    } else if (value.is_object()) {
      rule("minProperties", size, std::less<>(), "the least number of entries is");
    }
  }

  /// anyOf: one branch must hold. When none does, the mistakes of the branch that
  /// was probably meant are told. oneOf: our schemas use it only for groups of
  /// members of which exactly one must be there.
  void check_branches(const json& value, const json& schema, const std::string& pointer) {
    if (const auto branches = schema.find("anyOf"); branches != schema.end())
      check_any(value, *branches, pointer);
    if (const auto groups = schema.find("oneOf"); groups != schema.end() && value.is_object())
      check_groups(value, *groups, pointer);
  }

  void check_any(const json& value, const json& branches, const std::string& pointer) {
    const std::string about = about_;
    std::vector<Diagnostic> outside = std::move(found_);
    std::vector<Diagnostic> meant;
    bool holds = false;
    for (const json& branch : branches) {
      found_.clear();
      check(value, branch, pointer, "");
      holds = holds || found_.empty();
      const bool wrong_kind = found_.size() == 1 && found_[0].pointer == pointer &&
                              found_[0].rule.starts_with("must be of type");
      if (!wrong_kind && (meant.empty() || found_.size() < meant.size())) meant = found_;
    }
    found_ = std::move(outside);
    about_ = about;
    if (holds) return;
    if (meant.empty())
      add(value, pointer, "has the wrong form");
    else
      found_.insert(found_.end(), meant.begin(), meant.end());
  }

  void check_groups(const json& value, const json& groups, const std::string& pointer) {
    int complete = 0;
    std::string rule = "exactly one of these must be given:";
    for (const json& group : groups) {
      const std::vector<std::string> names = strings(group.at("required"));
      complete +=
          std::ranges::all_of(names, [&](const auto& name) { return value.contains(name); });
      rule += fmt::format("{} {}", &group == &groups.front() ? "" : ",",
                          words(group["required"], " with "));
    }
    if (complete != 1) add(value, pointer, rule);
  }

  void check_object(const json& value, const json& schema, const std::string& pointer) {
    const std::string about = about_;
    const json& properties = part(schema, "properties");
    for (const json& name : part(schema, "required")) {
      if (value.contains(name.get<std::string>())) continue;
      about_ = properties.value(name, json::object()).value("description", "");
      add_missing(name, pointer);
    }
    for (const auto& [name, member] : value.items()) {
      about_ = about;
      check_member(name, member, value, schema, properties, pointer);
    }
    about_ = about;
  }

  void add_missing(const std::string& name, const std::string& pointer) {
    add(nullptr, pointer, "\"" + name + "\" must be given");
    found_.back().value.clear();
  }

  void check_member(const std::string& name, const json& member, const json& object,
                    const json& schema, const json& properties, const std::string& pointer) {
    std::string step;
    for (const char c : name) step += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    const std::string place = pointer + '/' + step;
    if (const auto known = properties.find(name); known != properties.end())
      return check(member, *known, place, "");
    for (const auto& [pattern, sub] : part(schema, "patternProperties").items())
      if (matches(pattern, name)) return check(member, sub, place, "");
    const auto additional = schema.find("additionalProperties");
    if (additional == schema.end() || *additional == true) return;
    if (additional->is_object()) return check(member, *additional, place, "");
    std::vector<std::string> unused;
    for (const auto& [word, sub] : properties.items())
      if (!object.contains(word)) unused.push_back(word);
    about_.clear();
    add(member, place, fmt::format("the name \"{}\" has no meaning here", name),
        did_you_mean(name, unused));
  }

  void check_array(const json& value, const json& schema, const std::string& pointer) {
    const auto items = schema.find("items");
    if (items == schema.end()) return;
    const std::string about = about_;
    for (std::size_t i = 0; i < value.size(); ++i)
      check(value[i], *items, pointer + '/' + std::to_string(i), "");
    about_ = about;
  }

  const json& root_;
  const std::string& file_;
  std::string about_;  ///< description of the schema being checked, for the rule
  std::vector<Diagnostic> found_;
};

}  // namespace

std::vector<Diagnostic> check_schema(const json& document, const std::string& schema,
                                     const std::string& file) {
  return Checker(schema_named(schema), file).run(document);
}

}  // namespace polyglide
