#include "synthesis/space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "catalog/catalog.hpp"
#include "catalog/json_file.hpp"
#include "catalog/layout.hpp"
#include "catalog/problems.hpp"
#include "synthesis/choice_reader.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostStates = 100'000;    // of the counting below
constexpr std::uint64_t kMostValues = 100'000;  // of one layout
constexpr std::uint64_t kMostCandidates = std::uint64_t{1} << 53;

// Ascending union of two ascending lists.
std::vector<int> united(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> result;
  std::ranges::set_union(a, b, std::back_inserter(result));
  return result;
}

// The choices still to be made when, of an ascending list, the first takes an option.
std::vector<int> after_taking(const Choice::Option& option, const std::vector<int>& open) {
  return united({open.begin() + 1, open.end()}, option.choices);
}

// Number of ways to make all of `open`, remembering those of every shorter list
// on the way. What has been made need not be remembered: in the order of
// choices, none comes up again once it is made.
std::uint64_t count(Space& space, const std::vector<int>& open) {
  if (const auto known = space.ways.find(open); known != space.ways.end()) return known->second;
  std::uint64_t sum = open.empty() ? 1 : 0;
  if (!open.empty() && space.ways.size() < kMostStates)
    for (const auto& option : space.choices[open.front()].options)
      sum = std::min(sum + count(space, after_taking(option, open)), kMostCandidates + 1);
  return space.ways[open] = sum;
}

void count_all(Space& space, Problems& problems, const Json& document) {
  const std::uint64_t raw = count(space, space.choices_in_document);
  if (space.ways.size() >= kMostStates)
    problems.add(document, "the choices depend on each other in too many ways to count",
                 "use the same choice in fewer places");
  else if (raw > kMostCandidates)
    problems.add(document, "must hold at most 2^53 combinations");
}

// The most values a part of the document can grow to when its choices are made.
std::uint64_t grown_size(const Json& value, const std::vector<std::uint64_t>& of_choice) {
  if (is_choice(value)) return of_choice[value.at("choose").get<int>()];
  std::uint64_t sum = 1;
  if (value.is_structured())
    for (const Json& child : value) sum += grown_size(child, of_choice);
  return std::min(sum, kMostValues + 1);
}

// A short file can describe an endless layout: choices that hold the next one twice.
void refuse_huge(const Space& space, Problems& problems, const Json& document) {
  std::vector<std::uint64_t> of_choice(space.choices.size(), 0);
  for (auto choice = space.choices.size(); choice-- > 0;)
    for (const auto& option : space.choices[choice].options)
      of_choice[choice] = std::max(of_choice[choice], grown_size(option.value, of_choice));
  if (grown_size(space.document, of_choice) > kMostValues)
    problems.add(document,
                 fmt::format("a layout of the space must hold at most {} values", kMostValues));
}

// Every option stands in its place, all the way down.
Json with_options(const Space& space, const Json& value, const std::vector<int>& taken) {
  if (is_choice(value)) {
    const int choice = value.at("choose").get<int>();
    return with_options(space, space.choices[choice].options[taken[choice]].value, taken);
  }
  if (!value.is_structured()) return value;
  Json result = value;
  for (Json& child : result) child = with_options(space, child, taken);
  return result;
}

// Which option each choice takes (-1: the choice does not come up).
std::vector<int> taken_at(const Space& space, std::uint64_t index) {
  if (index >= raw_count(space))
    throw std::out_of_range(fmt::format("raw candidate {} of {}", index, raw_count(space)));
  std::vector<int> taken(space.choices.size(), -1);
  std::vector<int> open = space.choices_in_document;
  while (!open.empty()) {
    const int choice = open.front();
    for (const auto& option : space.choices[choice].options) {
      auto rest = after_taking(option, open);
      ++taken[choice];
      if (const std::uint64_t ways = space.ways.at(rest); index >= ways) {
        index -= ways;
      } else {
        open = std::move(rest);
        break;
      }
    }
  }
  return taken;
}

// First options everywhere, but such that `choice` comes up and takes `option`.
std::vector<int> taken_with(const Space& space, int choice, int option) {
  std::vector<int> taken(space.choices.size(), 0);
  taken[choice] = option;
  for (int wanted = choice, other = choice - 1; other >= 0; --other) {
    if (std::ranges::binary_search(space.choices_in_document, wanted)) break;
    const auto& options = space.choices[other].options;
    const auto holder = std::ranges::find_if(options, [&](const Choice::Option& candidate) {
      return std::ranges::binary_search(candidate.choices, wanted);
    });
    if (holder == options.end()) continue;
    taken[other] = static_cast<int>(holder - options.begin());
    wanted = other;
  }
  return taken;
}

