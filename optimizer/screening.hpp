#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "optimizer/brief.hpp"
#include "optimizer/run_options.hpp"
#include "synthesis/enumerate.hpp"

namespace polyglide {

/// Why a checked candidate cannot do what a brief asks, as a group's name; "" when it
/// can. Tested in this order: rigid, uncertain, singular at home, wrong motion,
/// overdriven, wrong number of drives.
[[nodiscard]] std::string rejection(const Candidate& candidate, const Brief& brief);

/// The same for what a verdict does not hold: the direction of the rotation axis.
[[nodiscard]] std::string axis_rejection(const TaskSpace& task, const Brief& brief);

/// What stands under `rejected` in a stored run: groups by reason with a few examples.
class Rejections {
 public:
  /// @param candidate one distinct layout
  /// @param sentences why, in full; the reasons of its verdict when empty
  void add(const std::string& reason, const Candidate& candidate,
           std::vector<std::string> sentences = {});
  /// Raw combinations that are no layout at all.
  void add_unbuildable(const Unbuildable& cause);

  /// {reason: count}, most frequent first.
  [[nodiscard]] nlohmann::ordered_json counts() const;

  /// With up to two examples each, or all known layouts where they are more, drawn with the freedom
  /// that is left. Cost: some 10 ms per example.
  [[nodiscard]] nlohmann::ordered_json json(const Space& space, const RunOptions& options) const;

 private:
  struct Example {
    const Candidate* candidate;
    std::vector<std::string> sentences;
  };
  struct Group {
    std::string reason;
    std::uint64_t count = 0;
    std::vector<Example> examples;
  };
  [[nodiscard]] std::vector<const Group*> by_count() const;
  std::map<std::string, Group> groups_;
};

}  // namespace polyglide
