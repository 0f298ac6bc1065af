#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "catalog/problems.hpp"
#include "synthesis/space.hpp"

namespace polyglide {

/// Is this value of a document a choice?
[[nodiscard]] bool is_choice(const nlohmann::json& value);

/// The text under a key, "" when there is none.
[[nodiscard]] std::string text_of(const nlohmann::json& object, const char* key);

/// Finds the choices of a space's document and puts them into an order in which
/// every choice comes before those inside its options. All mistakes about
/// choices go to `problems`; the other members may be called only when it is empty.
class ChoiceReader {
 public:
  using Json = nlohmann::json;

  /// Both must outlive the reader, and the document must not change.
  ChoiceReader(const Json& document, Problems& problems);

  /// In that order.
  [[nodiscard]] std::vector<Choice> choices() const;

  /// A part of the document with {"choose": index} for every choice.
  [[nodiscard]] Json numbered(const Json& value) const;

  /// The choices of a part of the document, ascending, each once; not those
  /// inside their options.
  [[nodiscard]] std::vector<int> choices_inside(const Json& value) const;

 private:
  enum class Visit { open, done };

  [[nodiscard]] const Json* declared() const;
  [[nodiscard]] const Json* definition(const Json& node, bool complain) const;
  [[nodiscard]] const Json* options_of(const Json& definition) const;
  void visit_inside(const Json& value);
  void visit(const Json& node);
  void check(const Json& definition) const;
  void collect(const Json& value, std::vector<int>& found) const;
  [[nodiscard]] Choice read(const Json& definition) const;

  const Json& document_;
  Problems& problems_;
  std::map<const Json*, Visit> visits_;
  std::vector<const Json*> finished_;
  std::map<const Json*, int> index_;
  std::size_t options_ = 0;
};

}  // namespace polyglide
