#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace polyglide::test {

/// What a finished program left behind.
struct ProgramResult {
  int status = -1;  ///< exit status; 128 + n when signal n ended it
  std::string out;  ///< standard output
  std::string err;  ///< standard error
};

/// The built `polyglide`: the environment variable POLYGLIDE_BINARY, else the one
/// this test was built with.
[[nodiscard]] std::filesystem::path polyglide_binary();

/// Runs `polyglide` with these words and no input, and waits for its end.
/// @param out where its standard output goes instead, "" to catch it.
[[nodiscard]] ProgramResult run_polyglide(const std::vector<std::string>& words,
                                          const std::string& out = "");

/// Whether a text has `part` in it.
[[nodiscard]] inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A new empty folder under the system's temporary folder; removed when this goes.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Writes a file into the folder and returns its path.
  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

}  // namespace polyglide::test
