#pragma once

#include "kinematics/rank.hpp"
#include "kinematics/task.hpp"

namespace polyglide {

/// How sure a kernel must be: decided by singular values, or by pivots where they leave no doubt.
enum class Certainty { confirmed, screened };

/// Kernel of the loop-closure Jacobian, one row per freedom (scaled rates).
/// The freedoms of the closing joints are eliminated first (each loop is projected
/// on what its closing joint cannot do), which leaves the kernel as it is and the
/// matrix a third as large. Columns are orthonormal in the other freedoms.
[[nodiscard]] Kernel closure_kernel(const Model& model, const Eigen::MatrixXd& jacobian,
                                    Certainty certainty = Certainty::confirmed);

/// Instantaneous freedoms of a mechanism at one posture.
struct Freedoms {
  RankDecision rank;         ///< of the loop-closure Jacobian, or of the drives' rates when held
  double pivot = 0;          ///< as in Kernel: how far from singular, for comparing postures
  Eigen::MatrixXd kernel;    ///< freedoms × mobility, scaled rates
  Eigen::MatrixXd platform;  ///< 6×mobility: platform twist per kernel column, [w; v of tool/size]
  int mobility = 0;
  RankDecision platform_rank;  ///< of `platform`
};

/// Platform twist per column of scaled joint rates, 6×columns: [w; v of the tool point / size].
[[nodiscard]] Eigen::MatrixXd platform_motion(const Model& model, const Posture& posture,
                                              const Eigen::MatrixXd& rates);

/// Freedoms with nothing held. Screened ones leave the platform aside.
[[nodiscard]] Freedoms freedoms_at(const Model& model, const Posture& posture,
                                   Certainty certainty = Certainty::confirmed);

/// What is left of them with all drives held: the part of the kernel in which no drive
/// moves. Costs one small decomposition instead of another large one.
[[nodiscard]] Freedoms hold_drives(const Model& model, const Freedoms& free);

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

}  // namespace polyglide
