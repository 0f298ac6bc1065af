#include <fmt/format.h>

#include <iostream>
#include <optional>

#include "catalog/json_file.hpp"
#include "cli/commands.hpp"
#include "cli/machines.hpp"
#include "cli/print.hpp"
#include "cli/progress.hpp"
#include "cli/singularities.hpp"
#include "cli/workspace_page.hpp"
#include "kinematics/motion.hpp"
#include "report/map_picture.hpp"

namespace polyglide {
namespace {

using nlohmann::ordered_json;

/// "AxBxC" or "A,B,C" in file units to metres. @param zeros whether they may be 0
std::vector<double> read_size(std::string text, const char* option, std::size_t count,
                              const Units& units, bool zeros = false) {
  for (char& letter : text)
    if (letter == 'x') letter = ',';
  std::vector<double> size = parse_numbers(text, option);
  const bool allowed = std::ranges::all_of(
      size, [zeros](double value) { return value > 0 || (zeros && value == 0); });
  if (size.size() != count || !allowed)
    throw InputError({wrong_argument(
        text, fmt::format("{} takes {} {}, as in {}", option, count,
                          zeros ? "lengths, 0 where the machine stays" : "positive lengths",
                          count == 3 ? "200x200x100" : "230x170"))});
  for (double& value : size) value *= units.metres;
  return size;
}

/// "DX,DY,DZ@X,Y,Z" in file units; without the place about home.
PoseRegion read_region(const std::string& text, const Units& units) {
  PoseRegion region;
  const std::size_t mark = text.find('@');
  const auto size = read_size(text.substr(0, mark), "--box", 3, units, true);
  region.size = Vector3(size[0], size[1], size[2]);
  if (mark == std::string::npos) return region;
  const auto place = parse_numbers(text.substr(mark + 1), "--box");
  if (place.size() != 3)
    throw InputError(
        {wrong_argument(text, "--box takes DX,DY,DZ@X,Y,Z: three lengths and a place")});
  region.centre = Vector3(place[0], place[1], place[2]) * units.metres;
  return region;
}

/// Everything the command was given, as typed.
struct Asked {
  WorkspaceOptions how;
  std::string box, cylinder, turned, orientations_at, map, file;
  std::optional<double> total;  ///< file units, as torsion
  double torsion = 0;
  bool certify = false;
  double tilt = 0, condition = 0;
};

std::function<void(double, double)> shown_on(Progress& progress) {
  return [&progress](double done, double total) { progress.update(done, total); };
}

ordered_json certify(const ChosenMachine& chosen, const Asked& asked, bool json) {
  PoseRegion region = read_region(asked.box, chosen.mechanism.units);
  region.tilt = asked.tilt * chosen.mechanism.units.radians;
  region.condition = asked.condition;
  if (region.tilt > M_PI / 2)
    throw InputError({wrong_argument(fmt::format("{}", asked.tilt),
                                     "--tilt takes an angle up to 90 degrees, in file units")});
  const BoxCertificate certificate =
      certify_box(prepare(chosen.mechanism), region, asked.how.ignored);
  ordered_json document{{"name", chosen.mechanism.name}};
  document.update(to_json(certificate));
  if (!json) print_page(certificate, chosen.mechanism.name);
  return document;
}

std::string axes_text(const std::vector<int>& axes) {
  return axes.empty() ? "none" : axes_name(axes);
}

ordered_json orientations(const ChosenMachine& chosen, const Asked& asked, CommandLine& line) {
  const auto place = parse_numbers(asked.orientations_at, "--orientations-at");
  if (place.size() != 3)
    throw InputError({wrong_argument(asked.orientations_at, "--orientations-at takes x,y,z")});
  const Machine machine = prepare(chosen.mechanism);
  if (rotations_of(machine.task).empty())
    throw InputError({wrong_argument(
        chosen.mechanism.name,
        fmt::format(
            "--orientations-at is for machines that command a rotation; this one commands {}",
            axes_text(machine.task.axes)))});
  Progress progress("orientations of " + chosen.mechanism.name, line.quiet());
  OrientationOptions options{asked.how.ignored,
                             Vector3(place[0], place[1], place[2]) * chosen.mechanism.units.metres,
                             shown_on(progress)};
  const OrientationWorkspace workspace = orientation_workspace(machine, options);
  ordered_json document{{"name", chosen.mechanism.name},
                        {"at", {options.at.x(), options.at.y(), options.at.z()}}};
  document.update(to_json(workspace));
  if (!line.json()) print_page(workspace, options.at, chosen.mechanism.name);
  return document;
}

/// "xy", "xz@0,10,0", "ab@0,0,-20" or "z=-20" (XY at that height): axes and where the others stay.
SingularityMapOptions read_slice(const std::string& text, const Units& units) {
  constexpr const char* kRule =
      "--singularity-map takes two of x y z a b c, as in xy, xz@0,10,0 or ab@0,0,-20, or a height, "
      "as in z=-20";
  SingularityMapOptions options;
  if (text.starts_with("z=")) {
    const auto height = parse_numbers(text.substr(2), "--singularity-map z=");
    if (height.size() != 1) throw InputError({wrong_argument(text, kRule)});
    options.at[2] = height[0] * units.metres;
    return options;
  }
  const std::size_t mark = text.find('@');
  const std::string axes = text.substr(0, mark);
  if (axes.size() != 2) throw InputError({wrong_argument(text, kRule)});
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t axis = std::string_view("xyzabcXYZABC").find(axes[k]);
    if (axis == std::string_view::npos) throw InputError({wrong_argument(text, kRule)});
    options.axes[k] = static_cast<int>(axis % 6);
  }
  if (mark != std::string::npos)
    options.at = coordinates_of(read_pose(text.substr(mark + 1), "--singularity-map …@", units));
  return options;
}

ordered_json singularities(const ChosenMachine& chosen, const Asked& asked, CommandLine& line) {
  SingularityMapOptions options = read_slice(asked.map, chosen.mechanism.units);
  options.ignored = asked.how.ignored;
  const Machine machine = prepare(chosen.mechanism);
  const auto& axes = machine.task.axes;
  for (int axis : options.axes)
    if (std::count(axes.begin(), axes.end(), axis) == 0 || options.axes[0] == options.axes[1])
      throw InputError({wrong_argument(
          asked.map, fmt::format("--singularity-map takes two different axes of those that {} "
                                 "commands: {}",
                                 chosen.mechanism.name, axes_text(axes)))});
  Progress progress("singularities of " + chosen.mechanism.name, line.quiet());
  options.progress = shown_on(progress);
  const SingularityMap map = singularity_map(machine, options);
  ordered_json document{{"name", chosen.mechanism.name}};
  document.update(to_json(map));
  if (!line.json()) print_page(map, chosen.mechanism.name);
  if (!asked.file.empty()) {
    write_atomically(asked.file, map_svg(document));
    if (!line.quiet()) std::cerr << "wrote " << asked.file << "\n";
  }
  return document;
}

/// Options in SI for one machine.
WorkspaceOptions options_for(const Asked& asked, const Machine& machine) {
  const Units& units = machine.model.mechanism.units;
  WorkspaceOptions how = asked.how;
  if (!asked.box.empty()) {
    const auto size = read_size(asked.box, "--box", 3, units);
    how.box = Vector3(size[0], size[1], size[2]);
  }
  if (!asked.cylinder.empty()) {
    const auto size = read_size(asked.cylinder, "--cylinder", 2, units);
    how.cylinder = {size[0], size[1]};
  }
  if (!asked.turned.empty()) {
    const auto angles = parse_numbers(asked.turned, "--turned");
    if (angles.size() != 3)
      throw InputError({wrong_argument(asked.turned, "--turned takes three angles a,b,c")});
    Eigen::Matrix<double, 6, 1> coordinates = Eigen::Matrix<double, 6, 1>::Zero();
    for (int i = 0; i < 3; ++i) coordinates[3 + i] = angles[i] * units.radians;
    how.rotation = pose_of(coordinates).rotation;
  }
  if (asked.total) {
    how.orientations = {*asked.total * units.radians, asked.torsion * units.radians};
    const double most = greatest_tilt(machine.task);
    if (rotations_of(machine.task).empty() || !(how.orientations->tilt <= most) ||
        !(how.orientations->torsion <= M_PI))
      throw InputError({wrong_argument(
          fmt::format("{}", *asked.total),
          fmt::format(
              "--total-orientation takes tilts up to {} and torsions up to 180° of a machine "
              "that commands rotations; {} commands {}",
              in_degrees(most), machine.model.mechanism.name, axes_text(machine.task.axes)))});
  }
  return how;
}

ordered_json measure(const ChosenMachine& chosen, const Asked& asked, CommandLine& line) {
  const Machine machine = prepare(chosen.mechanism);
  WorkspaceOptions how = options_for(asked, machine);
  Progress progress("workspace of " + chosen.mechanism.name, line.quiet());
  how.progress = shown_on(progress);
  const Workspace workspace = compute_workspace(machine, how);
  if (!line.json()) print_page(workspace, how, chosen.mechanism.name);
  ordered_json document = to_json(workspace);
  document["name"] = chosen.mechanism.name;
  return document;
}

}  // namespace

