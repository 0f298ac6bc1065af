#include "cli/workspace_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <numbers>

#include "catalog/counted.hpp"
#include "cli/print.hpp"
#include "kinematics/motion.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {
namespace {

std::string litres(double cubic_metres) { return fmt::format("{:.4g} dm³", cubic_metres * 1e3); }

std::string cylinder_text(const Cylinder& cylinder) {
  return fmt::format("Ø{} × {} about {}", in_mm(cylinder.diameter), in_mm(cylinder.height),
                     point_in_mm(cylinder.center));
}

std::string box_text(const Box& box) {
  return fmt::format("{} about {}", size_in_mm(box.size), point_in_mm(box.center));
}

/// The first line: volume, area or length, or why there is none.
std::string headline(const Workspace& workspace) {
  const char* what = workspace.orientations ? "total orientation workspace" : "workspace";
  if (workspace.volume > 0)
    return fmt::format("{} {} ({} between {} and {}), positions from home", what,
                       litres(workspace.volume), workspace.certified ? "proved" : "estimated",
                       litres(workspace.volume_lower), litres(workspace.volume_upper));
  if (workspace.area > 0)
    return fmt::format("{} {:.4g} cm² (by {}), positions from home", what, workspace.area * 1e4,
                       workspace.method);
  if (workspace.length > 0)
    return fmt::format("{} {} long, positions from home", what, in_mm(workspace.length));
  if (!workspace.stopped_by.empty())
    return fmt::format("{} empty: home is stopped by {}", what, workspace.stopped_by);
  return fmt::format("{} is one place: the machine commands no translation", what);
}

/// How exact a size by quadrature is, and what lies beyond singular surfaces.
std::string measured(const Workspace& workspace) {
  const double size = workspace.volume + workspace.area;  // one of them is zero
  std::string text = fmt::format("by quadrature, relative error {:.1g}", workspace.error / size);
  if (workspace.singular_throughout)
    text += "; every pose of this orientation is singular: limits alone count";
  else if (workspace.reach && *workspace.reach > size * (1 + 1e-5))
    text += fmt::format("; {:.4g} times that where singular surfaces and gaps stop nothing",
                        *workspace.reach / size);
  return text;
}

void add_shape(const char* label, const std::string& shape, const ShapeEvidence& evidence,
               std::vector<std::vector<std::string>>& rows) {
  std::string touches;
  for (const auto& touch : evidence.touches) touches += (touches.empty() ? "" : ", ") + touch.limit;
  rows.push_back({label, shape});
  if (evidence.places > 0)
    rows.push_back(
        {"",
         fmt::format(
             "{} places every {} asked{}; touches: {}", evidence.places, in_mm(evidence.spacing),
             evidence.outside > 0 ? fmt::format(", {} OUTSIDE", evidence.outside) : ", all inside",
             touches.empty() ? "nothing" : touches)});
}

void add_shapes(const Workspace& workspace, std::vector<std::vector<std::string>>& rows) {
  add_shape("  largest cylinder", cylinder_text(workspace.inscribed_cylinder),
            workspace.cylinder_evidence, rows);
  add_shape("  largest box", box_text(workspace.inscribed_box), workspace.box_evidence, rows);
  const Sphere& sphere = workspace.inscribed_sphere;
  add_shape("  largest sphere",
            fmt::format("Ø{} about {}", in_mm(sphere.diameter), point_in_mm(sphere.center)),
            workspace.sphere_evidence, rows);
}

}  // namespace

