#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "catalog/layout.hpp"

namespace polyglide {

/// Where the shipped data lies (catalog/data, schemas, web bundle): the
/// environment variable POLYGLIDE_DATA, else beside the installed program
/// (<prefix>/share/polyglide), else the source tree it was built from.
[[nodiscard]] std::filesystem::path data_directory();

/// Names of all catalog entries, sorted. Each is catalog/data/<name>.json.
[[nodiscard]] std::vector<std::string> catalog_names();

/// A machine by catalog name or by path of a file. A word that ends in ".json"
/// or holds a '/' is a path; anything else a catalog name.
/// @throws InputError: no such entry (with the nearest name), or a bad file.
[[nodiscard]] Layout find_layout(const std::string& name_or_path);

}  // namespace polyglide
