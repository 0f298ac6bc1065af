#pragma once

#include "kinematics/rank.hpp"
#include "kinematics/task.hpp"

namespace polyglide {

/// Kernel of loop closure with only `active` freedoms moving: rows in their order.
/// The freedoms of the closing joints are eliminated first (each loop is projected
/// on what its closing joint cannot do), which leaves the kernel as it is and the
/// matrix a third as large. Columns are orthonormal in the other freedoms.
[[nodiscard]] Kernel closure_kernel(const Model& model, const Eigen::MatrixXd& screws,
                                    const std::vector<int>& active);

/// Instantaneous freedoms of a mechanism at one posture.
struct Freedoms {
  RankDecision rank;         ///< of the loop-closure Jacobian
  Eigen::MatrixXd kernel;    ///< active freedoms × mobility, scaled rates
  Eigen::MatrixXd platform;  ///< 6×mobility: platform twist per kernel column, [w; v of tool/size]
  int mobility = 0;
  RankDecision platform_rank;  ///< of `platform`
};

/// Freedoms with only `active` joint freedoms moving.
[[nodiscard]] Freedoms freedoms_at(const Model& model, const Posture& posture,
                                   const std::vector<int>& active);

/// Which task coordinates are independent, from platform twists at a posture:
/// rotations by the rank of the angular part, letters by pivoting.
/// Leaves `pure`, `rotation_axis` and `characteristic_length` to the caller.
[[nodiscard]] TaskSpace task_axes(const Freedoms& freedoms);

/// RMS distance of the platform's joint points from the tool point [m]; the
/// machine's size when all coincide with it.
[[nodiscard]] double characteristic_length(const Model& model);

/// "3T1R"; "0" when the platform cannot move.
[[nodiscard]] std::string pattern_name(int translations, int rotations);

/// "XYZA"
[[nodiscard]] std::string axes_name(const std::vector<int>& axes);

/// A twist in words: "rotation about the axis through (x, y, z) mm along (…)",
/// "translation along (…)", "screw motion …".
[[nodiscard]] std::string describe_twist(const Screw& twist);

}  // namespace polyglide
