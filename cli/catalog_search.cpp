#include "cli/catalog_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <set>

#include "catalog/architecture.hpp"
#include "catalog/problems.hpp"

namespace polyglide {
namespace {

constexpr std::string_view kMotionLetters = "XYZABC";
constexpr std::string_view kJointLetters = "RPHCUSEW";

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool is_pattern(const std::string& word) {
  const auto count = [](char c) { return c >= '0' && c <= '3'; };
  return word.size() == 4 && count(word[0]) && word[1] == 'T' && count(word[2]) && word[3] == 'R';
}

/// Letters of XYZABC, each at most once.
bool are_letters(const std::string& word) {
  return !word.empty() && std::set<char>(word.begin(), word.end()).size() == word.size() &&
         word.find_first_not_of(kMotionLetters) == std::string::npos;
}

/// In the order of XYZABC, with A for B where that is the only rotation.
std::string in_order(const std::string& letters) {
  std::string sorted;
  for (const char c : kMotionLetters)
    if (letters.find(c) != std::string::npos) sorted += c;
  const bool single = sorted.find_first_of("AC") == std::string::npos;
  if (const auto b = sorted.find('B'); single && b != std::string::npos) sorted[b] = 'A';
  return sorted;
}

bool motion_fits(const std::string& motion, const CatalogRow& row) {
  return is_pattern(motion) ? row.motion == motion : in_order(row.axes) == in_order(motion);
}

bool drive_type_fits(const std::string& type, const CatalogRow& row) {
  const auto kinds = drive_kinds(row.machine.mechanism);
  return !kinds.empty() &&
         std::ranges::all_of(kinds, [&](const std::string& kind) { return kind == type; });
}

bool limb_fits(const std::string& limb, const CatalogRow& row) {
  const auto words = limb_words(row.architecture);
  return std::ranges::find(words, limb) != words.end();
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : text + ' ') {
    if (std::isspace(static_cast<unsigned char>(c)) == 0) {
      word += c;
    } else if (!word.empty()) {
      words.push_back(std::move(word));
      word.clear();
    }
  }
  return words;
}

std::string text_of(const CatalogRow& row) {
  const Layout& layout = row.machine.layout;
  return lower(layout.name + ' ' + layout.title + ' ' + layout.source + ' ' + layout.about);
}

bool search_fits(const std::string& search, const CatalogRow& row) {
  const std::string text = text_of(row);
  return std::ranges::all_of(words_of(lower(search)), [&](const std::string& word) {
    return text.find(word) != std::string::npos;
  });
}

/// One condition of a query, by itself.
struct Condition {
  std::string option, value;
  std::function<bool(const CatalogRow&)> fits;
  std::function<std::vector<std::string>(const CatalogRow&)> offers;  ///< words that would fit
};

std::vector<Condition> conditions_of(const CatalogQuery& query) {
  std::vector<Condition> conditions;
  if (!query.motion.empty())
    conditions.push_back({"--motion", query.motion,
                          [&](const CatalogRow& row) { return motion_fits(query.motion, row); },
                          [&](const CatalogRow& row) {
                            return std::vector{is_pattern(query.motion) ? row.motion : row.axes};
                          }});
  if (!query.drives.empty())
    conditions.push_back({"--drives", query.drives,
                          [count = std::stoull(query.drives)](const CatalogRow& row) {
                            return drive_kinds(row.machine.mechanism).size() == count;
                          },
                          [](const CatalogRow&) { return std::vector<std::string>{}; }});
  if (!query.drive_type.empty())
    conditions.push_back(
        {"--drive-type", query.drive_type,
         [&](const CatalogRow& row) { return drive_type_fits(query.drive_type, row); },
         [](const CatalogRow&) { return std::vector<std::string>{}; }});
  if (!query.limb.empty())
    conditions.push_back({"--limb", query.limb,
                          [&](const CatalogRow& row) { return limb_fits(query.limb, row); },
                          [](const CatalogRow& row) { return limb_words(row.architecture); }});
  for (const std::string& word : words_of(query.search))
    conditions.push_back(
        {"--search", word, [word](const CatalogRow& row) { return search_fits(word, row); },
         [](const CatalogRow& row) {
           std::vector<std::string> words = words_of(text_of(row));
           for (std::string& text : words)
             std::erase_if(
                 text, [](unsigned char c) { return c < 128 && std::ispunct(c) != 0 && c != '-'; });
           return words;
         }});
  return conditions;
}

}  // namespace

