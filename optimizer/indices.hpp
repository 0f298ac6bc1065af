#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinematics/evaluate.hpp"
#include "optimizer/zone.hpp"

namespace polyglide {

/// A number that says how good a design is in one respect, and how to read it.
struct Index {
  std::string key, label, unit;
  double scale = 1;    ///< shown value = stored value × scale
  bool higher = true;  ///< is more of it better?
  std::string about;   ///< the formula in words
  bool weighable =
      false;  ///< may be an objective: dimensionless, in (0, 1] once the zone is covered
};

/// All indices, in the order of reports. The weighable ones:
/// - workspace = V_use / V_envelope, V_use the volume of tool positions that the machine
///   reaches untilted, within its limits and with 1/κ above the bound, without crossing
///   a singularity seen from the zone's centre; V_envelope the box around all joints
///   over their strokes with the platform wherever V_use and the zone put it (see
///   envelope()), or the given one.
/// - conditioning = mean of 1/κ over the zone's positions and orientations.
/// - worst_conditioning = least 1/κ over them.
/// - compactness = V_zone / V_envelope.
[[nodiscard]] const std::vector<Index>& indices();

/// The keys of the weighable indices.
[[nodiscard]] std::vector<std::string> objective_words();

/// The `indices` list of a stored run (docs/run-format.md).
[[nodiscard]] nlohmann::ordered_json indices_json();

/// What an index is called on pages; a key that is none's as it is.
[[nodiscard]] std::string label_of(const std::string& key);

/// A label as it reads within a sentence: with a small first letter.
[[nodiscard]] std::string lowered(std::string label);

/// What is asked of a design.
struct Requirements {
  Zone zone;
  double condition = 0;  ///< largest condition number allowed in the zone; 0 = any
  std::vector<std::pair<std::string, double>> objectives;  ///< weights > 0 of weighable indices
  std::optional<Vector3> envelope;  ///< [m] space that is given, instead of the machine's own
};

/// A machine as it is compared with others: its characteristic length is the zone's lever().
[[nodiscard]] Machine machine_for(const Mechanism& mechanism, const TaskSpace& task,
                                  const Zone& zone);

/// How finely a design is looked at.
struct Fineness {
  int across = 5, up = 3;  ///< lattice of the zone
  int tilts = 1;           ///< steps to either side
  int volume_points = 512;
  bool whole = false;  ///< measure the volume also where the zone is not covered: no score needs it
};

inline constexpr Fineness kSearchFineness{5, 3, 1, 512};
inline constexpr Fineness kPolishFineness{9, 5, 1, 2048};
inline constexpr Fineness kFinalFineness{17, 9, 2, 65536, true};

/// The indices of one design with the zone at one place.
struct Measures {
  double coverage = 0;  ///< part of positions × orientations reachable with 1/κ above the bound, on
                        ///< one side of singularities
  double credit =
      0;  ///< the same, where a reachable but ill-conditioned pose earns a part: slope for a search
  double workspace = 0, conditioning = 0, worst_conditioning = 0, compactness = 0;
  double volume = 0;    ///< V_use [m³]
  double envelope = 0;  ///< V_envelope [m³]
  std::size_t poses = 0;

  /// The value of an index, by key. @throws std::invalid_argument unknown key.
  [[nodiscard]] double operator[](const std::string& key) const;
};

/// Measures a machine, from machine_for(), with the zone's centre at `center` [m].
/// Volume: a fixed low-discrepancy sample of reach_box(), relative error about
/// 1/points^0.8. Same bits for any thread count.
/// Cost: poses × cost of the evaluator (0.1 to 0.4 ms at the fineness of a search).
/// @return volume, envelope and what is made of them are 0 where they are not measured.
[[nodiscard]] Measures measure(const Evaluator& evaluator, const Requirements& requirements,
                               const Vector3& center, const Fineness& fineness);

/// One number to rank by. When the whole zone is covered: the weighted geometric mean
/// of the objectives, in (0, 1]; else credit − 1, below zero, so that every design that
/// does the job ranks before every one that does not, and a search feels which way
/// leads there.
[[nodiscard]] double score(const Measures& measures,
                           const std::vector<std::pair<std::string, double>>& objectives);

}  // namespace polyglide