void drop_unused_parameters(Json& layout) {
  const auto parameters = layout.find("parameters");
  if (parameters == layout.end() || !parameters->is_object()) return;
  const std::set<std::string> used = used_names(layout);
  for (auto entry = parameters->begin(); entry != parameters->end();)
    entry = used.contains(entry.key()) ? std::next(entry) : parameters->erase(entry);
}

// Mistakes in one layout, as if it came from a file. Its geometry is not looked
// at: that some candidates cannot be assembled is a result, not a mistake.
std::vector<Diagnostic> mistakes_of(const Json& layout, const std::string& file) {
  std::vector<Diagnostic> found = check_schema(layout, "layout-1", file);
  try {
    (void)make_layout(layout, file);
  } catch (const InputError& error) {
    found.insert(found.end(), error.diagnostics().begin(), error.diagnostics().end());
  }
  return found;
}

// One layout for every option of every choice is checked; a mistake common to
// several is told once.
std::vector<Diagnostic> check_options(const Space& space) {
  std::vector<Diagnostic> result;
  std::set<std::tuple<std::string, std::string, std::string>> told;
  const auto check = [&](const std::string& label, const std::vector<int>& taken) {
    const Json layout = with_options(space, space.document, taken);
    for (const Diagnostic& mistake : mistakes_of(layout, space.file + label))
      if (told.emplace(mistake.pointer, mistake.value, mistake.rule).second)
        result.push_back(mistake);
  };
  check("", std::vector<int>(space.choices.size(), 0));
  for (int choice = 0; choice < static_cast<int>(space.choices.size()); ++choice) {
    const auto& options = space.choices[choice].options;
    for (int option = 0; option < static_cast<int>(options.size()); ++option)
      check(fmt::format(" ({} = {})", space.choices[choice].name, options[option].label),
            taken_with(space, choice, option));
  }
  return result;
}

void read_known(Space& space, const Json& document, Problems& problems) {
  const auto known = document.find("known");
  if (known == document.end() || !known->is_array()) return;
  const auto names = catalog_names();
  for (const Json& name : *known) {
    if (!name.is_string()) continue;  // told by the schema
    space.known.push_back(name.get<std::string>());
    if (!std::ranges::count(names, space.known.back()))
      problems.add(name, "must be the name of a catalog entry",
                   did_you_mean(space.known.back(), names));
  }
}

}  // namespace

Space parse_space(Json document, const std::string& file) {
  std::vector<Diagnostic> wrong = check_schema(document, "space-1", file);
  if (!document.is_object()) throw InputError(wrong);
  Problems problems(document, file);
  const ChoiceReader reader(document, problems);

  Space space;
  space.name = text_of(document, "name");
  space.title = text_of(document, "title");
  space.about = text_of(document, "about");
  space.file = file;
  space.hash = content_hash(document.dump());
  read_known(space, document, problems);
  wrong.insert(wrong.end(), problems.diagnostics().begin(), problems.diagnostics().end());
  if (!wrong.empty()) throw InputError(wrong);

  space.choices = reader.choices();
  space.choices_in_document = reader.choices_inside(document);
  count_all(space, problems, document);
  problems.raise();

  for (const auto& entry : document.items())
    if (entry.key() != "choices" && entry.key() != "known")
      space.document[entry.key()] = reader.numbered(entry.value());
  space.document["format"] = "polyglide/layout/1";
  refuse_huge(space, problems, document);
  problems.raise();
  wrong = check_options(space);
  if (!wrong.empty()) throw InputError(wrong);
  return space;
}

Space load_space(const std::filesystem::path& file) {
  return parse_space(read_json(file), file.string());
}

std::uint64_t raw_count(const Space& space) { return space.ways.at(space.choices_in_document); }

RawCandidate raw_candidate(const Space& space, std::uint64_t index) {
  const std::vector<int> taken = taken_at(space, index);
  RawCandidate candidate;
  candidate.index = index;
  candidate.layout = with_options(space, space.document, taken);
  drop_unused_parameters(candidate.layout);
  for (std::size_t choice = 0; choice < taken.size(); ++choice)
    if (taken[choice] >= 0)
      candidate.choices[space.choices[choice].name] =
          space.choices[choice].options[taken[choice]].label;
  return candidate;
}

}  // namespace polyglide