int run_workspace(CommandLine& line) {
  MachineOptions options;
  Asked asked;
  add_machine_options(line.options(), options);
  auto& app = line.options();
  app.add_option("--ignore-limits", asked.how.ignored,
                 "Limits that do not count, separated by commas")
      ->delimiter(',');
  app.add_option("--box", asked.box, "Does a box of this size fit, as in 200x200x100 (file units)");
  app.add_option("--cylinder", asked.cylinder,
                 "Does a cylinder diameter x height fit, as in 230x170 (file units)");
  auto* turned = app.add_option("--turned", asked.turned,
                                "Orientation a,b,c of the platform (default: as at home)");
  app.add_option("--accuracy", asked.how.accuracy, "Relative accuracy of the volume")
      ->check(number_between("--accuracy", 1e-12, 0.1));
  auto* total =
      app.add_option("--total-orientation,--dexterous", asked.total,
                     "Only places where every tilt up to this angle, in every direction that the "
                     "machine commands, can be had (file units)")
          ->check(number_between("--total-orientation", 0, 360))
          ->excludes(turned);
  app.add_option("--torsion", asked.torsion,
                 "With --total-orientation: and every torsion up to this angle either way")
      ->needs(total)
      ->check(number_between("--torsion", 0, 360));
  auto* at = app.add_option("--orientations-at", asked.orientations_at,
                            "Instead: the rotations that can be had with the tool at x,y,z")
                 ->excludes(total);
  auto* map = app.add_option("--singularity-map", asked.map,
                             "Instead: singularities over a slice, as in xy, z=-20, ab@0,0,-20")
                  ->excludes(total)
                  ->excludes(at);
  app.add_option("-o,--output", asked.file, "With --singularity-map: draw it in this SVG file")
      ->needs(map)
      ->type_name("FILE");
  auto* certify_flag = app.add_flag("--certify", asked.certify,
                                    "Prove that the whole --box DX,DY,DZ[@X,Y,Z] can be used");
  certify_flag->excludes(total)->excludes(at)->excludes(map);
  app.add_option("--tilt", asked.tilt,
                 "With --certify: tilt to either side about every commanded rotation (file units)")
      ->needs(certify_flag)
      ->check(number_between("--tilt", 0, 360));
  app.add_option("--condition", asked.condition, "With --certify: largest condition number allowed")
      ->needs(certify_flag)
      ->check(number_between("--condition", 1, 1e12));
  if (!line.parse()) return kDone;
  if (asked.certify && asked.box.empty())
    throw InputError({wrong_argument("", "--certify needs --box DX,DY,DZ[@X,Y,Z]")});

  const std::vector<ChosenMachine> machines = load_machines(options);
  if (!asked.file.empty() && machines.size() > 1)
    throw InputError({wrong_argument(asked.file, "-o draws one machine at a time")});
  std::vector<ordered_json> documents;
  for (const ChosenMachine& chosen : machines) {
    if (!asked.how.ignored.empty() && !line.quiet())
      remark_unknown_limits(asked.how.ignored, prepare(chosen.mechanism));
    documents.push_back(asked.certify      ? certify(chosen, asked, line.json())
                        : at->count() > 0  ? orientations(chosen, asked, line)
                        : map->count() > 0 ? singularities(chosen, asked, line)
                                           : measure(chosen, asked, line));
  }
  if (line.json()) print_json(one_or_all(std::move(documents)));
  return kDone;
}

}  // namespace polyglide
