#pragma once

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "optimizer/run_options.hpp"
#include "optimizer/tune.hpp"

/// The parts that stored runs of both kinds are made of (docs/run-format.md).
namespace polyglide {

/// A layout that a run shows in full.
struct ShownLayout {
  std::string id, known_as, title;
  std::map<std::string, std::string> choices;
  const Layout& layout;
  const TaskSpace& task;
  const Design& initial;  ///< dimensions of the file
  const Design& design;   ///< those shown
  std::vector<std::pair<int, double>> convergence;
};

/// An entry of `layouts`: verdict with evidence at these dimensions, dimension table,
/// scene, workspace with slices. Cost: some 0.1 s.
[[nodiscard]] nlohmann::ordered_json layout_json(const ShownLayout& shown, const Zone& zone,
                                                 std::uint64_t seed);

/// {"rod": 812.3, …}: the parameters a layout uses, file units; turned ones as given.
[[nodiscard]] nlohmann::ordered_json values_json(const Layout& layout,
                                                 const ParameterValues& values);

/// {index key: value} of all indices.
[[nodiscard]] nlohmann::ordered_json measures_json(const Measures& measures);

/// An empty string as null, as stored runs want names that there are not.
[[nodiscard]] nlohmann::ordered_json name_or_null(const std::string& name);

/// Collects where a run's numbers come from: started when made, finished by json().
class Provenance {
 public:
  explicit Provenance(const RunOptions& options);
  void add_hash(const std::string& what, const std::string& hash) { hashes_[what] = hash; }
  [[nodiscard]] double seconds() const;
  [[nodiscard]] nlohmann::ordered_json json() const;

 private:
  const RunOptions& options_;
  std::chrono::system_clock::time_point started_;
  nlohmann::ordered_json hashes_ = nlohmann::ordered_json::object();
};

/// One hash of all catalog entries.
[[nodiscard]] std::string catalog_hash();

}  // namespace polyglide
