#include "optimizer/tune.hpp"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "catalog/expression.hpp"
#include "optimizer/envelope.hpp"

namespace polyglide {
namespace {

// Scores of what is no machine at all: below every score, which is at least -1.
constexpr double kOutOfReach = -2, kUnbuildable = -3, kBreaksConstraint = -4;

const Parameter& parameter_named(const Layout& layout, const std::string& name) {
  const auto found = std::ranges::find(layout.parameters, name, &Parameter::name);
  if (found == layout.parameters.end())
    throw std::invalid_argument("tune: the layout has no parameter \"" + name + '"');
  return *found;
}

/// How far a value is outside its bounds, relative to the bound.
double violation(const Constraint& constraint, double value) {
  const auto part = [](double excess, double bound) {
    return std::max(excess, 0.0) / std::max(1.0, std::abs(bound));
  };
  double sum = 0;
  if (std::isfinite(constraint.min)) sum += part(constraint.min - value, constraint.min);
  if (std::isfinite(constraint.max)) sum += part(value - constraint.max, constraint.max);
  return std::isfinite(value) ? sum : 1;
}

/// A problem as a function of plain variables: the turned parameters, then the place of
/// the zone's centre as shares of the reach box (absent when the centre is given).
class Tuner {
 public:
  explicit Tuner(const TuneProblem& problem) : problem_(problem) {
    for (const std::string& name : problem.turn) {
      const Parameter& parameter = parameter_named(problem.layout, name);
      lower_.push_back(parameter.min);
      upper_.push_back(parameter.max);
      start_.push_back(parameter.value);
    }
    if (problem.requirements.zone.center) return;
    for (int i = 0; i < 3; ++i) {
      lower_.push_back(0);
      upper_.push_back(1);
      start_.push_back(0.5);
    }
  }

  [[nodiscard]] const std::vector<double>& start() const { return start_; }
  [[nodiscard]] std::size_t poses() const { return poses_; }

  /// A design, or only its score when there is no machine to look at.
  [[nodiscard]] Design look(const std::vector<double>& point, const Fineness& fineness) {
    Design design;
    design.values = values_at(point);
    design.score = constraint_score(design.values);
    if (design.score < 0) return design;
    const std::optional<Machine> machine = build(design.values);
    design.score = machine ? look(*machine, point, fineness, design) : kUnbuildable;
    return design;
  }

  [[nodiscard]] SearchSummary search(const std::vector<double>& start, const SearchOptions& options,
                                     const Fineness& fineness) {
    SearchProblem problem{lower_, upper_, start, [&](const std::vector<double>& point) {
                            return look(point, fineness).score;
                          }};
    return maximise(problem, options);
  }

  /// The start with the zone's centre at the best of several heights, in the middle.
  [[nodiscard]] std::vector<double> best_height() {
    if (problem_.requirements.zone.center) return start_;
    constexpr int kHeights = 12;
    std::vector<double> best = start_, point = start_;
    double highest = -std::numeric_limits<double>::infinity();
    for (int i = 1; i < kHeights; ++i) {
      point.back() = static_cast<double>(i) / kHeights;
      const double score = look(point, kSearchFineness).score;
      if (score > highest) highest = score, best = point;
    }
    return best;
  }

 private:
  ParameterValues values_at(const std::vector<double>& point) const {
    ParameterValues values = problem_.fixed;
    for (std::size_t i = 0; i < problem_.turn.size(); ++i) values[problem_.turn[i]] = point[i];
    return values;
  }

  double constraint_score(const ParameterValues& values) const {
    double sum = 0;
    for (const Constraint& constraint : problem_.constraints)
      sum += violation(constraint, evaluate(constraint, problem_.layout, values));
    return sum > 0 ? kBreaksConstraint - sum : 0;
  }

  std::optional<Machine> build(const ParameterValues& values) const {
    try {
      return machine_for(expand(problem_.layout, values), problem_.task,
                         problem_.requirements.zone);
    } catch (const InputError&) {  // rods that do not reach: a point of the search, no mistake
      return std::nullopt;
    }
  }

