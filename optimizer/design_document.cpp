#include "optimizer/design_document.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "catalog/counted.hpp"
#include "kinematics/scene.hpp"
#include "optimizer/duel.hpp"
#include "optimizer/parallel.hpp"
#include "optimizer/requirements.hpp"
#include "optimizer/run_document.hpp"
#include "optimizer/stability.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kNearest = 3;
constexpr const char* kRedundant = "redundant_constraints";

std::string name_of(const Family& family) {
  return family.known_as().empty() ? family.lead->id : family.known_as();
}

int redundant_constraints(const Candidate& candidate) {
  return candidate.check.at("mobility").at(kRedundant);
}

/// The indices of a design, and one that its verdict gives.
Json all_indices_json() {
  Json list = indices_json();
  list.push_back({{"key", kRedundant},
                  {"label", "Redundant constraints"},
                  {"unit", ""},
                  {"scale", 1},
                  {"better", "lower"},
                  {"about",
                   "Constraints that repeat others: the machine moves only as far as its axes are "
                   "exactly as drawn. Not weighed."}});
  return list;
}

Json all_measures_json(const Family& family) {
  Json values = measures_json(family.tuned->best.measures);
  values[kRedundant] = redundant_constraints(*family.lead);
  return values;
}

Json requirement_rows(const DesignFindings& findings) {
  const std::string moves = findings.families.empty() ? "not met" : "met";
  Json rows = Json::array();
  rows.push_back({{"name", "motion"},
                  {"asked", motion_text(findings.brief)},
                  {"verdict", moves},
                  {"note", counted(findings.families.size(), "family", "families") +
                               " of layouts with this motion and a determinate verdict"}});
  rows.push_back({{"name", "drives"},
                  {"asked", std::to_string(findings.brief.drives)},
                  {"verdict", moves},
                  {"note", "none superfluous"}});
  const std::size_t count = findings.satisfying.size();
  for (Json row : requirements_json(findings.brief.requirements)) {
    row["verdict"] = count > 0 ? "met" : "not met";
    row["note"] = count > 0 ? fmt::format("kept by all {} ranked layouts", count)
                            : std::string("kept by no tuned layout");
    rows.push_back(std::move(row));
  }
  return rows;
}

Json count_json(const DesignFindings& findings) {
  std::map<std::string, std::uint64_t> by_verdict;
  for (const Candidate& candidate : findings.enumeration.candidates)
    ++by_verdict[candidate.verdict()];
  std::size_t poses = 0;
  for (const Family& family : findings.families)
    poses += family.look.measures.poses + (family.tuned ? family.tuned->poses : 0);
  return {{"raw", findings.enumeration.raw},
          {"distinct", findings.enumeration.candidates.size()},
          {"by_verdict", by_verdict},
          {"rejected", findings.rejections.counts()},
          {"families", findings.families.size()},
          {"tuned", findings.tuned.size()},
          {"satisfying", findings.satisfying.size()},
          {"poses", poses}};
}

/// Parameters that ended at a bound of the space: there the space decides, not the search.
Json bounds_json(const Family& family) {
  Json list = Json::array();
  for (const auto& [name, value] : family.tuned->best.values) {
    const auto& parameter = *std::ranges::find(family.layout.parameters, name, &Parameter::name);
    const double near = 0.01 * (parameter.max - parameter.min);
    if (value - parameter.min < near) list.push_back(name + " min");
    if (parameter.max - value < near) list.push_back(name + " max");
  }
  return list;
}

Json rank_entry(const Family& family, int rank) {
  const Tuned& tuned = *family.tuned;
  Json twins = Json::array();
  for (const Candidate* member : family.members)
    if (member != family.lead)
      twins.push_back({{"id", member->id},
                       {"known_as", name_or_null(member->known_as)},
                       {"choices", member->choices},
                       {kRedundant, redundant_constraints(*member)}});
  const Vector3& center = tuned.best.center;
  return {{"rank", rank},
          {"layout", family.lead->id},
          {"known_as", name_or_null(family.known_as())},
          {"title", family.layout.title},
          {"score", tuned.best.score},
          {"objectives", all_measures_json(family)},
          {"parameters", values_json(family.layout, tuned.best.values)},
          {"initial_score", tuned.initial.score},
          {"at_bounds", bounds_json(family)},
          {"zone_center", {center.x(), center.y(), center.z()}},
          {"variants", family.members.size()},
          {"twins", std::move(twins)}};
}

