#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinematics/inscribed.hpp"
#include "kinematics/orientation_set.hpp"
#include "kinematics/rotation_range.hpp"
#include "kinematics/shape_evidence.hpp"

namespace polyglide {

struct WorkspaceOptions {
  std::vector<std::string> ignored;                              ///< limits that do not count
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< orientation of the platform
  /// Instead of one orientation: only places where all of these can be had count (the dexterous, or
  /// total orientation workspace).
  std::optional<OrientationSet> orientations;
  double accuracy = 5e-4;      ///< relative uncertainty of the volume aimed at
  int slices = 9;              ///< horizontal slices kept for maps
  bool volume_only = false;    ///< skip shapes, slices and rotation range: for tuning
  std::optional<Vector3> box;  ///< also: does a box of this size fit, and where [m]
  std::optional<std::pair<double, double>> cylinder;  ///< also: does diameter × height fit [m]
  /// Told `done` of about `total` poses now and then, from one thread at a time or several;
  /// `total` 0 when more are needed than expected, and nobody knows how many.
  std::function<void(double done, double total)> progress;
};

/// What is known about a workspace of many orientations.
struct OrientationSamples {
  OrientationSet set;
  std::size_t count = 0,
              coarser = 0;  ///< orientations asked at every place; and before, for comparison
  double change = 0;        ///< relative: how much volume the coarser samples claimed beyond these
};

/// Horizontal slice with 1/κ (NaN = outside).
struct Slice {
  double z = 0;
  std::vector<double> x, y, inverse_condition;  ///< values row by row, x fastest
};

/// Translation workspace at one orientation. Positions are tool displacements
/// from home, base frame, metres.
struct Workspace {
  double volume = 0;  ///< [m³], 0 unless the machine commands three translations
  double area = 0;    ///< [m²] of machines with two
  double length = 0;  ///< [m] of machines with one
  double volume_lower = 0, volume_upper = 0;  ///< cells wholly in / not wholly out
  /// How `volume` (or `area`) came about: "quadrature" over its pieces, or "sampling".
  std::string method = "sampling";
  double error = 0;  ///< estimated, of volume [m³] or area [m²]
  /// Size of all places where the limits hold, on either side of singular surfaces and in other
  /// parts too [m³ or m²]; by quadrature only.
  std::optional<double> reach;
  double area_lower = 0, area_upper = 0;  ///< bounds of `area` [m²]
  bool singular_throughout =
      false;               ///< every pose of this orientation is singular: limits alone count
  bool certified = false;  ///< the bounds are proved by intervals; else estimated by sampling
  Vector3 lower = Vector3::Zero(), upper = Vector3::Zero();  ///< bounding box of reachable cells
  std::vector<std::pair<double, double>> area_by_z;
  Cylinder inscribed_cylinder;  ///< largest volume
  Box inscribed_box;            ///< largest volume
  Sphere inscribed_sphere;
  ShapeEvidence cylinder_evidence, box_evidence, sphere_evidence;
  std::vector<Cylinder> cylinders;  ///< largest height for a series of diameters
  double global_conditioning = 0, worst = 0, best = 0;  ///< mean, least and greatest 1/κ
  double characteristic_length = 0;
  std::string stopped_by;  ///< what stops home in this orientation where the workspace is empty
  std::map<std::string, double> limits_hit;  ///< share of the boundary each limit makes
  std::vector<Slice> slices;
  using RotationRange = polyglide::RotationRange;
  std::optional<OrientationSamples> orientations;  ///< when many were asked for
  std::optional<RotationRange> rotation_range;     ///< widest found, for 3T1R machines
  std::optional<Box> asked_box;                    ///< where the asked box fits
  std::optional<Cylinder> asked_cylinder;          ///< where the asked cylinder fits
  std::size_t poses = 0;
  double seconds = 0;
};

/// Volume, slices, inscribed shapes, conditioning and the limits that bound the
/// workspace. Same bits for any thread count.
///
/// With a set of orientations a place counts where every sample of the set is reachable, regular
/// and on home's side of the singular surfaces. Between the samples nothing is asked: the volume is
/// an upper estimate in this respect, and its lower bound is lowered by what the last halving of
/// the samples' distance took away. No proof then, and no rotation range.
/// @throws std::invalid_argument for a set that is not finite or negative
[[nodiscard]] Workspace compute_workspace(const Machine& machine,
                                          const WorkspaceOptions& options = {});

/// The `workspace --json` document.
[[nodiscard]] nlohmann::ordered_json to_json(const Workspace& workspace);

}  // namespace polyglide