void add_search_options(CLI::App& app, CatalogQuery& query) {
  app.add_option("--motion", query.motion, "Only machines that move so: 3T1R, or letters as XYZA")
      ->type_name("PATTERN");
  app.add_option("--drives", query.drives, "Only machines with so many drives")->type_name("N");
  app.add_option("--drive-type", query.drive_type,
                 "Only machines whose drives are all prismatic, or all revolute")
      ->type_name("TYPE");
  app.add_option("--limb", query.limb, "Only machines with such a limb, as PUU")->type_name("LIMB");
  app.add_option("--search", query.search, "Only machines whose text holds all these words")
      ->type_name("WORDS");
}

void check_query(CatalogQuery& query) {
  std::vector<Diagnostic> mistakes;
  query.motion = upper(query.motion);
  query.limb = upper(query.limb);
  query.drive_type = lower(query.drive_type);
  if (!query.motion.empty() && !is_pattern(query.motion) && !are_letters(query.motion))
    mistakes.push_back(wrong_argument(
        query.motion, "--motion takes a pattern as 3T1R, or letters of XYZABC as XYZA",
        nearest_word(query.motion, {"3T0R", "3T1R", "3T2R", "3T3R", "2T0R", "2T1R", "1T2R", "0T2R",
                                    "0T3R", "XYZ", "XYZA", "XYZC", "XYC", "ZAB", "ABC"})));
  static const std::vector<std::string> kTypes{"prismatic", "revolute"};
  if (!query.drive_type.empty() && std::ranges::find(kTypes, query.drive_type) == kTypes.end())
    mistakes.push_back(wrong_argument(query.drive_type,
                                      "--drive-type takes \"prismatic\" or \"revolute\"",
                                      nearest_word(query.drive_type, kTypes)));
  if (query.limb.find_first_not_of(kJointLetters) != std::string::npos)
    mistakes.push_back(wrong_argument(
        query.limb, fmt::format("--limb takes joint letters ({}), as PUU", kJointLetters)));
  if (!query.drives.empty() && !is_whole_number(query.drives))
    mistakes.push_back(wrong_argument(query.drives, "--drives takes a whole number from 0 on"));
  if (!mistakes.empty()) throw InputError(std::move(mistakes));
}

bool matches(const CatalogQuery& query, const CatalogRow& row) {
  return std::ranges::all_of(conditions_of(query),
                             [&](const Condition& condition) { return condition.fits(row); });
}

std::string no_match(const CatalogQuery& query, const std::vector<CatalogRow>& rows) {
  for (const Condition& condition : conditions_of(query)) {
    if (std::ranges::any_of(rows, condition.fits)) continue;
    std::vector<std::string> offers;
    for (const CatalogRow& row : rows)
      for (std::string& word : condition.offers(row)) offers.push_back(std::move(word));
    const std::string hint = did_you_mean(condition.value, offers);
    return fmt::format("no machine fits {} {}{}", condition.option, condition.value,
                       hint.empty() ? "" : "; " + hint);
  }
  return "no machine fits all of these conditions together";
}

std::vector<std::string> drive_kinds(const Mechanism& mechanism) {
  std::vector<std::string> kinds;
  for (const Joint& joint : mechanism.joints)
    for (const int freedom : joint.driven)
      kinds.emplace_back(is_translation(joint.type, freedom) ? "prismatic" : "revolute");
  return kinds;
}

}  // namespace polyglide
