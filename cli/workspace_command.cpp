#include <fmt/format.h>

#include <iostream>

#include "cli/commands.hpp"
#include "cli/machines.hpp"
#include "cli/print.hpp"
#include "kinematics/certify.hpp"
#include "kinematics/workspace.hpp"

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

void print_page(const Workspace& workspace, const WorkspaceOptions& how, const std::string& name) {
  std::cout << fmt::format("{}: workspace {} ({} between {} and {}), positions from home\n", name,
                           litres(workspace.volume), workspace.certified ? "proved" : "estimated",
                           litres(workspace.volume_lower), litres(workspace.volume_upper));
  std::vector<std::vector<std::string>> rows{
      {"  extent",
       fmt::format("{} to {}", point_in_mm(workspace.lower), point_in_mm(workspace.upper))},
      {"  largest cylinder", cylinder_text(workspace.inscribed_cylinder)},
      {"  largest box", box_text(workspace.inscribed_box)}};
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

/// "AxBxC" or "A,B,C" in file units to metres.
std::vector<double> read_size(std::string text, const char* option, std::size_t count,
                              const Units& units) {
  for (char& letter : text)
    if (letter == 'x') letter = ',';
  std::vector<double> size = parse_numbers(text, option);
  const bool positive =
      std::all_of(size.begin(), size.end(), [](double value) { return value > 0; });
  if (size.size() != count || !positive)
    throw InputError(
        {wrong_argument(text, fmt::format("{} takes {} positive lengths, as in {}", option, count,
                                          count == 3 ? "200x200x100" : "230x170"))});
  for (double& value : size) value *= units.metres;
  return size;
}

/// "DX,DY,DZ@X,Y,Z" in file units; without the place about home.
PoseRegion read_region(const std::string& text, const Units& units) {
  PoseRegion region;
  const std::size_t mark = text.find('@');
  const auto size = read_size(text.substr(0, mark), "--box", 3, units);
  region.size = Vector3(size[0], size[1], size[2]);
  if (mark == std::string::npos) return region;
  const auto place = parse_numbers(text.substr(mark + 1), "--box");
  if (place.size() != 3)
    throw InputError(
        {wrong_argument(text, "--box takes DX,DY,DZ@X,Y,Z: three lengths and a place")});
  region.centre = Vector3(place[0], place[1], place[2]) * units.metres;
  return region;
}

void print_certificate(const BoxCertificate& certificate, const std::string& name) {
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

/// What `--certify` asks beside the box.
struct CertifyOptions {
  bool wanted = false;
  double tilt = 0, condition = 0;
};

nlohmann::ordered_json certify(const ChosenMachine& chosen, const CertifyOptions& options,
                               const std::string& box, const std::vector<std::string>& ignored,
                               bool json) {
  PoseRegion region = read_region(box, chosen.mechanism.units);
  region.tilt = options.tilt * chosen.mechanism.units.radians;
  region.condition = options.condition;
  if (region.tilt > M_PI / 2)
    throw InputError({wrong_argument(fmt::format("{}", options.tilt),
                                     "--tilt takes an angle up to 90 degrees, in file units")});
  const BoxCertificate certificate = certify_box(prepare(chosen.mechanism), region, ignored);
  nlohmann::ordered_json document{{"name", chosen.mechanism.name}};
  document.update(to_json(certificate));
  if (!json) print_certificate(certificate, chosen.mechanism.name);
  return document;
}

}  // namespace

int run_workspace(CommandLine& line) {
  MachineOptions options;
  WorkspaceOptions how;
  std::string box, cylinder, turned;
  add_machine_options(line.options(), options);
  auto& app = line.options();
  app.add_option("--ignore-limits", how.ignored, "Limits that do not count, separated by commas")
      ->delimiter(',');
  app.add_option("--box", box, "Does a box of this size fit, as in 200x200x100 (file units)");
  app.add_option("--cylinder", cylinder,
                 "Does a cylinder diameter x height fit, as in 230x170 (file units)");
  app.add_option("--turned", turned, "Orientation a,b,c of the platform (default: as at home)");
  app.add_option("--accuracy", how.accuracy, "Relative accuracy of the volume")
      ->check(CLI::Range(1e-12, 0.1));
  CertifyOptions certified;
  auto* certify_flag = app.add_flag("--certify", certified.wanted,
                                    "Prove that the whole --box DX,DY,DZ[@X,Y,Z] can be used");
  app.add_option("--tilt", certified.tilt,
                 "With --certify: tilt to either side about every commanded rotation (file units)")
      ->needs(certify_flag)
      ->check(CLI::NonNegativeNumber);
  app.add_option("--condition", certified.condition,
                 "With --certify: largest condition number allowed")
      ->needs(certify_flag)
      ->check(CLI::Range(1.0, 1e12));
  if (!line.parse()) return kDone;
  if (certified.wanted && box.empty())
    throw InputError({wrong_argument("", "--certify needs --box DX,DY,DZ[@X,Y,Z]")});

  std::vector<nlohmann::ordered_json> documents;
  for (const ChosenMachine& chosen : load_machines(options)) {
    const Units& units = chosen.mechanism.units;
    if (certified.wanted) {
      documents.push_back(certify(chosen, certified, box, how.ignored, line.json()));
      continue;
    }
    if (!box.empty()) {
      const auto size = read_size(box, "--box", 3, units);
      how.box = Vector3(size[0], size[1], size[2]);
    }
    if (!cylinder.empty()) {
      const auto size = read_size(cylinder, "--cylinder", 2, units);
      how.cylinder = {size[0], size[1]};
    }
    if (!turned.empty()) {
      const auto angles = parse_numbers(turned, "--turned");
      if (angles.size() != 3)
        throw InputError({wrong_argument(turned, "--turned takes three angles a,b,c")});
      Eigen::Matrix<double, 6, 1> coordinates = Eigen::Matrix<double, 6, 1>::Zero();
      for (int i = 0; i < 3; ++i) coordinates[3 + i] = angles[i] * units.radians;
      how.rotation = pose_of(coordinates).rotation;
    }
    const Workspace workspace = compute_workspace(prepare(chosen.mechanism), how);
    if (line.json()) {
      documents.push_back(to_json(workspace));
      documents.back()["name"] = chosen.mechanism.name;
    } else {
      print_page(workspace, how, chosen.mechanism.name);
    }
  }
  if (line.json()) print_json(one_or_all(std::move(documents)));
  return kDone;
}

}  // namespace polyglide
