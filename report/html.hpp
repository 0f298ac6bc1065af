#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace polyglide {

/// The page's program and style, as bundled from web/ at build time.
struct WebBundle {
  std::string script;  ///< report.js
  std::string style;   ///< report.css
};

/// Finds and reads the bundle: in data_directory()/web, else where the build put it.
/// @throws std::runtime_error naming every place that was tried, and what makes it.
[[nodiscard]] WebBundle load_web_bundle();

/// The same from the first of these folders that holds it.
[[nodiscard]] WebBundle load_web_bundle(const std::vector<std::filesystem::path>& places);

/// The report as one HTML text that needs nothing else: it opens from disk, loads
/// nothing, and its content security policy forbids it to.
/// @param run a stored run (docs/run-format.md). Floating-point numbers go into
///        the page with seven significant digits; the stored run keeps them all.
///        Text in it is data, whatever it holds: it cannot become markup.
[[nodiscard]] std::string render_html(const nlohmann::json& run, const WebBundle& bundle);

/// Renders a stored run and writes it atomically. Cost: about 10 ms per megabyte of run.
/// @throws std::runtime_error when the bundle is missing or the file cannot be written.
void write_html(const nlohmann::json& run, const std::filesystem::path& file);

}  // namespace polyglide
