#include "kinematics/evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <deque>
#include <set>

#include "kinematics/manifold.hpp"
#include "kinematics/rank.hpp"
#include "kinematics/screw_words.hpp"

namespace polyglide {
namespace {

constexpr double kMoves = 1e-6;  // of the fastest body: a slower one stands still

/// Columns of the same span with as many zeros as a reduced echelon form has, so that what happens
/// in one limb stands in one column.
Eigen::MatrixXd sparse_basis(Eigen::MatrixXd basis) {
  for (Eigen::Index c = 0; c < basis.cols(); ++c) {
    Eigen::Index row = 0, col = 0;
    basis.rightCols(basis.cols() - c).cwiseAbs().maxCoeff(&row, &col);
    basis.col(c).swap(basis.col(c + col));
    basis.col(c) /= basis(row, c);
    for (Eigen::Index other = 0; other < basis.cols(); ++other)
      if (other != c) basis.col(other) -= basis(row, other) * basis.col(c);
  }
  for (double& value : basis.reshaped())
    if (std::abs(value) < 1e-9) value = 0;
  return basis;
}

/// Finite motion where there is one, else the first-order one, for drawing.
std::vector<std::vector<Transform>> animate(const Model& model, const Posture& at,
                                            const std::vector<int>& active,
                                            const Eigen::VectorXd& rates) {
  constexpr int kFrames = 10;
  constexpr double kStep = 0.04;
  const Eigen::VectorXd along = rates(active);
  std::deque<std::vector<Transform>> frames{at.bodies};
  for (int side : {1, -1}) {
    Posture posture = at;
    for (int i = 1; i <= kFrames; ++i) {
      const Eigen::VectorXd way = tangent(model, posture, active, side * along);
      if (way.isZero() || !step_along(model, posture, active, way, kStep).closed) break;
      if (side > 0)
        frames.push_back(posture.bodies);
      else
        frames.push_front(posture.bodies);
    }
  }
  if (frames.size() > 1) return {frames.begin(), frames.end()};
  // Infinitesimal only: show the first-order motion, loops slightly open.
  for (int i = 1; i <= kFrames; ++i)
    for (int side : {1, -1}) {
      Posture posture = at;
      Eigen::VectorXd increments = Eigen::VectorXd::Zero(rates.size());
      increments(active) = side * i * kStep / 4 * along / along.cwiseAbs().maxCoeff();
      advance(model, posture, increments.cwiseProduct(freedom_scale(model)));
      if (side > 0)
        frames.push_back(posture.bodies);
      else
        frames.push_front(posture.bodies);
    }
  return {frames.begin(), frames.end()};
}

/// How fast every body moves for given rates: those that move, fastest first.
std::vector<BodyMotion> body_motions(const Model& model, const Posture& at,
                                     const Eigen::VectorXd& rates) {
  const Eigen::MatrixXd screws = freedom_screws(model, at);
  const Eigen::VectorXd real = rates.cwiseProduct(freedom_scale(model));
  std::vector<BodyMotion> motions;
  std::vector<double> speeds;
  double fastest = 0;
  for (int body = 0; body < static_cast<int>(model.mechanism.bodies.size()); ++body) {
    BodyMotion motion{body, body_jacobian(model, screws, body) * real};
    const Vector3 w = motion.twist.head<3>();
    const Vector3 centre = at.bodies[body] * model.centre;
    const double speed = w.norm() + (motion.twist.tail<3>() + w.cross(centre)).norm() / model.size;
    fastest = std::max(fastest, speed);
    motion.speed = speed;
    motions.push_back(motion);
  }
  std::erase_if(motions, [&](const BodyMotion& m) { return m.speed <= kMoves * fastest; });
  for (BodyMotion& motion : motions) motion.speed /= fastest;
  // What is equal but for rounding stays in the order of the file.
  std::ranges::stable_sort(motions, std::greater{}, [](const BodyMotion& motion) {
    return std::lround(1e9 * motion.speed);
  });
  return motions;
}

void add_modes(const Findings& findings, const std::string& about, const Posture& at,
               const Freedoms& freedoms, const std::vector<int>& active, MobilityReport& report) {
  const Model& model = findings.model;
  const Svd svd = svd_of(freedoms.platform);
  for (int i = 0; i < freedoms.platform_rank.rank; ++i) {
    FreedomMode mode;
    const Eigen::VectorXd rates = freedoms.kernel * svd.v.col(i);
    mode.bodies = body_motions(model, at, rates);
    for (const BodyMotion& motion : mode.bodies)
      if (motion.body == model.mechanism.platform) mode.twist = motion.twist;
    mode.about = about + describe_twist(mode.twist);
    mode.frames = animate(model, at, active, rates);
    report.modes.push_back(std::move(mode));
  }
}

void add_modes(const Findings& findings, MobilityReport& report) {
  if (report.verdict != Verdict::uncertain && report.verdict != Verdict::singular_home) return;
  const std::vector<int> passive = passive_freedoms(findings.model);
  if (report.home_locked_platform > 0)
    add_modes(findings, "with drives held at home: ", findings.home, findings.home_locked, passive,
              report);
  else if (report.locked_platform > 0)
    add_modes(findings, "with drives held at a generic posture: ", *findings.generic,
              *findings.locked, passive, report);
  else
    add_modes(findings, "at home, where branches meet: ", findings.home, findings.home_free,
              all_freedoms(findings.model), report);
}

/// Twists of the platform at home, as a basis that reads well, and what else moves with each.
void add_platform_motions(const Findings& findings, MobilityReport& report) {
  const Model& model = findings.model;
  const Freedoms& free = findings.home_free;
  const Vector3& tool = model.mechanism.tool;
  if (free.platform.cols() == 0) return;  // rigid at home
  for (const Screw& twist : plain_basis(free.platform, tool, model.size)) {
    const Vector3 w = twist.head<3>();
    Screw at_tool;  // as the columns of free.platform
    at_tool << w, (twist.tail<3>() + w.cross(tool)) / model.size;
    const Eigen::VectorXd rates = free.kernel * least_squares(free.platform, at_tool);
    report.platform_motions.push_back(
        {describe_twist(twist), twist, body_motions(model, findings.home, rates)});
  }
}

/// Bodies that move although the platform rests: the kernel of the platform's twist within the
/// freedoms; at home where home is like any other posture.
void add_idle_freedoms(const Findings& findings, MobilityReport& report) {
  if (!findings.free || report.idle <= 0) return;
  const Model& model = findings.model;
  const bool regular = report.home - report.platform_home_dof == report.idle;
  const Posture& at = regular ? findings.home : *findings.generic;
  const Freedoms& free = regular ? findings.home_free : *findings.free;
  const Svd svd = svd_of(free.platform);
  const Eigen::MatrixXd idle = sparse_basis(free.kernel * svd.v.rightCols(report.idle));
  for (Eigen::Index c = 0; c < idle.cols(); ++c) {
    IdleFreedom freedom;
    const std::vector<BodyMotion> motions = body_motions(model, at, idle.col(c));
    for (const BodyMotion& motion : motions)
      freedom.bodies.push_back(model.mechanism.bodies[motion.body]);
    freedom.twist = motions.front().twist;
    freedom.about =
        fmt::format("{}: {}", fmt::join(freedom.bodies, ", "), describe_twist(freedom.twist));
    report.idle_freedoms.push_back(std::move(freedom));
  }
  std::ranges::sort(report.idle_freedoms, {}, &IdleFreedom::bodies);
  std::set<std::string> seen;
  for (const IdleFreedom& freedom : report.idle_freedoms)
    for (const std::string& body : freedom.bodies)
      if (seen.insert(body).second) report.idle_rods.push_back(body);
}

/// The limbs that a loop runs through.
std::string loop_text(const Model& model, std::size_t loop) {
  std::vector<std::string> joints;
  for (const auto [joint, sign] : model.loops[loop])
    joints.push_back(model.mechanism.joints[joint].name);
  return limb_names(joints);
}

/// Inner wrenches that no freedom relieves: the left kernel of the loop-closure Jacobian.
void add_redundant_constraints(const Findings& findings, MobilityReport& report) {
  if (report.redundant_constraints <= 0) return;
  const Model& model = findings.model;
  const bool regular = report.home == report.finite || !findings.generic;
  const Posture& at = regular ? findings.home : *findings.generic;
  const Eigen::MatrixXd jacobian = closure_jacobian(model, at);
  const Eigen::MatrixXd wrenches = sparse_basis(kernel_of(jacobian.transpose()).basis);
  for (Eigen::Index c = 0; c < wrenches.cols(); ++c) {
    RedundantConstraint constraint;
    std::vector<std::string> parts;
    for (std::size_t loop = 0; loop < model.loops.size(); ++loop) {
      const Screw dual = wrenches.col(c).segment<6>(6 * static_cast<Eigen::Index>(loop));
      if (dual.isZero(1e-9)) continue;
      const Vector3 force = dual.tail<3>() / model.size;
      Screw wrench;
      wrench << force, dual.head<3>() + model.centre.cross(force);
      constraint.loops.push_back({model.mechanism.joints[model.loop_joints[loop]].name, wrench});
      parts.push_back(
          fmt::format("{} around loop {}", describe_wrench(wrench), loop_text(model, loop)));
    }
    constraint.about = fmt::format("{}", fmt::join(parts, ", with "));
    report.redundant.push_back(std::move(constraint));
  }
}

/// M = d(n − g − 1) + Σf + υ − ζ. The order d is 6 less the wrenches that no joint of the
/// mechanism feels; υ then follows from the mobility found.
void count_terms(const Findings& findings, MobilityReport& report) {
  const Model& model = findings.model;
  const Posture& at = findings.generic ? *findings.generic : findings.home;
  CountingTerms& terms = report.counting;
  const Eigen::MatrixXd screws = scaled_screws(model, freedom_screws(model, at));
  terms.order = screws.cols() > 0 ? rank_of(screws).rank : 0;
  terms.links = static_cast<int>(model.mechanism.bodies.size());
  terms.joints = static_cast<int>(model.mechanism.joints.size());
  terms.freedoms = static_cast<int>(model.freedoms.size());
  terms.local = report.idle;
  terms.mobility = report.finite - terms.local;
  terms.virtual_constraints =
      report.finite - terms.order * (terms.links - terms.joints - 1) - terms.freedoms;
}

}  // namespace

std::string describe_motion(const MobilityReport& report) {
  const TaskSpace& task = report.task;
  std::string words;
  if (report.platform_dof == 0) return "none";
  if (report.platform_dof == 6) return "all six freedoms";
  if (task.rotations == 0)
    words = "translation: the platform never turns";
  else if (task.rotations == 1 && !task.rotation_axis.isZero())
    words = fmt::format("{}: it turns about axes of the one direction ({:.3g}, {:.3g}, {:.3g})",
                        task.translations == 3   ? "Schoenflies motion"
                        : task.translations == 0 ? "rotation"
                                                 : "rotation axes stay parallel",
                        task.rotation_axis.x(), task.rotation_axis.y(), task.rotation_axis.z());
  else
    words = "rotation axes change direction as it moves (not Schoenflies)";
  std::vector<std::string> along;
  for (const ParasiticMotion& motion : report.parasitic)
    along.push_back(fmt::format("{} {:.3g} {}", "XYZABC"[motion.axis],
                                motion.amount * (motion.axis < 3 ? 1e3 : 180 / EIGEN_PI),
                                motion.axis < 3 ? "mm" : "deg"));
  if (!along.empty())
    words += fmt::format("; moving along with that, as far as seen: {}", fmt::join(along, ", "));
  return words;
}

void collect_evidence(const Findings& findings, MobilityReport& report) {
  add_modes(findings, report);
  add_platform_motions(findings, report);
  add_idle_freedoms(findings, report);
  add_redundant_constraints(findings, report);
  report.limbs = limb_wrenches(findings.model.mechanism);
  count_terms(findings, report);
}

}  // namespace polyglide