void print_page(const Workspace& workspace, const WorkspaceOptions& how, const std::string& name) {
  std::cout << name << ": " << headline(workspace) << "\n";
  std::vector<std::vector<std::string>> rows{
      {"  extent",
       fmt::format("{} to {}", point_in_mm(workspace.lower), point_in_mm(workspace.upper))}};
  if (workspace.method == "quadrature") rows.push_back({"  measured", measured(workspace)});
  if (workspace.volume > 0) add_shapes(workspace, rows);
  if (const auto& set = workspace.orientations)
    rows.push_back(
        {"  orientations",
         fmt::format(
             "tilts up to {}{} in every direction, {} samples at each place; "
             "{} of them claim {:.2g} % more",
             in_degrees(set->set.tilt),
             set->set.torsion > 0 ? " and torsions up to " + in_degrees(set->set.torsion) : "",
             set->count, set->coarser, 100 * set->change / (1 - set->change))});
  for (const Cylinder& cylinder : workspace.cylinders)
    rows.push_back({"  cylinder", cylinder_text(cylinder)});
  if (how.box)
    rows.push_back({"  asked box", workspace.asked_box ? "fits: " + box_text(*workspace.asked_box)
                                                       : "does not fit"});
  if (how.cylinder)
    rows.push_back({"  asked cylinder", workspace.asked_cylinder
                                            ? "fits: " + cylinder_text(*workspace.asked_cylinder)
                                            : "does not fit"});
  rows.push_back(
      {"  conditioning 1/κ",
       fmt::format("mean {:.3f} (GCI), worst {:.3f}, best {:.3f}; characteristic length {}",
                   workspace.global_conditioning, workspace.worst, workspace.best,
                   in_mm(workspace.characteristic_length))});
  if (workspace.rotation_range)
    rows.push_back({fmt::format("  widest turn {}", workspace.rotation_range->axis),
                    fmt::format("{} to {} at {}", in_degrees(workspace.rotation_range->min),
                                in_degrees(workspace.rotation_range->max),
                                point_in_mm(workspace.rotation_range->at))});
  for (const auto& [limit, share] : workspace.limits_hit)
    rows.push_back({"  bounded by", fmt::format("{:.1f} % {}", 100 * share, limit)});
  rows.push_back(
      {"  effort", fmt::format("{} poses in {:.2f} s", workspace.poses, workspace.seconds)});
  std::cout << columns(rows);
}

void print_page(const BoxCertificate& certificate, const std::string& name) {
  const char* word = certificate.verdict == CertifyVerdict::certified ? "certified"
                     : certificate.verdict == CertifyVerdict::fails   ? "fails"
                                                                      : "undecided";
  std::cout << fmt::format("{}: {}: {}\n", name, word, certificate.reason);
  std::vector<std::vector<std::string>> rows;
  if (certificate.at) {
    const auto c = coordinates_of(*certificate.at);
    rows.push_back({certificate.verdict == CertifyVerdict::fails ? "  at" : "  open about",
                    fmt::format("{}, turned A {} B {} C {}", point_in_mm(certificate.at->position),
                                in_degrees(c[3]), in_degrees(c[4]), in_degrees(c[5]))});
  }
  rows.push_back({"  proved", fmt::format("{:.4g} % of the box", 100 * certificate.proved)});
  if (certificate.worst_condition > 0)
    rows.push_back(
        {"  condition", fmt::format("κ at most {:.4g} where proved", certificate.worst_condition)});
  rows.push_back(
      {"  effort", fmt::format("{} boxes in {:.2f} s", certificate.boxes, certificate.seconds)});
  std::cout << columns(rows);
}

namespace {

std::string end_text(const TurnEnd& end) {
  return fmt::format("{}{}", in_degrees(end.angle),
                     end.limit.empty() ? "" : " (" + end.limit + ")");
}

/// Every so many directions, so that a page shows some 24.
void add_directions(const OrientationWorkspace& workspace,
                    std::vector<std::vector<std::string>>& rows) {
  constexpr std::size_t kShown = 24;
  const std::size_t stride = std::max<std::size_t>(1, workspace.directions.size() / kShown);
  for (std::size_t i = 0; i < workspace.directions.size(); i += stride) {
    const TiltDirection& direction = workspace.directions[i];
    rows.push_back({"  towards " + in_degrees(direction.azimuth), end_text(direction.end),
                    fmt::format("{} in all", in_degrees(direction.any_torsion))});
  }
}

}  // namespace

