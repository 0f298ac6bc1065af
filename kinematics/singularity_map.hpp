#pragma once

#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "kinematics/singularity.hpp"

namespace polyglide {

struct SingularityMapOptions {
  std::array<int, 2> axes{0, 1};  ///< 0..5 = X Y Z A B C, different ones that the machine commands
  /// Where the others stay: x y z [m], a b c [rad] from home.
  Eigen::Matrix<double, 6, 1> at = Eigen::Matrix<double, 6, 1>::Zero();
  std::vector<std::string> ignored;  ///< limits that do not count
  int nodes = 0;  ///< along the longer side, >= 4; 0: 100 in closed form, else 28
  /// Told `done` of about `total` poses now and then.
  std::function<void(double done, double total)> progress;
};

/// A line in the plane of the map along which postures are singular, or closed postures end.
struct SingularCurve {
  /// "direct" (type II: det J changes its sign), "inverse" (type I), "constraint", joined by " and
  /// "; "end of reach" where no posture lies beyond and none of them could be told.
  std::string kind;
  std::vector<SingularScrew> gained, lost;    ///< where it was classified
  std::vector<std::array<double, 2>> points;  ///< [m, rad], bisected; chained
  bool closed = false;
};

/// Singularities over a slice of the task space, on home's inverse branch. Limits are left
/// aside for the curves and kept beside them.
struct SingularityMap {
  std::array<int, 2> axes{};
  Eigen::Matrix<double, 6, 1> at = Eigen::Matrix<double, 6, 1>::Zero();
  bool square = false;  ///< as many drives as task axes: det J has a sign; else only 1/κ tells
  std::vector<double> u, v;               ///< nodes along the axes [m, rad]
  std::vector<double> inverse_condition;  ///< [v · u.size() + u]; NaN where no posture is
  std::vector<signed char> side;          ///< sign of det J; 0 where it has none
  std::vector<int> limit;                 ///< -1 within all limits, else an index into limits
  std::vector<std::string> limits;
  std::vector<SingularCurve> curves;
  /// Changes of sign at which no posture looked at is singular: there the solver goes over to
  /// another branch. They are no curves.
  int branch_changes = 0;
  int singular_nodes = 0;        ///< with 1/κ < 1e-6: singular without a change of sign
  std::array<double, 2> cell{};  ///< finest cells: a closed curve within one is not seen [m, rad]
  std::size_t poses = 0;
  double seconds = 0;
};

/// Evaluates a grid, cuts the cells between which the sign of det J or the reach changes, their
/// neighbours and those that are nearly singular into 4×4 (2×2 without closed form), and extracts
/// the curves by marching squares with ends bisected on the edges. A posture half way along each
/// curve is classified, or one of two others when that is regular. The slice is drawn round what is
/// within limits, or else round what can be reached. Cost: some 1e5 poses in closed form, some 1e3
/// otherwise.
/// @throws std::invalid_argument for axes that are equal or not commanded, or a place not finite
[[nodiscard]] SingularityMap singularity_map(const Machine& machine,
                                             const SingularityMapOptions& options);

/// Which slice it is, for people: "AB at Z 50 mm", "XY through home".
[[nodiscard]] std::string slice_words(const SingularityMap& map);

/// The `workspace --singularity-map --json` document.
[[nodiscard]] nlohmann::ordered_json to_json(const SingularityMap& map);

}  // namespace polyglide
