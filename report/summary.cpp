#include "report/summary.hpp"

#include <fmt/format.h>

#include <string_view>
#include <vector>

namespace polyglide {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

/// The member, or null: lets absent parts read like empty ones.
const json& part(const json& object, const char* key) {
  static const json nothing;
  if (!object.is_object()) return nothing;
  const auto found = object.find(key);
  return found == object.end() ? nothing : *found;
}

std::string text(const json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:.4g}", value.get<double>());
  return value.dump();
}

/// Text for a table cell or a list item: one line, no cell borders.
std::string cell(const json& value) {
  std::string out;
  for (const char c : text(value)) {
    if (c == '|')
      out += "\\|";
    else
      out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::string row(const std::vector<std::string>& cells) {
  return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

std::string head(const std::vector<std::string>& names) {
  return row(names) + row(std::vector<std::string>(names.size(), "---"));
}

std::string named(const json& entry) {
  const std::string known = cell(part(entry, "known_as"));
  const std::string title = cell(part(entry, "title"));
  return known.empty() ? title : fmt::format("{} ({})", title, known);
}

std::string requirements(const json& run) {
  if (part(run, "requirements").empty()) return "";
  std::string out = "\n## What was asked\n\n" + head({"requirement", "asked", "result", "note"});
  for (const json& r : part(run, "requirements")) {
    out += row({cell(part(r, "name")), cell(part(r, "asked")), cell(part(r, "verdict")),
                cell(part(r, "note"))});
  }
  return out;
}

std::string counts(const json& run) {
  const json& all = part(run, "counts");
  if (all.empty()) return "";
  std::string out = "\n## Counts\n\n" + head({"what", "number"});
  for (const char* key : {"raw", "distinct", "tuned"}) {
    if (all.contains(key)) out += row({key, cell(all[key])});
  }
  for (const auto& [verdict, n] : part(all, "by_verdict").items()) {
    out += row({"verdict " + verdict, cell(n)});
  }
  for (const auto& [reason, n] : part(all, "rejected").items()) {
    out += row({"rejected, " + cell(reason), cell(n)});
  }
  return out;
}

/// An index in the unit people see.
std::string shown(const json& index, const json& value) {
  if (!value.is_number()) return "";
  const json& factor = part(index, "scale");
  const double scale = factor.is_number() ? factor.get<double>() : 1.0;
  return fmt::format("{:.4g}", value.get<double>() * scale);
}

std::string with_unit(const json& index) {
  const std::string unit = cell(part(index, "unit"));
  return cell(part(index, "label")) + (unit.empty() ? "" : fmt::format(" [{}]", unit));
}

std::string ranking(const json& run) {
  const json& ranks = part(run, "ranking");
  if (ranks.empty()) return "";
  std::vector<std::string> names{"rank", "layout", "id", "score"};
  for (const json& index : part(run, "indices")) names.push_back(with_unit(index));
  std::string out = "\n## Ranking\n\n" + head(names);
  for (const json& entry : ranks) {
    std::vector<std::string> cells{cell(part(entry, "rank")), named(entry),
                                   fmt::format("`{}`", cell(part(entry, "layout"))),
                                   cell(part(entry, "score"))};
    for (const json& index : part(run, "indices")) {
      cells.push_back(
          shown(index, part(part(entry, "objectives"), text(part(index, "key")).c_str())));
    }
    out += row(cells);
  }
  return out;
}

std::string dimensions(const json& run) {
  std::string out;
  for (const json& layout : part(run, "layouts")) {
    if (part(layout, "parameters").empty()) continue;
    out += fmt::format("\n### {} `{}`\n\n", named(layout), cell(part(layout, "id"))) +
           head({"dimension", "value", "before tuning", "bounds", "unit", "meaning"});
    for (const json& p : layout["parameters"]) {
      out += row({cell(part(p, "name")), cell(part(p, "value")), cell(part(p, "initial")),
                  fmt::format("{} … {}", cell(part(p, "min")), cell(part(p, "max"))),
                  cell(part(p, "unit")), cell(part(p, "about"))});
    }
    for (const json& reason : part(part(layout, "check"), "reasons")) {
      out += fmt::format("\n- {}", cell(reason));
    }
    if (!part(part(layout, "check"), "reasons").empty()) out += '\n';
  }
  return out.empty() ? out : "\n## Dimensions and verdicts\n" + out;
}

std::string rejected(const json& run) {
  std::string out;
  for (const json& group : part(run, "rejected")) {
    out += fmt::format("\n- **{}**: {}", cell(part(group, "reason")), cell(part(group, "count")));
    for (const json& example : part(group, "examples")) {
      out += fmt::format("\n  - {} `{}`", named(example), cell(part(example, "id")));
      for (const json& reason : part(example, "reasons")) out += "; " + cell(reason);
    }
  }
  return out.empty() ? out : "\n## Rejected layouts\n" + out + '\n';
}

std::string statements(const json& run) {
  std::string out;
  const std::string stability = text(part(part(run, "stability"), "statement"));
  if (!stability.empty()) out += fmt::format("\n## Stability of the ranking\n\n{}\n", stability);
  const json& duel = part(run, "duel");
  const std::string winner = text(part(duel, "statement"));
  if (winner.empty()) return out;
  out += fmt::format("\n## {} against {}\n\n{}\n", cell(part(duel, "a_label")),
                     cell(part(duel, "b_label")), winner);
  return out;
}

/// Four significant digits, everywhere in a value.
ordered_json rounded(const json& value) {
  if (value.is_number_float()) return std::stod(fmt::format("{:.4g}", value.get<double>()));
  if (!value.is_structured()) return value;
  ordered_json out = value;
  auto target = out.begin();
  for (auto source = value.begin(); source != value.end(); ++source, ++target) {
    *target = rounded(*source);
  }
  return out;
}

/// The named members of an object that are there, in this order.
ordered_json picked(const json& object, std::initializer_list<const char*> keys) {
  ordered_json out = ordered_json::object();
  for (const char* key : keys) {
    if (!part(object, key).is_null()) out[key] = rounded(object[key]);
  }
  return out;
}

template <typename Keys>
ordered_json picked_each(const json& list, const Keys& keys) {
  ordered_json out = ordered_json::array();
  for (const json& item : list) out.push_back(picked(item, keys));
  return out;
}

}  // namespace

std::string summary_markdown(const json& run) {
  const json& title = part(run, "title");
  std::string out = fmt::format("# {}\n", cell(title.is_null() ? part(run, "name") : title));
  if (!part(run, "about").empty()) out += fmt::format("\n{}\n", text(run["about"]));
  const json& seed = part(part(run, "provenance"), "seed");
  if (!seed.is_null()) out += fmt::format("\nSeed {}.\n", text(seed));
  return out + requirements(run) + counts(run) + ranking(run) + dimensions(run) + rejected(run) +
         statements(run);
}

ordered_json summary_json(const json& run) {
  using Keys = std::initializer_list<const char*>;
  ordered_json out = {{"format", "polyglide/summary/1"}};
  out.update(picked(run, {"kind", "name", "title", "requirements"}));
  out["counts"] =
      picked(part(run, "counts"), {"raw", "distinct", "by_verdict", "rejected", "tuned"});
  out["ranking"] =
      picked_each(part(run, "ranking"), Keys{"rank", "layout", "known_as", "title", "score",
                                             "initial_score", "objectives", "parameters"});
  ordered_json verdicts = ordered_json::object();
  for (const json& layout : part(run, "layouts")) {
    verdicts[text(part(layout, "id"))] =
        picked(part(layout, "check"), {"verdict", "reasons", "mobility", "platform", "drives"});
  }
  out["verdicts"] = std::move(verdicts);
  out["rejected"] = ordered_json::array();
  for (const json& group : part(run, "rejected")) {
    ordered_json item = picked(group, {"reason", "count"});
    item["examples"] =
        picked_each(part(group, "examples"), Keys{"id", "known_as", "title", "reasons"});
    out["rejected"].push_back(std::move(item));
  }
  for (const char* key : {"stability", "duel"}) {
    if (!part(run, key).is_null()) out[key] = rounded(run[key]);
  }
  return out;
}

}  // namespace polyglide
