#include "optimizer/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "catalog/catalog.hpp"
#include "catalog/json_file.hpp"
#include "kinematics/mobility.hpp"
#include "optimizer/design_document.hpp"
#include "optimizer/duel.hpp"
#include "optimizer/families.hpp"
#include "optimizer/parallel.hpp"
#include "optimizer/run_document.hpp"
#include "optimizer/screening.hpp"
#include "optimizer/tuning_store.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kLookEvaluations = 40;

class DesignJob {
 public:
  DesignJob(const Brief& brief, const RunOptions& options)
      : brief_(brief), options_(options), provenance_(options), space_(load_space(brief.space)) {}

  DesignResult run() {
    open_store();
    enumerate_space();
    screen();
    look();
    tune_best();
    rank();
    return {!ranking_.empty(), document()};
  }

 private:
  void open_store();
  void enumerate_space();
  void screen();
  void look();
  void tune_best();
  void rank();
  [[nodiscard]] std::string shortfall(const Family& family) const;

  [[nodiscard]] TuneProblem problem_of(const Family& family) const {
    return {family.layout, family.task, brief_.requirements, turnable(family.layout), {}};
  }
  [[nodiscard]] std::uint64_t seed_of(const Family& family) const {
    return std::stoull(content_hash(family.lead->id + std::to_string(options_.seed)), nullptr, 16);
  }
  [[nodiscard]] std::set<const Family*> chosen_for_tuning() const;
  [[nodiscard]] std::vector<const Family*> by_score(bool tuned) const;

  [[nodiscard]] Json document();

  const Brief& brief_;
  const RunOptions& options_;
  Provenance provenance_;
  Space space_;
  std::unique_ptr<Store> store_;
  Enumeration enumeration_;
  Rejections rejections_;
  std::vector<Family> families_;
  std::vector<const Family*> ranking_;  ///< families that satisfy the brief, best first
};

void DesignJob::open_store() {
  if (options_.out.empty()) return;
  store_ = std::make_unique<Store>(options_.out / "campaign.sqlite",
                                   campaign_identity(space_, options_.seed));
}

void DesignJob::enumerate_space() {
  EnumerationOptions options;
  options.threads = options_.threads;
  options.seed = options_.seed;
  options.store = store_.get();
  if (options_.progress)
    options.progress = [&](const EnumerationProgress& progress) {
      options_.progress({progress.stage, static_cast<double>(progress.done),
                         static_cast<double>(progress.total)});
    };
  enumeration_ = enumerate(space_, options);
  check_duel(brief_, space_, enumeration_);
}

/// Rejects by verdict and motion, then by the direction of the rotation axis, which
/// takes another analysis.
void DesignJob::screen() {
  for (const Unbuildable& cause : enumeration_.unbuildable) rejections_.add_unbuildable(cause);
  std::vector<Eligible> eligible;
  for (const Candidate& candidate : enumeration_.candidates) {
    const std::string reason = rejection(candidate, brief_);
    if (reason.empty())
      eligible.push_back(
          {&candidate, candidate_layout(space_, candidate.raw_index, candidate.id), {}});
    else
      rejections_.add(reason, candidate);
  }
  in_parallel(static_cast<int>(eligible.size()), options_, "find axes", [&](int i) {
    MobilityOptions options;
    options.seed = options_.seed;
    options.evidence = false;
    eligible[i].task = analyse_mobility(compile(expand(eligible[i].layout)), options).task;
  });
  std::erase_if(eligible, [&](const Eligible& one) {
    const std::string reason = axis_rejection(one.task, brief_);
    if (!reason.empty()) rejections_.add(reason, *one.candidate);
    return !reason.empty();
  });
  families_ = group_twins(std::move(eligible));
}

void DesignJob::look() {
  in_parallel(static_cast<int>(families_.size()), options_, "look", [&](int i) {
    families_[i].look =
        place_zone(problem_of(families_[i]), kLookEvaluations, seed_of(families_[i]));
  });
}

