#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "kinematics/motion.hpp"
#include "kinematics/singularity_map.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string slice_words(const SingularityMap& map) {
  std::string where;
  for (int axis = 0; axis < 6; ++axis) {
    const double at = map.at[axis];
    if (at == 0 || axis == map.axes[0] || axis == map.axes[1]) continue;
    where += fmt::format("{}{} {}", where.empty() ? " at " : ", ", axes_name({axis}),
                         axis < 3 ? fmt::format("{:.6g} mm", at * 1e3)
                                  : fmt::format("{:.6g}°", at * 180 / std::numbers::pi));
  }
  return axes_name({map.axes[0], map.axes[1]}) + (where.empty() ? " through home" : where);
}

Json to_json(const SingularityMap& map) {
  const auto rows = [&](const auto& cell) {
    Json table = Json::array();
    for (std::size_t j = 0; j < map.v.size(); ++j) {
      Json row = Json::array();
      for (std::size_t i = 0; i < map.u.size(); ++i) row.push_back(cell(j * map.u.size() + i));
      table.push_back(std::move(row));
    }
    return table;
  };
  const auto words = [](const std::vector<SingularScrew>& screws) {
    Json list = Json::array();
    for (const SingularScrew& screw : screws) list.push_back(screw.about);
    return list;
  };
  Json json;
  json["axes"] = {axes_name({map.axes[0]}), axes_name({map.axes[1]})};
  json["slice"] = slice_words(map);
  json["at"] = std::vector<double>(map.at.begin(), map.at.end());
  json["square"] = map.square;
  json["curves"] = Json::array();
  for (const SingularCurve& curve : map.curves)
    json["curves"].push_back({{"kind", curve.kind},
                              {"closed", curve.closed},
                              {"gained", words(curve.gained)},
                              {"lost", words(curve.lost)},
                              {"points", curve.points}});
  json["cell"] = map.cell;
  json["branch_changes"] = map.branch_changes;
  json["singular_nodes"] = map.singular_nodes;
  json["u"] = map.u;
  json["v"] = map.v;
  json["inverse_condition"] = rows([&](std::size_t i) {
    const double value = map.inverse_condition[i];
    return std::isnan(value) ? Json() : Json(std::round(value * 1e4) / 1e4);
  });
  json["side"] = rows([&](std::size_t i) { return Json(static_cast<int>(map.side[i])); });
  json["limit"] = rows([&](std::size_t i) { return Json(map.limit[i]); });
  json["limits"] = map.limits;
  json["poses"] = map.poses;
  json["seconds"] = map.seconds;
  return json;
}

}  // namespace polyglide