std::string answer(const DesignFindings& findings) {
  const std::size_t distinct = findings.enumeration.candidates.size();
  if (findings.satisfying.empty())
    return fmt::format(
        "None of {} distinct layouts satisfies the brief; the nearest misses and the reasons are "
        "below.",
        distinct);
  const Family& best = *findings.satisfying.front();
  return fmt::format("The best of {} distinct layouts is {} ({}), with a score of {:.3g}.",
                     distinct, name_of(best), best.layout.title, best.tuned->best.score);
}

/// Layouts as JSON, made side by side and put down in their order.
Json pages_json(const DesignFindings& findings, const std::vector<const Family*>& families) {
  std::vector<Json> pages(families.size());
  in_parallel(static_cast<int>(families.size()), findings.options, "measure", [&](int i) {
    const Family& family = *families[i];
    const Tuned& tuned = *family.tuned;
    pages[i] =
        layout_json({family.lead->id, family.known_as(), family.layout.title, family.lead->choices,
                     family.layout, family.task, tuned.initial, tuned.best, tuned.search.history},
                    findings.brief.requirements.zone, findings.options.seed);
  });
  return Json(std::move(pages));
}

/// Adds what the table of ranks needs for a picture of the layouts that are not shown in full.
void add_pictures(const DesignFindings& findings, const std::vector<const Family*>& full,
                  Json& ranking) {
  for (std::size_t i = 0; i < ranking.size(); ++i) {
    const Family& family = *findings.satisfying[i];
    if (std::ranges::find(full, &family) != full.end()) continue;
    ranking[i]["scene"] = picture_of(machine_for(expand(family.layout, family.tuned->best.values),
                                                 family.task, findings.brief.requirements.zone));
  }
}

/// Adds the duel, and its sides to the layouts shown in full.
void add_duel(const DesignFindings& findings, Json& run, std::vector<const Family*>& full) {
  if (!findings.brief.duel) return;
  Json duel = duel_json(*findings.brief.duel, findings.enumeration, findings.families);
  if (duel.is_null()) return;
  Json redundant{{"key", kRedundant}};
  for (const char* side : {"a", "b"}) {
    const auto family = std::ranges::find_if(
        findings.families, [&](const Family& one) { return one.lead->id == duel[side]; });
    redundant[side] = redundant_constraints(*family->lead);
    if (std::ranges::find(full, &*family) == full.end()) full.push_back(&*family);
  }
  duel["rows"].push_back(std::move(redundant));
  run["duel"] = std::move(duel);
}

void add_ranking(const DesignFindings& findings, Json& run) {
  run["ranking"] = Json::array();
  std::vector<RankedMeasures> ranked;
  for (const Family* family : findings.satisfying) {
    run["ranking"].push_back(rank_entry(*family, static_cast<int>(ranked.size()) + 1));
    ranked.push_back({family->lead->id, name_of(*family), family->tuned->best.measures});
  }
  run["stability"] = stability_json(ranked, findings.brief.requirements.objectives);
}

}  // namespace

Json design_document(const DesignFindings& findings) {
  const Brief& brief = findings.brief;
  Json run{{"format", "polyglide/run/1"}, {"kind", "design"},     {"name", brief.name},
           {"title", brief.title},        {"about", brief.about}, {"answer", answer(findings)},
           {"brief", brief.document}};
  run["requirements"] = requirement_rows(findings);
  run["counts"] = count_json(findings);
  run["indices"] = all_indices_json();
  add_ranking(findings, run);

  std::vector<const Family*> full = findings.satisfying;
  if (full.empty()) {
    full = findings.tuned;
    full.resize(std::min(full.size(), kNearest));
    run["nearest"] = Json::array();
    for (const Family* family : full) run["nearest"].push_back(rank_entry(*family, 0));
  }
  full.resize(std::min(full.size(), static_cast<std::size_t>(brief.report_layouts)));
  add_duel(findings, run, full);
  add_pictures(findings, full, run["ranking"]);
  run["layouts"] = pages_json(findings, full);
  run["rejected"] = findings.rejections.json(findings.space, findings.options);
  return run;
}

}  // namespace polyglide
