#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catalog/diagnostics.hpp"

namespace polyglide {

/// JSON text of a value for a message: at most 60 characters, "…" when cut.
[[nodiscard]] std::string shown(const nlohmann::json& value);

/// "did you mean "word"?" for the nearest of `words`, or "" when none is near.
[[nodiscard]] std::string did_you_mean(std::string_view word,
                                       const std::vector<std::string>& words);

/// The JSON pointer of a value that is part of `document`, found by its address,
/// so that reading code need not carry its place along; "" when it is not part.
[[nodiscard]] std::string pointer_to(const nlohmann::json& document, const nlohmann::json& value);

/// Collects the mistakes found while one document is read. The same mistake met
/// again (in another copy of a limb) is kept once.
class Problems {
 public:
  /// `document` must outlive this and not change meanwhile.
  Problems(const nlohmann::json& document, std::string file)
      : document_(document), file_(std::move(file)) {}

  /// A value of the document is wrong.
  void add(const nlohmann::json& at, std::string rule, std::string hint = "");
  /// A mistake with its place already known.
  void add(Diagnostic diagnostic);
  /// `object` lacks something: points at it, shows no value.
  void add_missing(const nlohmann::json& object, std::string rule);

  [[nodiscard]] bool empty() const { return diagnostics_.empty(); }
  [[nodiscard]] const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }
  /// @throws InputError with everything collected, if anything was.
  void raise() const;

 private:
  const nlohmann::json& document_;
  std::string file_;
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace polyglide