  double look(const Machine& machine, const std::vector<double>& point, const Fineness& fineness,
              Design& design) {
    if (problem_.requirements.zone.center) {
      design.center = *problem_.requirements.zone.center;
    } else {
      const Eigen::AlignedBox3d box = reach_box(machine);
      if (box.isEmpty()) return kOutOfReach;
      const Vector3 share = Vector3::Map(&point[problem_.turn.size()]);
      design.center = box.min() + share.cwiseProduct(box.sizes());
    }
    design.measures = measure(Evaluator(machine), problem_.requirements, design.center, fineness);
    poses_ += design.measures.poses;
    if (problem_.evaluated) problem_.evaluated();
    return score(design.measures, problem_.requirements.objectives);
  }

  const TuneProblem& problem_;
  std::vector<double> lower_, upper_, start_;
  std::size_t poses_ = 0;
};

/// Runs without other tasks mixing in while it waits for parallel work of its own.
template <typename Work>
auto isolated(const Work& work) {
  std::optional<decltype(work())> result;
  tbb::this_task_arena::isolate([&] { result.emplace(work()); });
  return std::move(*result);
}

TuneProblem without_parameters(const TuneProblem& problem) {
  TuneProblem fixed = problem;
  fixed.turn.clear();
  return fixed;
}

/// Place of the zone's centre, as the last variables of a search.
std::vector<double> zone_place(const TuneProblem& problem, int evaluations, std::uint64_t seed,
                               std::size_t& poses) {
  const TuneProblem fixed = without_parameters(problem);
  Tuner tuner(fixed);
  const std::vector<double> start = tuner.best_height();
  const SearchSummary found = tuner.search(start, {evaluations, seed, 0.3, 1e-3}, kSearchFineness);
  poses += tuner.poses();
  return found.best;
}

Tuned tune_isolated(const TuneProblem& problem, int evaluations, std::uint64_t seed) {
  Tuned tuned;
  const std::vector<double> place =
      zone_place(problem, std::max(20, evaluations / 10), seed, tuned.poses);
  Tuner tuner(problem);
  std::vector<double> start = tuner.start();
  std::ranges::copy(place, start.end() - static_cast<std::ptrdiff_t>(place.size()));

  tuned.initial = tuner.look(start, kFinalFineness);
  tuned.search = tuner.search(start, {evaluations, seed}, kSearchFineness);
  std::vector<double> best = tuned.search.best;
  // A finer look sees what fell between the points of a coarse one, so climb again.
  const Fineness thorough{kFinalFineness.across, kFinalFineness.up, kFinalFineness.tilts,
                          kPolishFineness.volume_points};
  const SearchOptions again{std::max(20, evaluations / 5), seed, 0, 1e-4};
  best = tuner.search(best, again, kPolishFineness).best;
  if (tuner.look(best, thorough).score < 0) best = tuner.search(best, again, thorough).best;

  tuned.best = tuner.look(best, kFinalFineness);
  if (tuned.best.score < tuned.initial.score) tuned.best = tuned.initial;
  tuned.poses += tuner.poses();
  return tuned;
}

}  // namespace

double evaluate(const Constraint& constraint, const Layout& layout, const ParameterValues& values) {
  Scope scope;
  scope.degrees = layout.units.angle == "deg";
  for (const Parameter& parameter : layout.parameters) {
    const auto value = values.find(parameter.name);
    scope.names.emplace_back(parameter.name,
                             value == values.end() ? parameter.value : value->second);
  }
  const Evaluation result = evaluate(constraint.expression, scope);
  if (!result.error.empty())
    throw InputError({{"", "", '"' + constraint.expression + '"', result.error, result.hint}});
  return result.value;
}

std::vector<std::string> turnable(const Layout& layout) {
  const std::set<std::string> used = used_names(layout.document);
  std::vector<std::string> names;
  for (const Parameter& parameter : layout.parameters)
    if (parameter.min < parameter.max && used.contains(parameter.name))
      names.push_back(parameter.name);
  return names;
}

Design place_zone(const TuneProblem& problem, int evaluations, std::uint64_t seed,
                  const Fineness& fineness) {
  return isolated([&] {
    const TuneProblem fixed = without_parameters(problem);
    std::size_t poses = 0;
    return Tuner(fixed).look(zone_place(problem, evaluations, seed, poses), fineness);
  });
}

Tuned tune(const TuneProblem& problem, int evaluations, std::uint64_t seed) {
  return isolated([&] { return tune_isolated(problem, evaluations, seed); });
}

}  // namespace polyglide