/// Families by the score they are known to reach, best first; ties by id.
std::vector<const Family*> DesignJob::by_score(bool tuned) const {
  std::vector<const Family*> list;
  for (const Family& family : families_)
    if (!tuned || family.tuned) list.push_back(&family);
  std::ranges::sort(list, [&](const Family* a, const Family* b) {
    const double of_a = tuned ? a->tuned->best.score : a->look.score;
    const double of_b = tuned ? b->tuned->best.score : b->look.score;
    return of_a != of_b ? of_a > of_b : a->lead->id < b->lead->id;
  });
  return list;
}

std::set<const Family*> DesignJob::chosen_for_tuning() const {
  const std::vector<const Family*> list = by_score(false);
  const auto wanted = static_cast<std::size_t>(brief_.tune_candidates);
  std::set<const Family*> chosen(list.begin(), list.begin() + std::min(wanted, list.size()));
  for (const Family* family : list)
    if (!family->known_as().empty()) chosen.insert(family);
  if (!brief_.duel) return chosen;
  for (const std::string& side : {brief_.duel->a, brief_.duel->b}) {
    std::size_t left = std::max<std::size_t>(1, wanted / 4);
    for (const Family* family : list)
      if (left > 0 && belongs_to(*family, side, *brief_.duel, enumeration_)) {
        chosen.insert(family);
        --left;
      }
  }
  return chosen;
}

void DesignJob::tune_best() {
  const std::set<const Family*> chosen = chosen_for_tuning();
  std::vector<Family*> todo;
  for (Family& family : families_)
    if (chosen.contains(&family)) todo.push_back(&family);
  const TuningStore store(store_.get(), brief_);
  in_parallel(static_cast<int>(todo.size()), options_, "tune", [&](int i) {
    Family& family = *todo[i];
    family.tuned = store.find(family.lead->id);
    if (family.tuned) return;
    family.tuned = tune(problem_of(family), brief_.tune_evaluations, seed_of(family));
    store.put(family.lead->id, *family.tuned);
  });
}

/// Why a tuned family does not satisfy the brief; "" when it does.
std::string DesignJob::shortfall(const Family& family) const {
  const Design& best = family.tuned->best;
  if (best.score <= 0) return "tuned: the work zone is not covered";
  MobilityOptions options;
  options.seed = options_.seed;
  options.evidence = false;
  const auto report = analyse_mobility(compile(expand(family.layout, best.values)), options);
  if (report.verdict != Verdict::determinate)
    return "tuned: " + to_string(report.verdict) + " at the dimensions found";
  return "";
}

void DesignJob::rank() {
  for (const Family& family : families_) {
    if (family.tuned) continue;
    for (const Candidate* member : family.members)
      rejections_.add("not tuned: others promise more at the dimensions of the space", *member,
                      {fmt::format("Score {:.3g} before tuning.", family.look.score)});
  }
  const std::vector<const Family*> list = by_score(true);
  std::vector<std::string> why(list.size());
  in_parallel(static_cast<int>(list.size()), options_, "verify",
              [&](int i) { why[i] = shortfall(*list[i]); });
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (why[i].empty()) {
      ranking_.push_back(list[i]);
      continue;
    }
    const Measures& best = list[i]->tuned->best.measures;
    for (const Candidate* member : list[i]->members)
      rejections_.add(
          why[i], *member,
          {fmt::format("Tuned it covers {:.3g} % of the work zone's poses.", 100 * best.coverage)});
  }
}

Json DesignJob::document() {
  Json run = design_document(
      {brief_, options_, space_, enumeration_, rejections_, families_, by_score(true), ranking_});
  provenance_.add_hash("brief", content_hash(brief_.document.dump()));
  provenance_.add_hash("space", space_.hash);
  provenance_.add_hash("catalog", catalog_hash());
  run["provenance"] = provenance_.json();
  return run;
}

}  // namespace

DesignResult run_design(const Brief& brief, const RunOptions& options) {
  return DesignJob(brief, options).run();
}

}  // namespace polyglide
