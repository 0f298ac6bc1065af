#include "catalog/catalog.hpp"

#include <algorithm>
#include <cstdlib>

#include "catalog/json_file.hpp"
#include "catalog/problems.hpp"

namespace polyglide {
namespace {

namespace fs = std::filesystem;

fs::path find_data_directory() {
  const auto holds_data = [](const fs::path& folder) {
    std::error_code ignored;
    return fs::is_directory(folder / "catalog" / "schema", ignored);
  };
  if (const char* given = std::getenv("POLYGLIDE_DATA"); given != nullptr && *given != '\0')
    return given;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = program.parent_path().parent_path() / "share" / "polyglide";
  if (!error && holds_data(installed)) return installed;
  return POLYGLIDE_SOURCE_DIR;
}

}  // namespace

fs::path data_directory() {
  static const fs::path kDirectory = find_data_directory();
  return kDirectory;
}

std::vector<std::string> catalog_names() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(data_directory() / "catalog" / "data", error))
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

Layout find_layout(const std::string& name_or_path) {
  if (name_or_path.ends_with(".json") || name_or_path.find('/') != std::string::npos)
    return load_layout(name_or_path);
  const std::vector<std::string> names = catalog_names();
  if (std::ranges::find(names, name_or_path) == names.end())
    throw InputError({{"", "", '"' + name_or_path + '"',
                       "must be an entry of the catalog, or a file name that ends in .json",
                       did_you_mean(name_or_path, names)}});
  return load_layout(data_directory() / "catalog" / "data" / (name_or_path + ".json"));
}

}  // namespace polyglide
