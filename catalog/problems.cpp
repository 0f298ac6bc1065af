#include "catalog/problems.hpp"

#include <algorithm>

namespace polyglide {
namespace {

using nlohmann::json;

/// Appends the way from `node` to `value` to `pointer`; false if it is not below.
bool find(const json& node, const json& value, std::string& pointer) {
  if (&node == &value) return true;
  const std::size_t length = pointer.size();
  const auto descend = [&](const std::string& step, const json& child) {
    pointer += '/' + step;
    if (find(child, value, pointer)) return true;
    pointer.resize(length);
    return false;
  };
  if (node.is_object()) {
    for (const auto& [key, child] : node.items()) {
      std::string step;
      for (const char c : key) step += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
      if (descend(step, child)) return true;
    }
  } else if (node.is_array()) {
    for (std::size_t i = 0; i < node.size(); ++i)
      if (descend(std::to_string(i), node[i])) return true;
  }
  return false;
}

}  // namespace

std::string shown(const json& value) {
  constexpr std::size_t kLongest = 60;
  // Big containers are not written out only to be cut.
  if (value.is_structured() && value.size() > kLongest) return value.is_array() ? "[…]" : "{…}";
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() <= kLongest) return text;
  std::size_t end = kLongest - 1;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end) + "…";
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& words) {
  const std::string nearest = nearest_word(word, words);
  return nearest.empty() ? "" : "did you mean \"" + nearest + "\"?";
}

std::string pointer_to(const json& document, const json& value) {
  std::string pointer;
  return find(document, value, pointer) ? pointer : "";
}

void Problems::add(const json& at, std::string rule, std::string hint) {
  add({file_, pointer_to(document_, at), shown(at), std::move(rule), std::move(hint)});
}

void Problems::add_missing(const json& object, std::string rule) {
  add({file_, pointer_to(document_, object), "", std::move(rule), ""});
}

void Problems::add(Diagnostic diagnostic) {
  if (std::ranges::find(diagnostics_, diagnostic) == diagnostics_.end())
    diagnostics_.push_back(std::move(diagnostic));
}

void Problems::raise() const {
  if (!diagnostics_.empty()) throw InputError(diagnostics_);
}

}  // namespace polyglide
