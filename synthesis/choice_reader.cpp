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

ChoiceReader::ChoiceReader(const Json& document, Problems& problems)
    : document_(document), problems_(problems) {
  visit_inside(document);
  std::ranges::reverse(finished_);
  for (const Json* choice : finished_) index_.emplace(choice, static_cast<int>(index_.size()));
}

std::vector<Choice> ChoiceReader::choices() const {
  std::vector<Choice> result;
  for (const Json* definition : finished_) result.push_back(read(*definition));
  return result;
}

const Json* ChoiceReader::declared() const {
  const auto found = document_.find("choices");
  return found != document_.end() && found->is_object() ? &*found : nullptr;
}

// What a {"choose": …} node stands for: the entry of `choices`, or the node itself.
const Json* ChoiceReader::definition(const Json& node, bool complain) const {
  const Json& word = node.at("choose");
  if (word.is_array()) return &node;
  if (word.is_string() && declared() != nullptr) {
    const auto found = declared()->find(word.get<std::string>());
    if (found != declared()->end()) return found->is_object() ? &*found : nullptr;
  }
  if (!complain) return nullptr;
  std::vector<std::string> names;
  if (declared() != nullptr)
    for (const auto& entry : declared()->items()) names.push_back(entry.key());
  problems_.add(word, "must name a choice declared under choices, or be a list of options",
                word.is_string() ? did_you_mean(word.get<std::string>(), names) : "");
  return nullptr;
}

const Json* ChoiceReader::options_of(const Json& definition) const {
  const auto found = definition.find(is_choice(definition) ? "choose" : "options");
  return found != definition.end() && found->is_array() ? &*found : nullptr;
}

// Backwards, because the order of choices is the reverse of that in which they are finished.
void ChoiceReader::visit_inside(const Json& value) {
  if (is_choice(value)) return visit(value);
  if (!value.is_structured()) return;
  for (auto child = value.rbegin(); child != value.rend(); ++child)
    if (&value != &document_ || child.key() != "choices") visit_inside(*child);
}

void ChoiceReader::visit(const Json& node) {
  if (node.size() > 1) problems_.add(node, "a choice holds nothing beside \"choose\"");
  const Json* choice = definition(node, true);
  if (choice == nullptr) return;
  if (const auto before = visits_.find(choice); before != visits_.end()) {
    if (before->second == Visit::open) problems_.add(node, "a choice must not contain itself");
    return;
  }
  check(*choice);
  const Json* options = options_of(*choice);
  if (options == nullptr) return;
  options_ += options->size();
  if (visits_.size() >= kMostChoices || options_ > kMostOptions) {
    problems_.add(document_, fmt::format("must hold at most {} choices with {} options in all",
                                         kMostChoices, kMostOptions));
    return;
  }
  visits_[choice] = Visit::open;
  for (auto option = options->rbegin(); option != options->rend(); ++option)
    if (option->is_object() && option->contains("value")) visit_inside(option->at("value"));
  visits_[choice] = Visit::done;
  finished_.push_back(choice);
}

void ChoiceReader::check(const Json& definition) const {
  const Json* options = options_of(definition);
  if (options == nullptr) return problems_.add(definition, "a choice needs a list of options");
  if (options->empty()) problems_.add(*options, "a choice needs at least one option");
  std::set<std::string> labels;
  for (const Json& option : *options) {
    const std::string label = option.is_object() ? text_of(option, "label") : "";
    if (label.empty() || !option.contains("value")) {
      problems_.add(option, "an option needs a \"label\" (text) and a \"value\"");
    } else if (!labels.insert(label).second) {
      problems_.add(option.at("label"), "two options of a choice must not have the same label");
    }
  }
}

Json ChoiceReader::numbered(const Json& value) const {
  if (is_choice(value)) return {{"choose", index_.at(definition(value, false))}};
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
  if (is_choice(value)) return found.push_back(index_.at(definition(value, false)));
  if (!value.is_structured()) return;
  for (auto child = value.begin(); child != value.end(); ++child)
    if (&value != &document_ || child.key() != "choices") collect(*child, found);
}

Choice ChoiceReader::read(const Json& definition) const {
  Choice choice;
  const std::string pointer = pointer_to(document_, definition);
  choice.name = Json::json_pointer(pointer).back();
  if (is_choice(definition)) choice.name = pointer.substr(1);  // written in place
  choice.about = text_of(definition, "about");
  for (const Json& option : *options_of(definition))
    choice.options.push_back({text_of(option, "label"), numbered(option.at("value")),
                              choices_inside(option.at("value"))});
  return choice;
}

}  // namespace polyglide
