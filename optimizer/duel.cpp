#include "optimizer/duel.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "catalog/problems.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

const Candidate& candidate_with(const Enumeration& enumeration, const std::string& known) {
  const std::string& id = enumeration.known.at(known);
  return *std::ranges::find(enumeration.candidates, id, &Candidate::id);
}

bool same_arrangement(const Candidate& a, const Candidate& b, const std::vector<std::string>& by) {
  if (by.empty()) return a.id == b.id;
  return std::ranges::all_of(by, [&](const std::string& choice) {
    const auto in_a = a.choices.find(choice), in_b = b.choices.find(choice);
    if (in_a == a.choices.end() || in_b == b.choices.end())
      return in_a == a.choices.end() && in_b == b.choices.end();
    return in_a->second == in_b->second;
  });
}

struct Side {
  std::string label;
  const Family* best = nullptr;
  int tuned = 0;
};

Side side_of(const std::string& known, const DuelRequest& request, const Enumeration& enumeration,
             const std::vector<Family>& families) {
  Side side{known, nullptr, 0};
  if (!request.by.empty()) side.label = "arrangement of " + known;
  for (const Family& family : families) {
    if (!family.tuned || !belongs_to(family, known, request, enumeration)) continue;
    ++side.tuned;
    if (side.best == nullptr || family.tuned->best.score > side.best->tuned->best.score)
      side.best = &family;
  }
  return side;
}

std::string described(const Side& side) {
  return fmt::format("The {} (best of {} tuned: {})", side.label, side.tuned,
                     side.best->known_as().empty() ? side.best->lead->id : side.best->known_as());
}

std::string list_of(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ", ") + item;
  return text.empty() ? "nothing" : text;
}

std::string statement(const Side& winner, const Side& loser) {
  const Design &best = winner.best->tuned->best, &other = loser.best->tuned->best;
  if (best.score <= 0)
    return fmt::format("Neither covers the work zone: {} reaches {:.3g} % of it, {} {:.3g} %.",
                       winner.label, 100 * best.measures.coverage, loser.label,
                       100 * other.measures.coverage);
  std::string text = described(winner) + " wins";
  if (other.score <= 0)
    return text +
           fmt::format(
               ": it covers the work zone with a score of {:.3g}; the {} covers {:.3g} % of it.",
               best.score, loser.label, 100 * other.measures.coverage);
  std::vector<std::string> better, worse;
  for (const Index& index : indices()) {
    const double a = best.measures[index.key], b = other.measures[index.key];
    if (a == b || b == 0) continue;
    const std::string item = fmt::format("{} {:+.1f} %", lowered(index.label), 100 * (a / b - 1));
    ((a > b) == index.higher ? better : worse).push_back(item);
  }
  return text +
         fmt::format(
             " with a score of {:.3g} against {:.3g} ({:+.1f} %) of the {}. Better: {}. Worse: {}.",
             best.score, other.score, 100 * (best.score / other.score - 1), loser.label,
             list_of(better), list_of(worse));
}

}  // namespace

void check_duel(const Brief& brief, const Space& space, const Enumeration& enumeration) {
  if (!brief.duel) return;
  Problems problems(brief.document, brief.file);
  const auto& source = brief.document.at("duel");
  std::vector<std::string> known, choices;
  for (const auto& [name, id] : enumeration.known) known.push_back(name);
  for (const Choice& choice : space.choices) choices.push_back(choice.name);
  for (const auto& name : source.at("between"))
    if (!enumeration.known.contains(name.get<std::string>()))
      problems.add(name, "must be a known layout that the space contains",
                   did_you_mean(name.get<std::string>(), known));
  if (source.contains("by"))
    for (const auto& name : source.at("by"))
      if (std::ranges::find(choices, name.get<std::string>()) == choices.end())
        problems.add(name, "must be a choice of the space",
                     did_you_mean(name.get<std::string>(), choices));
  problems.raise();
}

bool belongs_to(const Family& family, const std::string& known, const DuelRequest& request,
                const Enumeration& enumeration) {
  const Candidate& named = candidate_with(enumeration, known);
  return std::ranges::any_of(family.members, [&](const Candidate* member) {
    return same_arrangement(*member, named, request.by);
  });
}

Json duel_json(const DuelRequest& request, const Enumeration& enumeration,
               const std::vector<Family>& families) {
  const Side a = side_of(request.a, request, enumeration, families);
  const Side b = side_of(request.b, request, enumeration, families);
  if (a.best == nullptr || b.best == nullptr) return nullptr;
  Json rows = Json::array();
  const Measures &of_a = a.best->tuned->best.measures, &of_b = b.best->tuned->best.measures;
  for (const Index& index : indices())
    rows.push_back({{"key", index.key}, {"a", of_a[index.key]}, {"b", of_b[index.key]}});
  const bool a_wins = a.best->tuned->best.score >= b.best->tuned->best.score;
  return {{"a", a.best->lead->id}, {"b", b.best->lead->id},
          {"a_label", a.label},    {"b_label", b.label},
          {"rows", rows},          {"statement", a_wins ? statement(a, b) : statement(b, a)}};
}

}  // namespace polyglide
