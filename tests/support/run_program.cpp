#include "support/run_program.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace polyglide::test {
namespace {

std::string quoted(const std::string& word) {
  std::string result = "'";
  for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string contents(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace

std::filesystem::path polyglide_binary() {
  const char* given = std::getenv("POLYGLIDE_BINARY");
  return given != nullptr ? given : POLYGLIDE_BINARY;
}

ProgramResult run_polyglide(const std::vector<std::string>& words, const std::string& elsewhere) {
  const TemporaryFolder folder;
  const std::filesystem::path out =
      elsewhere.empty() ? folder.path() / "out" : std::filesystem::path(elsewhere);
  const std::filesystem::path err = folder.path() / "err";
  std::string command = quoted(polyglide_binary().string());
  for (const std::string& word : words) command += ' ' + quoted(word);
  command += " </dev/null >" + quoted(out.string()) + " 2>" + quoted(err.string());

  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
          elsewhere.empty() ? contents(out) : "", contents(err)};
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "polyglide-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make " + name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& text) const {
  const auto file = path_ / name;
  std::ofstream(file, std::ios::binary) << text;
  return file.string();
}

}  // namespace polyglide::test
