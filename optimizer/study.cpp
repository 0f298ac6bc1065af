#include "optimizer/study.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "catalog/catalog.hpp"
#include "catalog/expression.hpp"
#include "catalog/json_file.hpp"
#include "optimizer/parallel.hpp"
#include "optimizer/requirements.hpp"
#include "optimizer/run_document.hpp"

namespace polyglide {
namespace {

using nlohmann::json;
using Json = nlohmann::ordered_json;

Layout read_machine(const json& document, const std::string& file) {
  const std::string name = document.at("machine");
  const bool is_path = name.ends_with(".json") || name.find('/') != std::string::npos;
  if (!is_path) return find_layout(name);
  return find_layout((std::filesystem::path(file).parent_path() / name).string());
}

std::vector<std::string> parameter_names(const Layout& layout) {
  std::vector<std::string> names;
  for (const Parameter& parameter : layout.parameters) names.push_back(parameter.name);
  return names;
}

void read_turned(const json& document, Study& study, Problems& problems) {
  const std::vector<std::string> names = parameter_names(study.machine);
  study.turn = turnable(study.machine);
  if (!document.contains("turn")) return;
  const std::vector<std::string> free = study.turn;
  study.turn.clear();
  for (const json& value : document.at("turn")) {
    const std::string name = value;
    if (std::ranges::find(names, name) == names.end())
      problems.add(value, fmt::format("{} has no parameter \"{}\"", study.machine.name, name),
                   did_you_mean(name, names));
    else if (std::ranges::find(free, name) == free.end())
      problems.add(value,
                   fmt::format("\"{}\" cannot be turned: {} gives it no room between min and max",
                               name, study.machine.name));
    else
      study.turn.push_back(name);
  }
}

void read_constraints(const json& document, Study& study, Problems& problems) {
  if (!document.contains("constraints")) return;
  for (const json& value : document.at("constraints")) {
    Constraint constraint;
    constraint.about = text_or(value, "about", "");
    constraint.expression = value.at("expression");
    constraint.min = value.value("min", constraint.min);
    constraint.max = value.value("max", constraint.max);
    try {
      (void)evaluate(constraint, study.machine, {});
    } catch (const InputError& error) {
      const Diagnostic& mistake = error.diagnostics().front();
      problems.add(value.at("expression"), mistake.rule, mistake.hint);
    }
    if (constraint.min > constraint.max) problems.add(value, "min must not be greater than max");
    study.constraints.push_back(std::move(constraint));
  }
}

/// What is asked, and whether the best design keeps it.
Json requirement_rows(const Study& study, const Tuned& tuned) {
  Json rows = requirements_json(study.requirements);
  const bool covered = tuned.best.measures.coverage == 1;
  for (Json& row : rows) {
    row["verdict"] = covered ? "met" : "not met";
    row["note"] =
        fmt::format("{:.4g} % of the zone's poses; {:.4g} % with the machine as it stands",
                    100 * tuned.best.measures.coverage, 100 * tuned.initial.measures.coverage);
    if (row["name"] == "envelope") {
      row["verdict"] = "met";
      row["note"] = "kept by the constraints below";
    }
  }
  for (const Constraint& constraint : study.constraints) {
    const double value = evaluate(constraint, study.machine, tuned.best.values);
    std::string asked = constraint.expression;
    if (std::isfinite(constraint.min)) asked = fmt::format("{:g} <= {}", constraint.min, asked);
    if (std::isfinite(constraint.max)) asked = fmt::format("{} <= {:g}", asked, constraint.max);
    const bool kept = value >= constraint.min && value <= constraint.max;
    rows.push_back({{"name", constraint.about.empty() ? "constraint" : constraint.about},
                    {"asked", asked},
                    {"verdict", kept ? "met" : "not met"},
                    {"note", fmt::format("{:.6g}; {:.6g} with the machine as it stands", value,
                                         evaluate(constraint, study.machine, {}))}});
  }
  return rows;
}

std::string change_text(double from, double to) {
  return from > 0 ? fmt::format("{:+.1f} %", 100 * (to / from - 1)) : "from nothing";
}

/// What each dimension brings: the score with that one set back to the machine's value.
std::string shares_text(const TuneProblem& problem, const Tuned& tuned) {
  std::string text;
  for (const std::string& name : problem.turn) {
    ParameterValues values = tuned.best.values;
    const double before =
        std::ranges::find(problem.layout.parameters, name, &Parameter::name)->value;
    values[name] = before;
    const TuneProblem without{problem.layout,      problem.task, problem.requirements, {},
                              problem.constraints, values};
    const Design design = place_zone(without, 60, 1, kFinalFineness);
    text += fmt::format("{}{} back at {:g} {}", text.empty() ? "" : "; ", name, before,
                        design.score > 0 ? fmt::format("leaves {:.3g}", design.score)
                                         : std::string("breaks a requirement"));
  }
  return text;
}

std::string finding(const TuneProblem& problem, const Tuned& tuned) {
  const Design &from = tuned.initial, &to = tuned.best;
  if (to.score <= from.score)
    return "No better dimensions were found: the machine stands at the best this search knows.";
  std::string text = from.score > 0
                         ? fmt::format("The objective rises from {:.3g} to {:.3g} ({})", from.score,
                                       to.score, change_text(from.score, to.score))
                         : fmt::format(
                               "The zone, not covered as the machine stands, is covered with an "
                               "objective of {:.3g}",
                               to.score);
  for (const auto& [key, weight] : problem.requirements.objectives)
    text += fmt::format(", {} {:.3g} → {:.3g} ({})", lowered(label_of(key)), from.measures[key],
                        to.measures[key], change_text(from.measures[key], to.measures[key]));
  text += fmt::format(
      "; usable workspace {:.4g} → {:.4g} dm³, worst conditioning in the zone {:.3g} → {:.3g}. ",
      from.measures.volume * 1e3, to.measures.volume * 1e3, from.measures.worst_conditioning,
      to.measures.worst_conditioning);
  return text + "With one dimension set back: " + shares_text(problem, tuned) + ".";
}

Json rank_row(int rank, const std::string& id, const std::string& title, const Study& study,
              const Design& design, double initial_score) {
  return {{"rank", rank},
          {"layout", id},
          {"known_as", nullptr},
          {"title", title},
          {"score", design.score},
          {"objectives", measures_json(design.measures)},
          {"parameters", values_json(study.machine, design.values)},
          {"initial_score", initial_score}};
}

Json duel_json(const std::string& tuned_id, const std::string& given_id, const Tuned& tuned,
               const std::string& statement) {
  Json rows = Json::array();
  for (const Index& index : indices())
    rows.push_back({{"key", index.key},
                    {"a", tuned.best.measures[index.key]},
                    {"b", tuned.initial.measures[index.key]}});
  return {{"a", tuned_id},      {"b", given_id},
          {"a_label", "tuned"}, {"b_label", "as it stands"},
          {"rows", rows},       {"statement", statement}};
}

Json run_json(const Study& study, const TuneProblem& problem, const Tuned& tuned,
              const RunOptions& options) {
  const std::string given = study.machine.name, better = given + "-tuned";
  const std::string statement = finding(problem, tuned);
  Json run{{"format", "polyglide/run/1"}, {"kind", "study"},      {"name", study.name},
           {"title", study.title},        {"about", study.about}, {"answer", statement},
           {"brief", study.document}};
  run["requirements"] = requirement_rows(study, tuned);
  run["counts"] = {{"tuned", 1}, {"evaluations", tuned.search.evaluations}, {"poses", tuned.poses}};
  run["indices"] = indices_json();
  run["ranking"] = {
      rank_row(1, better, study.machine.title + ", tuned", study, tuned.best, tuned.initial.score),
      rank_row(2, given, study.machine.title + ", as it stands", study, tuned.initial,
               tuned.initial.score)};
  run["duel"] = duel_json(better, given, tuned, statement);
  const std::vector<std::pair<int, double>> none;
  const std::vector<ShownLayout> shown{{better,
                                        "",
                                        study.machine.title + ", tuned",
                                        {},
                                        study.machine,
                                        problem.task,
                                        tuned.initial,
                                        tuned.best,
                                        tuned.search.history},
                                       {given,
                                        "",
                                        study.machine.title + ", as it stands",
                                        {},
                                        study.machine,
                                        problem.task,
                                        tuned.initial,
                                        tuned.initial,
                                        none}};
  std::vector<Json> pages(shown.size());
  in_parallel(static_cast<int>(shown.size()), options, "measure", [&](int i) {
    pages[i] = layout_json(shown[i], study.requirements.zone, options.seed);
  });
  run["layouts"] = std::move(pages);
  return run;
}

}  // namespace

Study parse_study(json document, const std::string& file) {
  if (auto mistakes = check_schema(document, "study-1", file); !mistakes.empty())
    throw InputError(std::move(mistakes));
  Study study;
  study.document = std::move(document);
  const json& source = study.document;
  Problems problems(source, file);
  check_name(source, problems);
  study.file = file;
  study.name = source.at("name");
  study.title = text_or(source, "title", study.name);
  study.about = text_or(source, "about", "");
  study.machine = read_machine(source, file);
  study.evaluations = source.value("evaluations", study.evaluations);
  study.requirements = read_requirements(source, "objective", problems);
  read_turned(source, study, problems);
  read_constraints(source, study, problems);
  problems.raise();
  return study;
}

Study load_study(const std::filesystem::path& file) {
  return parse_study(read_json(file), file.string());
}

StudyResult run_study(const Study& study, const RunOptions& options) {
  Provenance provenance(options);
  provenance.add_hash("study", content_hash(study.document.dump()));
  provenance.add_hash("machine", content_hash(study.machine.document.dump()));
  const TaskSpace task = prepare(expand(study.machine)).task;
  TuneProblem problem{study.machine, task, study.requirements, study.turn, study.constraints};
  RunProgress progress{"tune", 0,
                       1.5 * study.evaluations};  // polishing takes up to half as much again
  if (options.progress)
    problem.evaluated = [&] {
      ++progress.done;
      options.progress(progress);
    };

  StudyResult result;
  result.tuned = tune(problem, study.evaluations, options.seed);
  problem.evaluated = {};
  result.satisfied = result.tuned.best.score > 0;
  result.run = run_json(study, problem, result.tuned, options);
  result.run["provenance"] = provenance.json();
  return result;
}

}  // namespace polyglide
