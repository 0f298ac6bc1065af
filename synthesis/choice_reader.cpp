#include "synthesis/choice_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>

namespace polyglide {

using Json = nlohmann::json;

namespace {
constexpr std::size_t kMostChoices = 500, kMostOptions = 2000;
}

bool is_choice(const Json& value) { return value.is_object() && value.contains("choose"); }

std::string text_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

namespace {

// The list of options of an entry of `choices`, or of a choice written in place.
const Json* list_of(const Json& definition) {
  const auto found = definition.find(is_choice(definition) ? "choose" : "options");
  return found != definition.end() && found->is_array() ? &*found : nullptr;
}

}  // namespace

ChoiceReader::ChoiceReader(const Json& document, Problems& problems)
    : document_(document), problems_(problems) {
  visit_inside(document);
  std::ranges::reverse(finished_);
  for (const Key& key : finished_) index_.emplace(key, static_cast<int>(index_.size()));
  check_names();
}

std::vector<Choice> ChoiceReader::choices() const {
  std::vector<Choice> result;
  for (const Key& key : finished_) result.push_back(read(key));
  return result;
}

const Json* ChoiceReader::declared() const {
  const auto found = document_.find("choices");
  return found != document_.end() && found->is_object() ? &*found : nullptr;
}

// No options when what stands there is not a choice; check_reference() says why.
ChoiceReader::Key ChoiceReader::key_of(const Json& node) const {
  const Json& word = node.at("choose");
  if (word.is_array()) return {&node, text_of(node, "as")};
  if (!word.is_string() || declared() == nullptr) return {};
  const auto found = declared()->find(word.get<std::string>());
  if (found == declared()->end() || !found->is_object()) return {};
  return {&*found, text_of(node, "as")};
}

void ChoiceReader::check_reference(const Json& node) const {
  for (const auto& entry : node.items())
    if (entry.key() != "choose" && entry.key() != "as")
      problems_.add(entry.value(), "a choice holds nothing beside \"choose\" and \"as\"",
                    did_you_mean(entry.key(), {"choose", "as"}));
  if (node.contains("as") && text_of(node, "as").empty())
    problems_.add(node.at("as"), "must be a name for this choice");
  const Json& word = node.at("choose");
  if (key_of(node).options != nullptr) return;
  std::vector<std::string> names;
  if (declared() != nullptr)
    for (const auto& entry : declared()->items()) names.push_back(entry.key());
  problems_.add(word, "must name a choice declared under choices, or be a list of options",
                word.is_string() ? did_you_mean(word.get<std::string>(), names) : "");
}

void ChoiceReader::check_options(const Json& list) const {
  if (list.empty()) problems_.add(list, "a choice needs at least one option");
  std::set<std::string> labels;
  for (const Json& option : list) {
    const std::string label = option.is_object() ? text_of(option, "label") : "";
    if (label.empty() || !option.contains("value")) {
      problems_.add(option, "an option needs a \"label\" (text) and a \"value\"");
    } else if (!labels.insert(label).second) {
      problems_.add(option.at("label"), "two options of a choice must not have the same label");
    }
  }
}

// Backwards, because the order of choices is the reverse of that in which they are finished.
void ChoiceReader::visit_inside(const Json& value) {
  if (is_choice(value)) return visit(value);
  if (!value.is_structured()) return;
  for (auto child = value.rbegin(); child != value.rend(); ++child)
    if (&value != &document_ || child.key() != "choices") visit_inside(*child);
}

void ChoiceReader::visit(const Json& node) {
  check_reference(node);
  const Key key = key_of(node);
  if (key.options == nullptr) return;
  if (const auto before = visits_.find(key); before != visits_.end()) {
    if (before->second == Visit::open) problems_.add(node, "a choice must not contain itself");
    return;
  }
  const Json* list = list_of(*key.options);
  if (list == nullptr) return problems_.add(*key.options, "a choice needs a list of options");
  check_options(*list);
  options_ += list->size();
  if (visits_.size() >= kMostChoices || options_ > kMostOptions)
    return problems_.add(document_, fmt::format("must hold at most {} choices with {} options in "
                                                "all",
                                                kMostChoices, kMostOptions));
  visits_[key] = Visit::open;
  for (auto option = list->rbegin(); option != list->rend(); ++option)
    if (option->is_object() && option->contains("value")) visit_inside(option->at("value"));
  visits_[key] = Visit::done;
  finished_.push_back(key);
}

// Candidates tell their choices by name.
void ChoiceReader::check_names() const {
  std::set<std::string> names;
  for (const Key& key : finished_)
    if (!names.insert(name_of(key)).second)
      problems_.add(*key.options,
                    fmt::format("two choices must not both be called \"{}\"", name_of(key)));
}

Json ChoiceReader::numbered(const Json& value) const {
  if (is_choice(value)) return {{"choose", index_.at(key_of(value))}};
  if (!value.is_structured()) return value;
  Json result = value;
  for (auto child = result.begin(); child != result.end(); ++child) {
    const Json& original =
        value.is_object() ? value.at(child.key()) : value[child - result.begin()];
    *child = numbered(original);
  }
  return result;
}

std::vector<int> ChoiceReader::choices_inside(const Json& value) const {
  std::vector<int> found;
  collect(value, found);
  std::ranges::sort(found);
  const auto repeated = std::ranges::unique(found);
  found.erase(repeated.begin(), repeated.end());
  return found;
}

void ChoiceReader::collect(const Json& value, std::vector<int>& found) const {
  if (is_choice(value)) return found.push_back(index_.at(key_of(value)));
  if (!value.is_structured()) return;
  for (auto child = value.begin(); child != value.end(); ++child)
    if (&value != &document_ || child.key() != "choices") collect(*child, found);
}

// One written in place and not named goes by its place.
std::string ChoiceReader::name_of(const Key& key) const {
  if (!key.as.empty()) return key.as;
  const std::string pointer = pointer_to(document_, *key.options);
  if (pointer.empty()) return "";
  return is_choice(*key.options) ? pointer.substr(1) : Json::json_pointer(pointer).back();
}

Choice ChoiceReader::read(const Key& key) const {
  Choice choice;
  choice.name = name_of(key);
  choice.about = text_of(*key.options, "about");
  for (const Json& option : *list_of(*key.options))
    choice.options.push_back({text_of(option, "label"), numbered(option.at("value")),
                              choices_inside(option.at("value"))});
  return choice;
}

}  // namespace polyglide
