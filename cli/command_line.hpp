#pragma once

#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "catalog/diagnostics.hpp"

namespace polyglide {

/// What a command is given: its words, a parser to declare its own options with,
/// and, once parsed, the options that all commands share.
///
///     std::string space;
///     line.options().add_option("SPACE", space, "Design-space file")->required();
///     if (!line.parse()) return kDone;
class CommandLine {
 public:
  /// @param name  of the command; @param about one sentence for its help.
  /// @param words what the user typed after the command.
  CommandLine(std::string_view name, std::string_view about, std::vector<std::string> words);

  /// Declare the command's own options and arguments here, before parse().
  [[nodiscard]] CLI::App& options() { return app_; }

  /// Reads the words and sets the number of threads for the rest of the program.
  /// @return false when the user asked for help: it has been printed, nothing is left to do.
  /// @throws InputError with every mistake: unknown options with the nearest known
  ///         one, missing arguments, values that are not of their kind.
  [[nodiscard]] bool parse();

  [[nodiscard]] bool json() const { return json_; }    ///< one JSON document on stdout
  [[nodiscard]] bool quiet() const { return quiet_; }  ///< no talk, no progress
  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  [[nodiscard]] int threads() const { return threads_; }  ///< at most this many at a time

 private:
  CLI::App app_;
  std::vector<std::string> words_;
  bool json_ = false, quiet_ = false;
  std::uint64_t seed_ = 1;
  int threads_ = 0;
  std::optional<tbb::global_control> thread_limit_;
};

/// A mistake on the command line: the word as typed ("" for one that is missing),
/// the rule it breaks, and the valid word it resembles, if any.
[[nodiscard]] Diagnostic wrong_argument(const std::string& word, std::string rule,
                                        const std::string& nearest = "");

/// A check of an option's words, whose mistake reads: "x" — --seed takes a whole number from 0 on.
/// @param kind what follows "takes".
[[nodiscard]] CLI::Validator taking(const std::string& option, const std::string& kind,
                                    const std::function<bool(const std::string&)>& fits);

inline constexpr std::uint64_t kNoBound = std::numeric_limits<std::uint64_t>::max();

/// Of 18 digits at most.
[[nodiscard]] bool is_whole_number(const std::string& word);
[[nodiscard]] CLI::Validator whole_number(const std::string& option, std::uint64_t least = 0,
                                          std::uint64_t most = kNoBound);
[[nodiscard]] CLI::Validator number_between(const std::string& option, double least, double most);
[[nodiscard]] CLI::Validator positive_number(const std::string& option);

/// Numbers separated by commas, as in `--ik 10,0,-5`.
/// @param option what they were given to, for messages.
/// @throws InputError when one of them is not a finite number.
[[nodiscard]] std::vector<double> parse_numbers(std::string_view text, std::string_view option);

}  // namespace polyglide
