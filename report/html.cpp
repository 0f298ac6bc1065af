#include "report/html.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "catalog/catalog.hpp"
#include "catalog/json_file.hpp"

namespace polyglide {
namespace {

constexpr std::string_view kShell = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
{style}</style>
</head>
<body>
<main id="report"><noscript>This report draws itself with a script inside this file; please allow scripts for it.</noscript></main>
<script type="application/json" id="run">{run}</script>
<script>
{script}</script>
</body>
</html>
)";

std::string escape_html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

std::string title_of(const nlohmann::json& run) {
  for (const char* key : {"title", "name"}) {
    if (run.contains(key) && run[key].is_string()) return run[key];
  }
  return "Design report";
}

/// Seven significant digits draw any picture; the rest would triple the page.
nlohmann::json shortened(const nlohmann::json& value) {
  if (value.is_number_float()) {
    const double number = value.get<double>();
    return std::isfinite(number) ? nlohmann::json(std::stod(fmt::format("{:.7g}", number)))
                                 : nlohmann::json(nullptr);
  }
  if (!value.is_structured()) return value;
  nlohmann::json out = value;
  for (auto& item : out) item = shortened(item);
  return out;
}

/// JSON that is safe inside a <script>: outside of strings JSON has no '<', and in
/// strings \u003c means the same, so neither "</script" nor "<!--" can appear.
std::string island(const nlohmann::json& run) {
  using Json = nlohmann::json;
  const std::string text = shortened(run).dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

}  // namespace

WebBundle load_web_bundle() {
  return load_web_bundle({data_directory() / "web", POLYGLIDE_WEB_DIR});
}

WebBundle load_web_bundle(const std::vector<std::filesystem::path>& places) {
  std::string tried;
  for (const auto& place : places) {
    const auto script = place / "report.js", style = place / "report.css";
    if (std::filesystem::exists(script) && std::filesystem::exists(style)) {
      return {read_text(script), read_text(style)};
    }
    tried += fmt::format("\n  {}", place.string());
  }
  throw std::runtime_error(
      fmt::format("the report page's bundle (report.js and report.css) was not found in any of:{}\n"
                  "the build makes it (CMake target polyglide_web), the package installs it",
                  tried));
}

std::string render_html(const nlohmann::json& run, const WebBundle& bundle) {
  return fmt::format(kShell, fmt::arg("title", escape_html(title_of(run))),
                     fmt::arg("style", bundle.style), fmt::arg("run", island(run)),
                     fmt::arg("script", bundle.script));
}

void write_html(const nlohmann::json& run, const std::filesystem::path& file) {
  write_atomically(file, render_html(run, load_web_bundle()));
}

}  // namespace polyglide
