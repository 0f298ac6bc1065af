#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catalog/layout.hpp"
#include "synthesis/space.hpp"
#include "synthesis/store.hpp"

namespace polyglide {

/// How far an enumeration has come.
struct EnumerationProgress {
  std::string stage;  ///< "expand", then "check"
  std::uint64_t done = 0, total = 0;
};

struct EnumerationOptions {
  int threads = 0;         ///< 0: one per core
  std::uint64_t seed = 1;  ///< of the mobility analysis
  Store* store = nullptr;  ///< verdicts found there are not computed again; new ones go there
  std::function<void(const EnumerationProgress&)> progress;  ///< called by one thread at a time
};

/// One distinct layout of a space with its verdict.
struct Candidate {
  std::string id;                              ///< short_id of its canonical form
  std::uint64_t raw_index = 0;                 ///< the lowest of those that are this layout
  std::uint64_t raw_count = 0;                 ///< how many are
  double symmetry = 1;                         ///< see CanonicalForm
  std::string known_as;                        ///< catalog entry it is, or ""
  std::map<std::string, std::string> choices;  ///< label taken, by name of the choice
  nlohmann::json check;                        ///< the `check --json` document

  [[nodiscard]] std::string verdict() const { return check.at("verdict"); }
  [[nodiscard]] std::string pattern() const { return check.at("platform").at("pattern"); }
  [[nodiscard]] std::string axes() const { return check.at("platform").at("axes"); }
  /// First reason of the verdict.
  [[nodiscard]] std::string reason() const;
};

/// Raw candidates that cannot be built, by the same cause.
struct Unbuildable {
  std::string reason;
  std::uint64_t raw_index = 0;  ///< the lowest
  std::uint64_t raw_count = 0;
};

/// Everything a space holds.
struct Enumeration {
  std::uint64_t raw = 0;
  std::vector<Candidate> candidates;         ///< by ascending raw index
  std::vector<Unbuildable> unbuildable;      ///< by ascending raw index
  std::map<std::string, std::string> known;  ///< id by catalog entry, those the space contains
  std::string store;                         ///< path, "" without one
  std::uint64_t checked = 0;  ///< verdicts computed in this run, not read from the store
  double seconds = 0, expand_seconds = 0, check_seconds = 0;
};

/// Every distinct layout of a space, each checked once at the parameter values
/// of the file. Raw candidates with the same canonical form are one layout, seen
/// with its lowest index; one whose carriages cannot be placed is unbuildable.
/// Same result for any number of threads, and whether or not a store had part of it.
/// Cost: per raw candidate about 0.5 ms, per distinct one a mobility analysis.
/// @throws InputError: a store that cannot be written, more than 5 million raw
///         candidates, or none that can be built (with the causes).
[[nodiscard]] Enumeration enumerate(const Space& space, const EnumerationOptions& options = {});

/// The layout of a raw candidate, named and titled, ready for expand(), a study or a file.
/// @throws std::out_of_range
[[nodiscard]] Layout candidate_layout(const Space& space, std::uint64_t raw_index,
                                      const std::string& name);

/// What a store of this space's enumeration belongs to: the space by content, the seed, and
/// the version of polyglide. Add facts for evaluations that depend on more.
[[nodiscard]] StoreIdentity campaign_identity(const Space& space, std::uint64_t seed);

/// The `enumerate --json` document.
[[nodiscard]] nlohmann::ordered_json to_json(const Enumeration& enumeration);

}  // namespace polyglide
