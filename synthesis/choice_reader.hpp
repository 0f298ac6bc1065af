#pragma once

#include <compare>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
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
  /// What makes a choice: where its options are written, and the name under which
  /// they are chosen ("" unless one is given).
  struct Key {
    const Json* options = nullptr;  ///< the entry of `choices`, or the choice itself
    std::string as;
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  enum class Visit { open, done };

  [[nodiscard]] const Json* declared() const;
  [[nodiscard]] Key key_of(const Json& node) const;
  void check_reference(const Json& node) const;
  void check_options(const Json& list) const;
  void visit_inside(const Json& value);
  void visit(const Json& node);
  void check_names() const;
  void collect(const Json& value, std::vector<int>& found) const;
  [[nodiscard]] std::string name_of(const Key& key) const;
  [[nodiscard]] Choice read(const Key& key) const;

  const Json& document_;
  Problems& problems_;
  std::map<Key, Visit> visits_;
  std::vector<Key> finished_;
  std::map<Key, int> index_;
  std::size_t options_ = 0;
};

}  // namespace polyglide
