#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

// The rules of the house that no compiler checks, held against every file of the
// source tree.
namespace {

namespace fs = std::filesystem;

const fs::path kSource = POLYGLIDE_SOURCE_DIR;
const std::array<std::string, 6> kFloors{"catalog",   "kinematics", "synthesis",
                                         "optimizer", "report",     "cli"};
const std::array<std::string, 7> kMadeFolders{".git",        "build", "node_modules", "runs",
                                              "__pycache__", "dist",  ".cache"};

bool contains(const auto& range, const auto& value) {
  return std::find(range.begin(), range.end(), value) != range.end();
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (auto it = fs::recursive_directory_iterator(folder); it != fs::end(it); ++it) {
    const std::string name = it->path().filename().string();
    if (it->is_directory() && contains(kMadeFolders, name)) {
      it.disable_recursion_pending();
    } else if (it->is_regular_file()) {
      files.push_back(it->path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool is_code(const fs::path& file) {
  return file.extension() == ".cpp" || file.extension() == ".hpp";
}

bool is_build_file(const fs::path& file) {
  return file.filename() == "CMakeLists.txt" || file.filename() == "CMakePresets.json" ||
         file.extension() == ".cmake" || file.extension() == ".in" ||
         file.parent_path().filename() == "scripts";
}

/// Calls `check(line, number)` for every line of the file.
void for_each_line(const fs::path& file, const auto& check) {
  std::ifstream stream(file);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) check(line, number);
}

std::string place(const fs::path& file, int line) {
  return fs::relative(file, kSource).string() + ":" + std::to_string(line);
}

TEST(House, CodeIncludesOnlyItsOwnFloorAndThoseBelow) {
  const std::regex include(R"re(^\s*#\s*include\s+"([^"/]+)/)re");
  for (std::size_t floor = 0; floor < kFloors.size(); ++floor) {
    for (const fs::path& file : files_below(kSource / kFloors[floor])) {
      if (!is_code(file)) continue;
      for_each_line(file, [&](const std::string& line, int number) {
        std::smatch match;
        if (!std::regex_search(line, match, include)) return;
        const auto used = std::find(kFloors.begin(), kFloors.end(), match[1].str());
        ASSERT_NE(used, kFloors.end()) << place(file, number) << ": no such floor: " << line;
        EXPECT_LE(used - kFloors.begin(), static_cast<std::ptrdiff_t>(floor))
            << place(file, number) << ": looks upward: " << line;
      });
    }
  }
}

TEST(House, EveryFloorHasAReadmeOfOneScreen) {
  for (const std::string& floor : kFloors) {
    const fs::path readme = kSource / floor / "README.md";
    ASSERT_TRUE(fs::exists(readme)) << readme;
    int lines = 0;
    for_each_line(readme, [&](const std::string&, int) { ++lines; });
    EXPECT_GT(lines, 3) << readme;
    EXPECT_LE(lines, 60) << readme << " has grown beyond one screen";
  }
}

TEST(House, EveryHeaderIsIncludedOnce) {
  for (const std::string& floor : kFloors) {
    for (const fs::path& file : files_below(kSource / floor)) {
      if (file.extension() != ".hpp") continue;
      std::string first;
      for_each_line(file, [&](const std::string& line, int) {
        if (first.empty()) first = line;
      });
      EXPECT_EQ(first, "#pragma once") << file;
    }
  }
}

TEST(House, NoBuildFileAllowsInexactArithmetic) {
  for (const fs::path& file : files_below(kSource)) {
    if (!is_build_file(file)) continue;
    for_each_line(file, [&](const std::string& line, int number) {
      for (const char* flag : {"-ffast-math", "-Ofast", "-funsafe-math", "-fassociative-math"}) {
        EXPECT_EQ(line.find(flag), std::string::npos) << place(file, number) << ": " << line;
      }
    });
  }
}

// A clone must build anywhere, so neither a package registry nor a folder of the
// machine that a file was written on may be named. The words are put together here
// so that this file does not name them either.
TEST(House, NoFileNamesARegistryOrADevelopersFolder) {
  const std::string slash = "/";
  const std::vector<std::string> words{std::string("registry.") + "npmjs",
                                       std::string("registry.") + "yarnpkg",
                                       std::string("pypi.") + "org",
                                       std::string("pythonhosted.") + "org",
                                       std::string("deb.") + "debian.org",
                                       std::string("crates") + ".io",
                                       std::string("proxy.") + "golang",
                                       slash + "work" + slash,
                                       slash + "home" + slash,
                                       slash + "root" + slash,
                                       slash + "Users" + slash,
                                       std::string("../") + "shared"};
  for (const fs::path& file : files_below(kSource)) {
    for_each_line(file, [&](const std::string& line, int number) {
      for (const std::string& word : words) {
        EXPECT_EQ(line.find(word), std::string::npos) << place(file, number) << " names " << word;
      }
    });
  }
}

}  // namespace