void print_page(const OrientationWorkspace& workspace, const Vector3& at, const std::string& name) {
  std::cout << fmt::format("{}: orientations with the tool at {}", name, point_in_mm(at));
  if (!workspace.reachable) {
    std::cout << fmt::format(": none; home's orientation is stopped by {}\n", workspace.limit);
    return;
  }
  std::cout << "\n";
  std::vector<std::vector<std::string>> rows;
  const std::size_t rotations = workspace.rotations.size();
  if (rotations != 2)
    rows.push_back({rotations == 1 ? "  turns" : "  torsion",
                    end_text(workspace.least) + " to " + end_text(workspace.most)});
  if (rotations > 1) {
    rows.push_back({"  every direction",
                    fmt::format("tilts {}; ends first towards {}", end_text(workspace.worst.end),
                                in_degrees(workspace.worst.azimuth))});
    rows.push_back({"  greatest tilt", in_degrees(workspace.greatest)});
  }
  if (workspace.solid_angle > 0)
    rows.push_back({"  tool directions", fmt::format("{:.4g} sr of {:.4g}", workspace.solid_angle,
                                                     4 * std::numbers::pi)});
  if (workspace.share > 0)
    rows.push_back(
        {rotations == 3 ? "  of all rotations" : "  share",
         fmt::format("{:.4g} % ± {:.1g} %", 100 * workspace.share, 100 * workspace.share_error)});
  for (const auto& [limit, share] : workspace.limits_hit)
    rows.push_back({"  bounded by", fmt::format("{:.1f} % {}", 100 * share, limit)});
  add_directions(workspace, rows);
  rows.push_back(
      {"  effort", fmt::format("{} poses in {:.2f} s", workspace.poses, workspace.seconds)});
  std::cout << columns(rows);
}

void print_page(const SingularityMap& map, const std::string& name) {
  constexpr std::size_t kShort =
      5;  // pieces of a curve that the end of reach cuts off, and the like
  const auto text = [&](int k, double value) {
    return map.axes[k] < 3 ? in_mm(value) : in_degrees(value);
  };
  std::cout << fmt::format("{}: singularities over {}; {} {} to {}, {} {} to {}\n", name,
                           slice_words(map), axes_name({map.axes[0]}), text(0, map.u.front()),
                           text(0, map.u.back()), axes_name({map.axes[1]}), text(1, map.v.front()),
                           text(1, map.v.back()));
  std::map<std::string, int> short_ones;
  for (const SingularCurve& curve : map.curves) {
    if (curve.points.size() < kShort) {
      ++short_ones[curve.kind];
      continue;
    }
    const auto& middle = curve.points[curve.points.size() / 2];
    std::cout << fmt::format("  {}: {} curve of {} points through ({}, {})\n", curve.kind,
                             curve.closed ? "closed" : "open", curve.points.size(),
                             text(0, middle[0]), text(1, middle[1]));
    for (const SingularScrew& screw : curve.gained)
      std::cout << "    the platform gains: " << screw.about << "\n";
    for (const SingularScrew& screw : curve.lost)
      std::cout << "    it bears without any drive, and cannot give way to: " << screw.about
                << "\n";
  }
  for (const auto& [kind, count] : short_ones)
    std::cout << fmt::format("  {}: {} of fewer than {} points\n", kind, counted(count, "piece"),
                             kShort);
  if (map.curves.empty()) std::cout << "  no singular curve in this slice\n";
  if (map.branch_changes > 0)
    std::cout << fmt::format("  {} changes of sign where the solver goes over to another branch\n",
                             map.branch_changes);
  if (!map.square)
    std::cout << "  more drives than freedoms: singular places are points; 1/κ shows them\n";
  std::cout << fmt::format("  resolution {} x {}; {} poses in {:.2f} s; -o FILE.svg draws it\n",
                           text(0, map.cell[0]), text(1, map.cell[1]), map.poses, map.seconds);
}

}  // namespace polyglide
