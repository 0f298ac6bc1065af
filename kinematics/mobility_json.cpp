#include <array>

#include "kinematics/mobility.hpp"
#include "kinematics/screw_words.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const Vector3& vector) { return std::vector<double>(vector.begin(), vector.end()); }
Json numbers(const Screw& screw) { return std::vector<double>(screw.begin(), screw.end()); }

/// What a screw is called and where it lies: axis, point [m] and pitch [m/rad] where it has them.
/// @param names of a screw without axis part, of one without pitch, and of any other
void add_line(Json& json, const Screw& screw, const std::array<const char*, 3>& names) {
  using Kind = ScrewLine::Kind;
  const ScrewLine line = line_of(screw);
  const bool lies_somewhere = line.kind == Kind::line || line.kind == Kind::screw;
  json["kind"] = line.kind == Kind::none ? "none" : names[static_cast<int>(line.kind) - 1];
  json["axis"] = line.kind == Kind::none ? Json() : numbers(line.axis);
  json["point"] = lies_somewhere ? numbers(line.point) : Json();
  json["pitch"] = lies_somewhere ? Json(line.pitch) : Json();
}

Json twist_json(const std::string& about, const Screw& twist) {
  Json json{{"about", about}, {"twist", numbers(twist)}};
  add_line(json, twist, {"translation", "rotation", "screw"});
  return json;
}

Json wrenches_json(const std::vector<Screw>& wrenches) {
  Json list = Json::array();
  for (const Screw& wrench : wrenches) {
    list.push_back({{"about", describe_wrench(wrench)}, {"wrench", numbers(wrench)}});
    add_line(list.back(), wrench, {"couple", "force", "wrench"});
  }
  return list;
}

/// A motion of the platform, and every body that moves in it.
template <typename Motion>
Json motion_json(const Motion& motion, const Mechanism& mechanism) {
  Json json = twist_json(motion.about, motion.twist);
  json["bodies"] = Json::array();
  for (const BodyMotion& body : motion.bodies)
    json["bodies"].push_back({{"name", mechanism.bodies[body.body]},
                              {"speed", body.speed},
                              {"twist", numbers(body.twist)}});
  return json;
}

Json limbs_json(const MobilityReport& report, const Mechanism& mechanism) {
  Json list = Json::array();
  for (const LimbWrenches& limb : report.limbs)
    list.push_back({{"name", limb.name},
                    {"joints", limb.joints},
                    {"between", {mechanism.bodies[limb.from], mechanism.bodies[limb.to]}},
                    {"connectivity", limb.connectivity},
                    {"constraints", wrenches_json(limb.constraints)},
                    {"actuations", wrenches_json(limb.actuations)}});
  return list;
}

Json redundant_json(const MobilityReport& report) {
  Json list = Json::array();
  for (const RedundantConstraint& constraint : report.redundant) {
    Json loops = Json::array();
    for (const auto& loop : constraint.loops) {
      loops.push_back({{"closed_by", loop.closed_by}, {"wrench", numbers(loop.wrench)}});
      add_line(loops.back(), loop.wrench, {"couple", "force", "wrench"});
    }
    list.push_back({{"about", constraint.about}, {"loops", std::move(loops)}});
  }
  return list;
}

void add_evidence(Json& json, const MobilityReport& report, const Mechanism& mechanism) {
  json["parasitic"] = Json::array();
  for (const ParasiticMotion& motion : report.parasitic)
    json["parasitic"].push_back(
        {{"axis", std::string(1, "XYZABC"[motion.axis])}, {"amount", motion.amount}});
  json["modes"] = Json::array();
  for (const FreedomMode& mode : report.modes)
    json["modes"].push_back(motion_json(mode, mechanism));
  json["platform_motions"] = Json::array();
  for (const PlatformMotion& motion : report.platform_motions)
    json["platform_motions"].push_back(motion_json(motion, mechanism));
  json["idle_rods"] = report.idle_rods;
  json["idle_freedoms"] = Json::array();
  for (const IdleFreedom& idle : report.idle_freedoms) {
    json["idle_freedoms"].push_back(twist_json(idle.about, idle.twist));
    json["idle_freedoms"].back()["bodies"] = idle.bodies;
  }
  json["redundant"] = redundant_json(report);
  json["limbs"] = limbs_json(report, mechanism);
  const CountingTerms& terms = report.counting;
  json["counting"] = {{"d", terms.order},
                      {"n", terms.links},
                      {"g", terms.joints},
                      {"f", terms.freedoms},
                      {"virtual_constraints", terms.virtual_constraints},
                      {"local_freedoms", terms.local},
                      {"mobility", terms.mobility}};
}

}  // namespace

Json to_json(const MobilityReport& report, const Mechanism& mechanism) {
  Json json;
  json["name"] = mechanism.name;
  json["verdict"] = to_string(report.verdict);
  json["reasons"] = report.reasons;
  json["mobility"] = {{"home", report.home},
                      {"finite", report.finite},
                      {"kutzbach", report.kutzbach},
                      {"redundant_constraints", report.redundant_constraints},
                      {"idle", report.idle}};
  json["platform"] = {
      {"dof", report.platform_dof},           {"translations", report.task.translations},
      {"rotations", report.task.rotations},   {"pattern", report.pattern},
      {"home_dof", report.platform_home_dof}, {"axes", report.axes}};
  json["drives"] = {{"count", report.drives},
                    {"locked_mobility", report.locked_mobility},
                    {"locked_platform", report.locked_platform},
                    {"home_locked_platform", report.home_locked_platform},
                    {"surplus", report.surplus}};
  json["rank_gap"] = report.rank_gap;
  json["margin"] = report.margin;
  json["platform"]["motion"] = report.motion;
  json["closure"] = {{"residual", report.residual}, {"noise", report.noise}};
  json["second_order_conditions"] = report.obstructions;
  json["rotation_axis"] = report.task.rotation_axis.isZero()
                              ? Json()
                              : Json({report.task.rotation_axis.x(), report.task.rotation_axis.y(),
                                      report.task.rotation_axis.z()});
  json["motions_meet"] = report.motions_meet;
  json["branches"] = Json::array();
  for (const auto& branch : report.branches)
    json["branches"].push_back({{"dimension", branch.dimension}, {"pattern", branch.pattern}});
  if (!report.limbs.empty()) add_evidence(json, report, mechanism);
  return json;
}

}  // namespace polyglide
