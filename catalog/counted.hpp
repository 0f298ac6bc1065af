#pragma once

#include <string>
#include <string_view>

namespace polyglide {

/// A count with its noun, for sentences: "1 freedom", "3 freedoms", "0 families".
/// @param plural of a noun that does not just take an s.
template <typename Count>
[[nodiscard]] std::string counted(Count count, std::string_view noun,
                                  std::string_view plural = "") {
  std::string words = std::to_string(count) + ' ';
  if (count == 1 || plural.empty()) words += noun;
  if (count != 1) words += plural.empty() ? "s" : plural;
  return words;
}

}  // namespace polyglide
