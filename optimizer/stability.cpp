#include "optimizer/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;
using Weights = std::vector<std::pair<std::string, double>>;

std::map<std::string, double> shares(const Weights& weights) {
  double sum = 0;
  for (const auto& [key, weight] : weights) sum += weight;
  std::map<std::string, double> result;
  for (const auto& [key, weight] : weights) result[key] += weight / sum;
  return result;
}

/// Weights with one key replaced; empty when it is not among them, or the other one is.
Weights exchanged(Weights weights, const std::string& from, const std::string& to) {
  const auto has = [&](const std::string& key) {
    return std::ranges::find(weights, key, &Weights::value_type::first) != weights.end();
  };
  if (!has(from) || has(to)) return {};
  for (auto& [key, weight] : weights)
    if (key == from) key = to;
  return weights;
}

std::vector<int> ranks_under(const std::vector<RankedMeasures>& ranked, const Weights& weights) {
  std::vector<std::size_t> order(ranked.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<double> scores;
  for (const RankedMeasures& one : ranked) scores.push_back(score(one.measures, weights));
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return scores[a] > scores[b]; });
  std::vector<int> ranks(ranked.size());
  for (std::size_t place = 0; place < order.size(); ++place)
    ranks[order[place]] = static_cast<int>(place) + 1;
  return ranks;
}

std::string statement(const std::vector<RankedMeasures>& ranked, const std::vector<Scheme>& schemes,
                      const std::vector<std::vector<int>>& ranks) {
  if (ranked.size() < 2) return "There are fewer than two ranked layouts, so no order to test.";
  std::size_t kept = 0, lowest = 0;
  std::vector<double> taus;
  std::map<std::string, std::string> winners;  // where, by name of who wins there
  for (std::size_t s = 0; s < schemes.size(); ++s) {
    taus.push_back(kendall_tau(ranks[0], ranks[s]));
    if (taus[s] < taus[lowest]) lowest = s;
    const auto first = std::ranges::find(ranks[s], 1) - ranks[s].begin();
    if (first == 0) {
      ++kept;
    } else {
      std::string& where = winners[ranked[first].name];
      where += (where.empty() ? "" : "; ") + lowered(schemes[s].label);
    }
  }
  std::string text = fmt::format("{} is first in {} of {} ways to weigh the indices.",
                                 ranked[0].name, kept, schemes.size());
  for (const auto& [name, where] : winners)
    text += fmt::format(" {} is first with: {}.", name, where);
  return text +
         fmt::format(" The order differs most with: {} (Kendall's tau {:.2f} to the stated order).",
                     lowered(schemes[lowest].label), taus[lowest]);
}

}  // namespace

std::vector<Scheme> schemes_for(const Weights& stated) {
  std::vector<Scheme> schemes;
  std::vector<std::map<std::string, double>> seen;
  const auto add = [&](std::string label, Weights weights) {
    if (weights.empty()) return;
    auto share = shares(weights);
    if (std::ranges::find(seen, share) != seen.end()) return;
    seen.push_back(std::move(share));
    schemes.push_back({std::move(label), std::move(weights)});
  };
  add("Stated weights", stated);
  Weights equal = stated;
  for (auto& [key, weight] : equal) weight = 1;
  add("Stated indices, equal weights", equal);
  add("Worst instead of mean conditioning",
      exchanged(stated, "conditioning", "worst_conditioning"));
  add("Mean instead of worst conditioning",
      exchanged(stated, "worst_conditioning", "conditioning"));
  for (const auto& [key, weight] : stated) {
    Weights rest;
    std::ranges::copy_if(stated, std::back_inserter(rest),
                         [&](const auto& one) { return one.first != key; });
    add(fmt::format("Without {}", lowered(label_of(key))), rest);
  }
  for (const std::string& key : objective_words()) add(label_of(key) + " alone", {{key, 1.0}});
  return schemes;
}

double kendall_tau(const std::vector<int>& a, const std::vector<int>& b) {
  int balance = 0, pairs = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < i; ++j, ++pairs) balance += (a[i] < a[j]) == (b[i] < b[j]) ? 1 : -1;
  return pairs > 0 ? static_cast<double>(balance) / pairs : 1;
}

Json stability_json(const std::vector<RankedMeasures>& ranked, const Weights& stated) {
  const std::vector<Scheme> schemes = schemes_for(stated);
  std::vector<std::vector<int>> ranks;
  Json json{{"schemes", Json::array()}, {"ranks", Json::object()}};
  for (const Scheme& scheme : schemes) {
    json["schemes"].push_back({{"label", scheme.label}});
    ranks.push_back(ranks_under(ranked, scheme.weights));
  }
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    Json row = Json::array();
    for (const auto& under : ranks) row.push_back(under[i]);
    json["ranks"][ranked[i].id] = row;
  }
  json["statement"] = statement(ranked, schemes, ranks);
  return json;
}

}  // namespace polyglide
