#pragma once

#include "kinematics/krawczyk_root.hpp"

namespace polyglide {

// Roots of equations with parameters: F(u, x) = 0 of n unknowns u for every x of a box of k
// parameters. All need UpwardRounding.

/// What is asked about F: values, and derivatives by the n unknowns, then the k parameters, on a
/// box of both. There may be more equations than unknowns, if the others follow from these.
using ParametricEnclosure =
    std::function<Enclosure(const std::vector<Interval>& unknowns, const std::vector<Interval>&)>;

/// The root at one place.
struct PointRoot {
  std::vector<double> where;   ///< the parameters
  std::vector<Interval> root;  ///< encloses it
  IntervalMatrix rates{0, 0};  ///< n×k, du/dx there
  // Of the proof: the point found, about the inverse of F_u there, and that times F.
  std::vector<double> found;
  Eigen::MatrixXd inverse;
  std::vector<Interval> step;
};

/// The roots all over a box.
struct BoxRoot {
  std::vector<Interval> alone;  ///< for every x of the box just one root is in here
  std::vector<Interval> roots;  ///< and it is in here
  IntervalMatrix rates{0, 0};   ///< n×k, du/dx all over the box
};

/// Newton's method from a guess, then a proof by Krawczyk's operator that the box about what was
/// found holds one root. Redundant equations are solved in the mean of squares and must be met
/// to 1e-9 on that box. nullopt where it does not converge, the rank is in doubt, or nothing is
/// proved.
[[nodiscard]] std::optional<PointRoot> root_at(const ParametricEnclosure& equations,
                                               const std::vector<double>& where,
                                               const std::vector<double>& guess);

/// The same for every x of a box: K(U) = û - Y F(û, X) + (I - Y F_u(U, X)) (U - û), with F(û, X) by
/// the mean value theorem and Y about the inverse of F_u in the middle, lies in U. The derivative
/// of the root is enclosed from F_u u' = -F_x all over the box.
/// @param about the root at a place of the box.
[[nodiscard]] std::optional<BoxRoot> roots_over(const ParametricEnclosure& equations,
                                                const std::vector<Interval>& box,
                                                const PointRoot& about);

/// Whether every number of `a` is in `b`.
[[nodiscard]] bool within(const std::vector<Interval>& a, const std::vector<Interval>& b);

/// Where the root at a place is, from another and the rates on a box that holds both.
[[nodiscard]] std::vector<Interval> moved(const PointRoot& from, const IntervalMatrix& rates,
                                          const std::vector<Interval>& to);

}  // namespace polyglide
