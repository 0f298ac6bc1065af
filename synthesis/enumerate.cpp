#include "synthesis/enumerate.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <mutex>
#include <utility>

#include "catalog/catalog.hpp"
#include "catalog/diagnostics.hpp"
#include "kinematics/mobility.hpp"
#include "synthesis/canonical.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr const char* kVerdicts = "verdict";  // kind in the store
constexpr std::uint64_t kMostRaw = 5'000'000;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Runs work(i) for i < count on the asked number of threads and tells how far it is.
class Workers {
 public:
  explicit Workers(const EnumerationOptions& options)
      : options_(options),
        arena_(options.threads > 0 ? options.threads : tbb::task_arena::automatic) {}

  template <typename Work>
  void run(const std::string& stage, std::uint64_t count, const Work& work) {
    std::mutex mutex;
    EnumerationProgress progress{stage, 0, count};
    const auto finished = [&] {
      if (!options_.progress) return;
      const std::lock_guard lock(mutex);
      ++progress.done;
      options_.progress(progress);
    };
    arena_.execute([&] {
      tbb::parallel_for(std::uint64_t{0}, count, [&](std::uint64_t i) {
        work(i);
        finished();
      });
    });
  }

 private:
  const EnumerationOptions& options_;
  tbb::task_arena arena_;
};

// What a raw candidate turned out to be: a layout with an id, or why it is none.
struct Recognised {
  std::string id;
  double symmetry = 1;
  std::string failure;
};

Mechanism build(const Space& space, std::uint64_t index) {
  return expand(make_layout(raw_candidate(space, index).layout, space.file));
}

Recognised recognise(const Space& space, std::uint64_t index) {
  try {
    const CanonicalForm form = canonical_form(build(space, index));
    return {short_id(form), form.symmetry, ""};
  } catch (const InputError& error) {
    return {"", 1, error.diagnostics().front().rule};
  }
}

// Puts equal layouts together, in the order of the space.
void group(const std::vector<Recognised>& recognised, Enumeration& result) {
  std::map<std::string, std::size_t> layouts, failures;
  for (std::uint64_t i = 0; i < recognised.size(); ++i) {
    const auto& [id, symmetry, failure] = recognised[i];
    if (failure.empty()) {
      const auto [place, is_new] = layouts.try_emplace(id, result.candidates.size());
      if (is_new) result.candidates.emplace_back();
      Candidate& candidate = result.candidates[place->second];
      if (is_new) candidate.id = id, candidate.raw_index = i, candidate.symmetry = symmetry;
      ++candidate.raw_count;
    } else {
      const auto [place, is_new] = failures.try_emplace(failure, result.unbuildable.size());
      if (is_new) result.unbuildable.push_back({failure, i, 0});
      ++result.unbuildable[place->second].raw_count;
    }
  }
}

// A space of which nothing can be built is more likely mistaken than sought.
void refuse_empty(const Space& space, const Enumeration& result) {
  if (!result.candidates.empty()) return;
  std::vector<Diagnostic> causes;
  for (const Unbuildable& cause : result.unbuildable)
    causes.push_back({space.file, "", fmt::format("{} combinations", cause.raw_count),
                      "no layout of the space can be built: " + cause.reason, ""});
  throw InputError(causes);
}

void find_known(const Space& space, Enumeration& result) {
  std::map<std::string, Candidate*> by_id;
  for (Candidate& candidate : result.candidates) by_id[candidate.id] = &candidate;
  for (const std::string& name : space.known) {
    const auto found = by_id.find(short_id(canonical_form(expand(find_layout(name)))));
    if (found == by_id.end()) continue;
    result.known[name] = found->first;
    found->second->known_as = name;
  }
}

std::string record_of(const Candidate& candidate) {
  return Json{{"raw_index", candidate.raw_index},
              {"raw_count", candidate.raw_count},
              {"choices", candidate.choices},
              {"check", candidate.check}}
      .dump();
}

Json check_of(const Space& space, const Candidate& candidate, std::uint64_t seed) {
  Mechanism mechanism = build(space, candidate.raw_index);
  mechanism.name = candidate.id;
  return to_json(analyse_mobility(compile(mechanism), screening_options(seed)), mechanism);
}

