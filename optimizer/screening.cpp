#include "optimizer/screening.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "kinematics/mobility.hpp"
#include "kinematics/scene.hpp"
#include "optimizer/parallel.hpp"
#include "optimizer/run_document.hpp"

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kExamples = 2;
constexpr int kSceneNodes = 81;  // three places of each of four drives

std::string uncertainty(const nlohmann::json& check) {
  const auto& drives = check.at("drives");
  if (drives.at("locked_platform").get<int>() > 0)
    return "uncertain: with all drives held the platform still moves";
  if (check.at("motions_meet").get<bool>()) return "uncertain: several motions meet at home";
  return "uncertain: with all drives held at home a finite motion is left";
}

std::string motion_mismatch(const Candidate& candidate, const Brief& brief) {
  const auto& platform = candidate.check.at("platform");
  const std::string axes = candidate.axes();
  const std::string has =
      fmt::format("motion: {} ({}), asked {}", candidate.pattern(), axes, motion_text(brief));
  if (platform.at("translations") != brief.translations ||
      platform.at("rotations") != brief.rotations)
    return has;
  // One rotation: which horizontal axis it is about is a matter of how the machine is turned.
  const bool vertical = axes.back() == 'C', asked_vertical = brief.motion.back() == 'C';
  if (brief.rotations == 1 && vertical != asked_vertical) return has;
  const bool plain = brief.rotations == 1 || axes == brief.motion;
  return plain && axes.substr(0, brief.translations) == brief.motion.substr(0, brief.translations)
             ? ""
             : has;
}

Json example_json(const Space& space, const Candidate& candidate,
                  const std::vector<std::string>& sentences, std::uint64_t seed) {
  const Layout layout = candidate_layout(space, candidate.raw_index, candidate.id);
  const Mechanism mechanism = expand(layout);
  const Model model = compile(mechanism);
  MobilityOptions options;
  options.seed = seed;
  const MobilityReport report = analyse_mobility(model, options);
  Json scene = scene_of(prepare(mechanism, report.task), kSceneNodes);
  if (!report.modes.empty()) add_mode(scene, report.modes.front(), mechanism);
  return {{"id", candidate.id},
          {"known_as", name_or_null(candidate.known_as)},
          {"title", layout.title},
          {"reasons", sentences.empty() ? report.reasons : sentences},
          {"check", to_json(report, mechanism)},
          {"scene", std::move(scene)}};
}

}  // namespace

std::string rejection(const Candidate& candidate, const Brief& brief) {
  const std::string verdict = candidate.verdict();
  if (verdict == "rigid") return "rigid: the platform cannot move";
  if (verdict == "uncertain") return uncertainty(candidate.check);
  if (verdict == "singular-home")
    return "singular-home: the drives lose hold of the platform at home";
  if (std::string mismatch = motion_mismatch(candidate, brief); !mismatch.empty()) return mismatch;
  if (verdict == "overdriven") return "overdriven: more drives than freedoms they control";
  const int drives = candidate.check.at("drives").at("count");
  if (drives != brief.drives) return fmt::format("drives: {}, asked {}", drives, brief.drives);
  return "";
}

std::string axis_rejection(const TaskSpace& task, const Brief& brief) {
  if (brief.rotations != 1) return "";
  constexpr double kLevel = 1e-6;
  const bool asked_vertical = brief.motion.back() == 'C';
  if (task.rotation_axis.isZero()) return "motion: the rotation axis turns while the machine moves";
  const double rise = std::abs(task.rotation_axis.z());
  if (asked_vertical ? rise < 1 - kLevel : rise > kLevel)
    return fmt::format("motion: the rotation axis is not {}",
                       asked_vertical ? "vertical" : "horizontal");
  return "";
}

void Rejections::add(const std::string& reason, const Candidate& candidate,
                     std::vector<std::string> sentences) {
  Group& group = groups_[reason];
  group.reason = reason;
  ++group.count;
  group.examples.push_back({&candidate, std::move(sentences)});
  const auto better = [](const Example& a, const Example& b) {
    const bool a_known = !a.candidate->known_as.empty(), b_known = !b.candidate->known_as.empty();
    return a_known != b_known ? a_known : a.candidate->raw_index < b.candidate->raw_index;
  };
  std::ranges::sort(group.examples, better);
  if (group.examples.size() > kExamples && group.examples.back().candidate->known_as.empty())
    group.examples.pop_back();
}

void Rejections::add_unbuildable(const Unbuildable& cause) {
  Group& group = groups_["does not assemble (raw combinations): " + cause.reason];
  group.reason = "does not assemble (raw combinations): " + cause.reason;
  group.count += cause.raw_count;
}

std::vector<const Rejections::Group*> Rejections::by_count() const {
  std::vector<const Group*> list;
  for (const auto& [reason, group] : groups_) list.push_back(&group);
  std::ranges::stable_sort(list,
                           [](const Group* a, const Group* b) { return a->count > b->count; });
  return list;
}

Json Rejections::counts() const {
  Json json = Json::object();
  for (const Group* group : by_count()) json[group->reason] = group->count;
  return json;
}

Json Rejections::json(const Space& space, const RunOptions& options) const {
  const std::vector<const Group*> groups = by_count();
  std::vector<const Example*> examples;
  for (const Group* group : groups)
    for (const Example& example : group->examples) examples.push_back(&example);
  std::vector<Json> drawn(examples.size());
  in_parallel(static_cast<int>(examples.size()), options, "draw", [&](int i) {
    drawn[i] = example_json(space, *examples[i]->candidate, examples[i]->sentences, options.seed);
  });

  Json list = Json::array();
  std::size_t next = 0;
  for (const Group* group : groups) {
    Json of_group = Json::array();
    for (std::size_t i = 0; i < group->examples.size(); ++i)
      of_group.push_back(std::move(drawn[next++]));
    list.push_back(
        {{"reason", group->reason}, {"count", group->count}, {"examples", std::move(of_group)}});
  }
  return list;
}

}  // namespace polyglide
