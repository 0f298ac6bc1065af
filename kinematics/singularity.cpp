#include "kinematics/singularity.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "kinematics/manifold.hpp"
#include "kinematics/motion.hpp"
#include "kinematics/screw_words.hpp"
#include "kinematics/second_order.hpp"

namespace polyglide {
namespace {

constexpr double kVisible = 1e-9;  // of a unit kernel vector's rates; less is an idle freedom

/// The mechanism's visible motions at a posture: combinations of kernel columns that move a drive
/// or the platform.
struct Rates {
  Eigen::MatrixXd drives;    ///< D: drive rates / size, per visible motion
  Eigen::MatrixXd platform;  ///< P: [w · length; v of the tool] / size
  Eigen::MatrixXd twists;    ///< [w; v of the tool / size]
};

Rates visible_rates(const Machine& machine, const Freedoms& freedoms) {
  const Model& model = machine.model;
  const double turning = machine.task.characteristic_length / model.size;
  Eigen::MatrixXd platform = freedoms.platform;
  platform.topRows(3) *= turning;
  Eigen::MatrixXd drives = freedoms.kernel(model.drives, Eigen::all);
  for (std::size_t d = 0; d < model.drives.size(); ++d)
    if (!model.freedoms[model.drives[d]].translational)
      drives.row(static_cast<Eigen::Index>(d)) *= turning;
  Eigen::MatrixXd both(drives.rows() + 6, freedoms.mobility);
  both << drives, platform;
  const Svd svd = svd_of(both);
  const Eigen::Index visible = (svd.values.array() > kVisible).count();
  const Eigen::MatrixXd mix = svd.v.leftCols(visible);
  return {drives * mix, platform * mix, freedoms.platform * mix};
}

/// Smallest over largest singular value; 0 when there are fewer rows than columns.
double margin_of(const Eigen::MatrixXd& rates) {
  if (rates.cols() == 0) return 1;
  if (rates.rows() < rates.cols()) return 0;
  const Eigen::VectorXd s = singular_values(rates);
  return s[0] > 0 ? s[s.size() - 1] / s[0] : 0;
}

/// Columns: what `rates` sends to zero.
Eigen::MatrixXd unseen_by(const Eigen::MatrixXd& rates, double singular) {
  const Svd svd = svd_of(rates);
  const Eigen::VectorXd& s = svd.values;
  Eigen::Index rank = 0;
  while (rank < s.size() && s[rank] > singular * s[0]) ++rank;
  return svd.v.rightCols(rates.cols() - rank);
}

/// Wrenches [f; n/size] about the tool that do no work on twists [w; v/size] of it.
Eigen::MatrixXd reciprocal(const Eigen::MatrixXd& twists, double singular) {
  Eigen::MatrixXd swapped(twists.cols(), 6);
  swapped << twists.bottomRows(3).transpose(), twists.topRows(3).transpose();
  return unseen_by(swapped, singular);
}

/// A posture close by, where the machine is regular if it ever is.
Posture nearby(const Model& model, const Posture& posture, const Eigen::MatrixXd& kernel) {
  constexpr double kStep = 0.02;
  std::mt19937_64 random(1);
  const std::vector<int> active = all_freedoms(model);
  for (int attempt = 0; attempt < 8; ++attempt) {
    Posture moved = posture;
    const Eigen::VectorXd along =
        tangent(model, moved, active, kernel * random_direction(random, kernel.cols()));
    if (!along.isZero() && step_along(model, moved, active, along, kStep).closed) return moved;
  }
  return posture;
}

std::vector<SingularScrew> in_words(const Eigen::MatrixXd& screws, const Vector3& point,
                                    double size, std::string (*describe)(const Screw&)) {
  std::vector<SingularScrew> list;
  for (const Screw& screw : plain_basis(screws, point, size))
    list.push_back({describe(screw), screw});
  return list;
}

/// Wrenches borne at this posture that are not borne close by.
std::vector<SingularScrew> lost_motions(const Machine& machine, const Posture& posture,
                                        const Freedoms& freedoms, const Rates& rates,
                                        double singular) {
  const Model& model = machine.model;
  const Posture other = nearby(model, posture, freedoms.kernel);
  const Rates generic = visible_rates(machine, freedoms_at(model, other));
  const Eigen::MatrixXd here = reciprocal(rates.twists, singular);
  const Eigen::MatrixXd there = reciprocal(generic.twists, kVisible);
  const Eigen::Index more = here.cols() - there.cols();
  if (more <= 0) return {};
  const Eigen::MatrixXd rest = here - there * (there.transpose() * here);
  const Svd svd = svd_of(rest);
  const Vector3 tool = posture.bodies[model.mechanism.platform] * model.mechanism.tool;
  return in_words(here * svd.v.leftCols(more), tool, model.size, describe_wrench);
}

}  // namespace

Singularity singularity_at(const Machine& machine, const Posture& posture, int mobility,
                           double singular) {
  const Model& model = machine.model;
  const Freedoms freedoms = freedoms_at(model, posture);
  const Rates rates = visible_rates(machine, freedoms);
  const Vector3 tool = posture.bodies[model.mechanism.platform] * model.mechanism.tool;
  Singularity found;
  found.direct_margin = margin_of(rates.drives);
  found.inverse_margin = margin_of(rates.platform);
  found.direct = found.direct_margin < singular;
  found.inverse = found.inverse_margin < singular;
  found.constraint = freedoms.mobility > mobility;
  if (found.direct)
    found.gained = in_words(rates.twists * unseen_by(rates.drives, singular), tool, model.size,
                            describe_twist);
  if (found.inverse) found.lost = lost_motions(machine, posture, freedoms, rates, singular);
  return found;
}

std::string singularity_name(const Singularity& singularity) {
  std::string name;
  const auto add = [&](bool has, const char* word) {
    if (has) name += (name.empty() ? "" : " and ") + std::string(word);
  };
  add(singularity.direct, "direct (type II)");
  add(singularity.inverse, "inverse (type I)");
  add(singularity.constraint, "constraint");
  return name.empty() ? "regular" : name;
}

double smaller_margin(const Machine& machine, const Posture& posture) {
  const Rates rates = visible_rates(machine, freedoms_at(machine.model, posture));
  return std::min(margin_of(rates.drives), margin_of(rates.platform));
}

}  // namespace polyglide
