#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace polyglide {

/// One mistake in the user's input: where it is, what stands there, which rule
/// it breaks and what was probably meant.
struct Diagnostic {
  std::string file;     ///< path as the user gave it; "" for the command line
  std::string pointer;  ///< JSON pointer (RFC 6901) of the place; "" = whole document
  std::string value;    ///< the offending value as JSON text, shortened to 60 characters
  std::string rule;     ///< one sentence: what must hold
  std::string hint;     ///< the likely fix ("did you mean …?"); may be empty

  friend bool operator==(const Diagnostic&, const Diagnostic&) = default;
};

/// "file:/joints/3/type: "revolut" — must be one of …; did you mean "revolute"?"
[[nodiscard]] std::string to_string(const Diagnostic& diagnostic);

/// The user's input is wrong: carries every mistake found, never only the first.
/// The command line turns it into exit status 1.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Diagnostic> diagnostics);
  [[nodiscard]] const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// The word of `words` nearest to `word` by edit distance, or "" when none is
/// near enough to be what was meant (more than a third of the letters differ). Of
/// words equally near the longest, which keeps most of what was typed: "delta1" means
/// "delta-1" rather than "delta".
[[nodiscard]] std::string nearest_word(std::string_view word,
                                       const std::vector<std::string>& words);

}  // namespace polyglide
