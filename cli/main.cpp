#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/print.hpp"

namespace polyglide {
namespace {

using Words = std::vector<std::string>;

std::string help() {
  std::vector<std::vector<std::string>> rows;
  for (const Command& command : commands()) {
    rows.push_back({"  " + std::string(command.name), std::string(command.help)});
  }
  return "Designs parallel kinematic machines: which layouts there are, which of them are sound,\n"
         "and which dimensions serve best.\n\n"
         "Usage: polyglide COMMAND [ARGUMENT…] [OPTION…]\n\nCommands:\n" +
         columns(rows) +
         "\n`polyglide COMMAND --help` explains a command; `polyglide --version` prints the "
         "version.\n";
}

[[noreturn]] void refuse_command(const std::string& word) {
  std::vector<std::string> names;
  for (const Command& command : commands()) names.emplace_back(command.name);
  throw InputError({wrong_argument(word, "polyglide has no such command (see polyglide --help)",
                                   nearest_word(word, names))});
}

int run(const Words& words) {
  if (words.empty()) {
    std::cerr << help();
    return kWrongInput;
  }
  if (words[0] == "--help" || words[0] == "-h" || words[0] == "help") {
    if (words.size() > 1) return run({words[1], "--help"});
    std::cout << help();
    return kDone;
  }
  if (words[0] == "--version") {
    std::cout << "polyglide " POLYGLIDE_VERSION "\n";
    return kDone;
  }
  const auto command = std::ranges::find(commands(), words[0], &Command::name);
  if (command == commands().end()) refuse_command(words[0]);
  CommandLine line(command->name, command->help, Words(words.begin() + 1, words.end()));
  return command->run(line);
}

int run_and_report(const Words& words) {
  try {
    const int status = run(words);
    if (!std::cout.flush()) {
      std::cerr << "polyglide: cannot write to standard output\n";
      return kWrongInput;
    }
    return status;
  } catch (const InputError& error) {
    for (const Diagnostic& mistake : error.diagnostics()) {
      std::cerr << "polyglide: " << to_string(mistake) << '\n';
    }
    return kWrongInput;
  } catch (const std::exception& error) {
    std::cerr << "polyglide: internal error: " << error.what()
              << "\nThis is a bug in polyglide " POLYGLIDE_VERSION
                 "; please report it with the command and the files it was given.\n";
    return kOurBug;
  }
}

}  // namespace
}  // namespace polyglide

int main(int count, char** words) {
  return polyglide::run_and_report({words + std::min(count, 1), words + count});
}
