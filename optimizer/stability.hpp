#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "optimizer/indices.hpp"

namespace polyglide {

/// Another way to weigh the same measures.
struct Scheme {
  std::string label;
  std::vector<std::pair<std::string, double>> weights;
};

/// The stated weights first; then equal weights, each index alone, the stated ones
/// without each of theirs, and with mean and worst conditioning exchanged. Schemes
/// that weigh alike are listed once.
[[nodiscard]] std::vector<Scheme> schemes_for(
    const std::vector<std::pair<std::string, double>>& stated);

/// A ranked design, by its id, as the stated weights rank it.
struct RankedMeasures {
  std::string id, name;
  Measures measures;
};

/// How ranks change with the weights: `stability` of a stored run. The designs stay as
/// they were tuned for the stated weights. The statement names how often the first keeps
/// its place, who replaces it where, and the rank correlation (Kendall's tau) with
/// the stated order.
[[nodiscard]] nlohmann::ordered_json stability_json(
    const std::vector<RankedMeasures>& ranked,
    const std::vector<std::pair<std::string, double>>& stated);

/// Kendall's tau-a of two rankings of the same things, -1 (reversed) to 1 (equal);
/// 1 for fewer than two.
[[nodiscard]] double kendall_tau(const std::vector<int>& a, const std::vector<int>& b);

}  // namespace polyglide