void check_all(const Space& space, const EnumerationOptions& options, Workers& workers,
               Enumeration& result) {
  std::map<std::string, std::string> finished;
  if (options.store != nullptr) finished = options.store->all(kVerdicts);
  std::vector<Candidate*> open;
  for (Candidate& candidate : result.candidates) {
    candidate.choices = raw_candidate(space, candidate.raw_index).choices;
    const auto found = finished.find(candidate.id);
    if (found == finished.end())
      open.push_back(&candidate);
    else
      candidate.check = Json::parse(found->second).at("check");
  }
  workers.run("check", open.size(), [&](std::uint64_t i) {
    Candidate& candidate = *open[i];
    candidate.check = check_of(space, candidate, options.seed);
    if (options.store != nullptr) options.store->put(kVerdicts, candidate.id, record_of(candidate));
  });
  if (options.store != nullptr) options.store->flush();
  result.checked = open.size();
}

}  // namespace

std::string Candidate::reason() const {
  const Json& reasons = check.at("reasons");
  return reasons.empty() ? "" : reasons.front().get<std::string>();
}

Enumeration enumerate(const Space& space, const EnumerationOptions& options) {
  const auto start = Clock::now();
  Enumeration result;
  result.raw = raw_count(space);
  if (result.raw > kMostRaw)
    throw InputError({{space.file, "", std::to_string(result.raw),
                       fmt::format("at most {} raw combinations can be enumerated", kMostRaw),
                       "fix some of the choices"}});
  if (options.store != nullptr) result.store = options.store->file().string();

  Workers workers(options);
  std::vector<Recognised> recognised(result.raw);
  workers.run("expand", result.raw, [&](std::uint64_t i) { recognised[i] = recognise(space, i); });
  group(recognised, result);
  refuse_empty(space, result);
  find_known(space, result);
  result.expand_seconds = seconds_since(start);

  const auto start_of_checks = Clock::now();
  check_all(space, options, workers, result);
  result.check_seconds = seconds_since(start_of_checks);
  result.seconds = seconds_since(start);
  return result;
}

Layout candidate_layout(const Space& space, std::uint64_t raw_index, const std::string& name) {
  RawCandidate raw = raw_candidate(space, raw_index);
  std::vector<std::string> taken;
  for (const auto& [choice, label] : raw.choices)
    taken.push_back(fmt::format("{}: {}", choice, label));
  raw.layout["name"] = name;
  raw.layout["title"] = fmt::format("{}", fmt::join(taken, ", "));
  raw.layout["source"] = fmt::format("candidate {} of the space {}", raw_index, space.name);
  return make_layout(std::move(raw.layout), space.file);
}

StoreIdentity campaign_identity(const Space& space, std::uint64_t seed) {
  return {{"space", space.hash}, {"seed", std::to_string(seed)}, {"version", POLYGLIDE_VERSION}};
}

nlohmann::ordered_json to_json(const Enumeration& enumeration) {
  std::map<std::string, std::uint64_t> by_verdict, by_reason;
  for (const Candidate& candidate : enumeration.candidates) {
    ++by_verdict[candidate.verdict()];
    if (candidate.verdict() != to_string(Verdict::determinate)) ++by_reason[candidate.reason()];
  }
  nlohmann::ordered_json unbuildable = nlohmann::ordered_json::object();
  for (const Unbuildable& cause : enumeration.unbuildable)
    unbuildable[cause.reason] = cause.raw_count;
  return {{"raw", enumeration.raw},
          {"distinct", enumeration.candidates.size()},
          {"by_verdict", by_verdict},
          {"known", enumeration.known},
          {"store", enumeration.store},
          {"seconds", enumeration.seconds},
          {"by_reason", by_reason},
          {"unbuildable", unbuildable},
          {"checked", enumeration.checked},
          {"expand_seconds", enumeration.expand_seconds},
          {"check_seconds", enumeration.check_seconds}};
}

}  // namespace polyglide
