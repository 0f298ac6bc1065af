#include "cli/singularities.hpp"

#include <fmt/format.h>

#include <iostream>

#include "cli/machines.hpp"
#include "cli/print.hpp"
#include "kinematics/mobility.hpp"
#include "kinematics/singularity.hpp"

namespace polyglide {
namespace {

using nlohmann::ordered_json;

ordered_json screws_json(const std::vector<SingularScrew>& screws) {
  ordered_json list = ordered_json::array();
  for (const SingularScrew& screw : screws)
    list.push_back({{"about", screw.about},
                    {"screw", std::vector<double>(screw.screw.begin(), screw.screw.end())}});
  return list;
}

ordered_json singularity_json(const Singularity& singularity) {
  ordered_json kinds = ordered_json::array();
  if (singularity.direct) kinds.push_back("direct");
  if (singularity.inverse) kinds.push_back("inverse");
  if (singularity.constraint) kinds.push_back("constraint");
  return {{"kinds", std::move(kinds)},
          {"gained", screws_json(singularity.gained)},
          {"lost", screws_json(singularity.lost)},
          {"direct_margin", singularity.direct_margin},
          {"inverse_margin", singularity.inverse_margin}};
}

void print_singularity(const std::string& indent, const Singularity& singularity) {
  for (const SingularScrew& screw : singularity.gained)
    std::cout << indent << "the platform gains: " << screw.about << "\n";
  for (const SingularScrew& screw : singularity.lost)
    std::cout << indent << "it bears without any drive, and cannot give way to: " << screw.about
              << "\n";
}

}  // namespace

Pose read_pose(const std::string& text, const std::string& option, const Units& units) {
  const std::vector<double> numbers = parse_numbers(text, option);
  if (numbers.size() != 3 && numbers.size() != 6)
    throw InputError({wrong_argument(text, option + " takes x,y,z or x,y,z,a,b,c")});
  Eigen::Matrix<double, 6, 1> coordinates = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t i = 0; i < numbers.size(); ++i)
    coordinates[static_cast<Eigen::Index>(i)] = numbers[i] * (i < 3 ? units.metres : units.radians);
  return pose_of(coordinates);
}

nlohmann::ordered_json pose_json(const Pose& pose) {
  const auto& q = pose.rotation;
  return {{"position", {pose.position.x(), pose.position.y(), pose.position.z()}},
          {"quaternion", {q.w(), q.x(), q.y(), q.z()}}};
}

std::string pose_text(const Pose& pose) {
  const auto c = coordinates_of(pose);
  return fmt::format("{}, turned A {} B {} C {}", point_in_mm(pose.position), in_degrees(c[3]),
                     in_degrees(c[4]), in_degrees(c[5]));
}

void add_singularities(const Machine& machine, const Pose& pose, const SingularityQuestions& asked,
                       std::uint64_t seed, bool json, ordered_json& document) {
  Posture posture = home(machine.model);
  if (!solve_inverse_general(machine, pose, posture).reachable) return;
  const int mobility = analyse_mobility(machine.model, screening_options(seed)).finite;
  const Singularity here = singularity_at(machine, posture, mobility);
  document["singularity"] = singularity_json(here);
  if (!json) {
    std::cout << fmt::format("  {} posture; margins: direct {:.3g}, inverse {:.3g}\n",
                             singularity_name(here), here.direct_margin, here.inverse_margin);
    print_singularity("    ", here);
  }
  if (asked.nearest) {
    const NearestSingularity nearest = nearest_singularity(machine, pose, 0, 64, seed);
    document["nearest_singularity"] = {
        {"found", nearest.found},
        {"distance", nearest.found ? ordered_json(nearest.distance) : ordered_json()},
        {"pose", nearest.found ? pose_json(nearest.pose) : ordered_json()},
        {"singularity", nearest.found ? singularity_json(nearest.singularity) : ordered_json()},
        {"directions", nearest.directions}};
    if (!json && nearest.found)
      std::cout << fmt::format(
          "  nearest singular pose found ({}, limits left aside): {} away, at {}\n",
          singularity_name(nearest.singularity), in_mm(nearest.distance), pose_text(nearest.pose));
    else if (!json)
      std::cout << fmt::format("  no singular pose found within {} in {} directions\n",
                               in_mm(machine.model.size), nearest.directions);
    if (!json && nearest.found) print_singularity("    ", nearest.singularity);
  }
  if (asked.to.empty()) return;
  const Pose to = read_pose(asked.to, "--to", machine.model.mechanism.units);
  const PathSingularities path = singularities_on_path(machine, pose, to);
  ordered_json crossings = ordered_json::array();
  for (const SingularCrossing& crossing : path.crossings)
    crossings.push_back({{"at", crossing.at},
                         {"pose", pose_json(crossing.pose)},
                         {"singularity", singularity_json(crossing.singularity)}});
  document["path"] = {{"reached", path.reached},
                      {"end", path.end},
                      {"smallest_margin", path.smallest_margin},
                      {"smallest_at", path.smallest_at},
                      {"crossings", std::move(crossings)},
                      {"at_end", path.reached ? ordered_json() : singularity_json(path.at_end)}};
  if (json) return;
  std::cout << fmt::format(
      "  way to {}: {}; smallest margin {:.3g} at {:.0f} %\n", pose_text(to),
      path.reached ? "followed to its end"
                   : fmt::format("ends at {:.1f} %: no closed posture beyond", 100 * path.end),
      path.smallest_margin, 100 * path.smallest_at);
  if (!path.reached) {
    std::cout << "    there: " << singularity_name(path.at_end) << "\n";
    print_singularity("      ", path.at_end);
  }
  for (const SingularCrossing& crossing : path.crossings) {
    std::cout << fmt::format("    {} at {:.2f} %\n", singularity_name(crossing.singularity),
                             100 * crossing.at);
    print_singularity("      ", crossing.singularity);
  }
}

}  // namespace polyglide
