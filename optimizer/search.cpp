#include "optimizer/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlopt.hpp>
#include <stdexcept>

namespace polyglide {
namespace {

constexpr double kWorst = -1e30;  // stands for values that are not finite; NLopt wants numbers

void check(const SearchProblem& problem, const SearchOptions& options) {
  const std::size_t size = problem.lower.size();
  if (problem.upper.size() != size || problem.start.size() != size)
    throw std::invalid_argument("maximise: lower, upper and start differ in length");
  for (std::size_t i = 0; i < size; ++i)
    if (!(problem.lower[i] <= problem.upper[i]) || !std::isfinite(problem.start[i]))
      throw std::invalid_argument("maximise: bounds out of order, or a start that is no number");
  if (options.evaluations < 1)
    throw std::invalid_argument("maximise: needs at least one evaluation");
}

/// One search: counts calls, remembers the best, and shows NLopt only the variables
/// that are free, each as a part of its range.
class Search {
 public:
  Search(const SearchProblem& problem, const SearchOptions& options)
      : problem_(problem), options_(options) {
    for (std::size_t i = 0; i < problem.lower.size(); ++i)
      if (problem.lower[i] < problem.upper[i]) free_.push_back(i);
    summary_.best = problem.start;
    for (std::size_t i = 0; i < problem.start.size(); ++i)
      summary_.best[i] = std::clamp(problem.start[i], problem.lower[i], problem.upper[i]);
    summary_.value = kWorst;
    base_ = summary_.best;
  }

  SearchSummary run() {
    evaluate(shares(base_));
    if (free_.empty()) {
      summary_.stopped = "nothing to turn";
    } else {
      run_global();
      run_local();
    }
    if (!summary_.usable) summary_.value = -std::numeric_limits<double>::infinity();
    return std::move(summary_);
  }

 private:
  static double called(const std::vector<double>& shares, std::vector<double>&, void* self) {
    return static_cast<Search*>(self)->evaluate(shares);
  }

  double evaluate(const std::vector<double>& shares) {
    if (summary_.evaluations >= options_.evaluations) throw nlopt::forced_stop();
    const std::vector<double> point = point_at(shares);
    double value = problem_.value(point);
    ++summary_.evaluations;
    if (!std::isfinite(value)) return kWorst;
    if (!summary_.usable || value > summary_.value) {
      summary_.best = point;
      summary_.value = value;
      summary_.usable = true;
      summary_.history.emplace_back(summary_.evaluations, value);
    }
    return value;
  }

  std::vector<double> point_at(const std::vector<double>& shares) const {
    std::vector<double> point = base_;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const std::size_t i = free_[k];
      point[i] = std::clamp(std::lerp(problem_.lower[i], problem_.upper[i], shares[k]),
                            problem_.lower[i], problem_.upper[i]);
    }
    return point;
  }

  std::vector<double> shares(const std::vector<double>& point) const {
    std::vector<double> result;
    for (const std::size_t i : free_)
      result.push_back((point[i] - problem_.lower[i]) / (problem_.upper[i] - problem_.lower[i]));
    return result;
  }

  nlopt::opt stage(nlopt::algorithm algorithm, int evaluations) {
    nlopt::opt opt(algorithm, static_cast<unsigned>(free_.size()));
    opt.set_lower_bounds(0.0);
    opt.set_upper_bounds(1.0);
    opt.set_max_objective(&Search::called, this);
    opt.set_maxeval(std::max(evaluations, 1));
    return opt;
  }

  void optimise(nlopt::opt& opt) {
    std::vector<double> point = shares(summary_.best);
    double value = 0;
    try {
      const nlopt::result why = opt.optimize(point, value);
      summary_.stopped = why == nlopt::MAXEVAL_REACHED ? "evaluations used up" : "converged";
    } catch (const nlopt::forced_stop&) {
      summary_.stopped = "evaluations used up";
    } catch (const nlopt::roundoff_limited&) {
      summary_.stopped = "converged";
    }
  }

  /// A population must be larger than n + 1. The usual 10 (n + 1) would eat a small
  /// budget; a tenth of it was best on layouts of four limbs.
  void run_global() {
    const int budget = static_cast<int>(options_.global_share * options_.evaluations);
    const int size = static_cast<int>(free_.size());
    const int population = std::clamp(budget / 10, size + 3, 10 * (size + 1));
    if (budget < 2 * population) return;
    nlopt::srand(static_cast<unsigned long>(options_.seed));
    nlopt::opt opt = stage(nlopt::GN_CRS2_LM, budget - summary_.evaluations);
    opt.set_population(static_cast<unsigned>(population));
    opt.set_xtol_abs(options_.tolerance);
    optimise(opt);
  }

  void run_local() {
    const int left = options_.evaluations - summary_.evaluations;
    if (left <= 0) {
      summary_.stopped = "evaluations used up";
      return;
    }
    nlopt::opt opt = stage(nlopt::LN_SBPLX, left);
    opt.set_initial_step(0.1);
    opt.set_xtol_abs(options_.tolerance);
    optimise(opt);
  }

  const SearchProblem& problem_;
  const SearchOptions& options_;
  std::vector<std::size_t> free_;  ///< indices of variables that may change
  std::vector<double> base_;       ///< values of the fixed ones
  SearchSummary summary_;
};

}  // namespace

SearchSummary maximise(const SearchProblem& problem, const SearchOptions& options) {
  check(problem, options);
  return Search(problem, options).run();
}

}  // namespace polyglide
