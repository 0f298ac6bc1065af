#pragma once

#include <optional>
#include <string>

#include "optimizer/brief.hpp"
#include "optimizer/tune.hpp"
#include "synthesis/store.hpp"

namespace polyglide {

/// Finished tunings in a campaign's store, so that an interrupted run goes on where it
/// stopped. What a tuning depends on beside the space and the seed, which the store is
/// bound to, is in the key: the layout and all of the brief that matters. Numbers are
/// stored exactly. Without a store nothing is found and nothing kept.
class TuningStore {
 public:
  TuningStore(Store* store, const Brief& brief);

  [[nodiscard]] std::optional<Tuned> find(const std::string& layout) const;
  void put(const std::string& layout, const Tuned& tuned) const;

 private:
  [[nodiscard]] std::string key(const std::string& layout) const { return layout + ' ' + brief_; }
  Store* store_;
  std::string brief_;  ///< hash of what matters in the brief
};

}  // namespace polyglide
