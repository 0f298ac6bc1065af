#include "optimizer/brief.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "catalog/json_file.hpp"
#include "kinematics/motion.hpp"
#include "optimizer/requirements.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

constexpr std::string_view kLetters = "XYZABC";

bool is_motion(const std::string& word) {
  if (word.empty()) return false;
  std::size_t last = 0;
  for (std::size_t i = 0; i < word.size(); ++i) {
    const std::size_t place = kLetters.find(word[i]);
    if (place == std::string_view::npos || (i > 0 && place <= last)) return false;
    last = place;
  }
  return true;
}

void read_motion(const json& document, Brief& brief, Problems& problems) {
  static const std::vector<std::string> usual{"XYZA",  "XYZB",   "XYZC", "XYZ", "XYC",
                                              "XYZAB", "XYZABC", "ZAB",  "ABC", "XY"};
  brief.motion = document.at("motion");
  if (!is_motion(brief.motion)) {
    problems.add(
        document.at("motion"),
        "the motion must be letters of XYZABC, each at most once and in this order, as in XYZA",
        did_you_mean(brief.motion, usual));
    return;
  }
  brief.translations = static_cast<int>(
      std::ranges::count_if(brief.motion, [](char letter) { return letter >= 'X'; }));
  brief.rotations = static_cast<int>(brief.motion.size()) - brief.translations;
  if (brief.requirements.zone.tilt > 0 && brief.rotations == 0)
    problems.add(document.at("zone").at("tilt"),
                 fmt::format("the motion {} has no rotation to tilt with", brief.motion));
}

std::optional<DuelRequest> read_duel(const json& document) {
  if (!document.contains("duel")) return std::nullopt;
  const json& value = document.at("duel");
  const json& pair = value.at("between");
  return DuelRequest{pair.at(0), pair.at(1), value.value("by", std::vector<std::string>{})};
}

}  // namespace

Brief parse_brief(json document, const std::string& file) {
  if (auto mistakes = check_schema(document, "brief-1", file); !mistakes.empty())
    throw InputError(std::move(mistakes));
  Brief brief;
  brief.document = std::move(document);
  const json& source = brief.document;
  Problems problems(source, file);
  check_name(source, problems);
  brief.file = file;
  brief.name = source.at("name");
  brief.title = text_or(source, "title", brief.name);
  brief.about = text_or(source, "about", "");
  brief.space = std::filesystem::path(file).parent_path() / source.at("space").get<std::string>();
  brief.requirements = read_requirements(source, "objectives", problems);
  read_motion(source, brief, problems);
  brief.drives = source.value("drives", brief.translations + brief.rotations);
  if (source.contains("tune")) {
    brief.tune_candidates = source.at("tune").value("candidates", brief.tune_candidates);
    brief.tune_evaluations = source.at("tune").value("evaluations", brief.tune_evaluations);
  }
  if (source.contains("report"))
    brief.report_layouts = source.at("report").value("layouts", brief.report_layouts);
  brief.duel = read_duel(source);
  problems.raise();
  return brief;
}

Brief load_brief(const std::filesystem::path& file) {
  return parse_brief(read_json(file), file.string());
}

std::string motion_text(const Brief& brief) {
  std::string text = pattern_name(brief.translations, brief.rotations);
  if (brief.rotations == 1)
    text += brief.motion.back() == 'C' ? " about the vertical" : " about a horizontal axis";
  return fmt::format("{} ({})", text, brief.motion);
}

}  // namespace polyglide
