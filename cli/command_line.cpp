#include "cli/command_line.hpp"

#include <fmt/format.h>
#include <tbb/info.h>

#include <charconv>
#include <cmath>
#include <iostream>
#include <utility>

namespace polyglide {
namespace {

std::vector<std::string> option_words(const CLI::App& app) {
  std::vector<std::string> words;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
    for (const std::string& name : option->get_snames()) words.push_back("-" + name);
  }
  return words;
}

/// Every word the parser could not place.
std::vector<Diagnostic> unexpected_words(const CLI::App& app) {
  std::vector<Diagnostic> mistakes;
  for (const std::string& word : app.remaining()) {
    const bool option = word.size() > 1 && word.front() == '-';
    const std::string name = word.substr(0, word.find('='));
    const std::string near = option ? nearest_word(name, option_words(app)) : "";
    mistakes.push_back(option
                           ? wrong_argument(word, app.get_name() + " has no such option", near)
                           : wrong_argument(word, app.get_name() + " takes no further argument"));
  }
  return mistakes;
}

/// What the parser itself refuses, in our words; it has "--option: …" and "Could not convert:
/// --option = word".
Diagnostic refused(const CLI::ParseError& error, const CLI::App& app) {
  const std::string told = error.what(), help = " (see " + app.get_name() + " --help)";
  const std::string kUnread = "Could not convert: ";
  if (const std::size_t equals = told.find(" = ");
      told.starts_with(kUnread) && equals != std::string::npos)
    return wrong_argument(
        told.substr(equals + 3),
        "no value for " + told.substr(kUnread.size(), equals - kUnread.size()) + help);
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr)
    return wrong_argument("", told.substr(0, told.find(':')) + " takes a value" + help);
  return wrong_argument("", told + help);
}

/// Of whole numbers that do not overflow.
constexpr std::size_t kMostDigits = 18;

}  // namespace

CommandLine::CommandLine(std::string_view name, std::string_view about,
                         std::vector<std::string> words)
    : app_(std::string(about), "polyglide " + std::string(name)),
      words_(std::move(words)),
      threads_(tbb::info::default_concurrency()) {
  app_.allow_extras();  // so that parse() can report all of them, with suggestions
  app_.set_help_flag("-h,--help", "Print this help and exit");
  app_.add_flag("--json", json_, "Print one JSON document on standard output, nothing else");
  app_.add_option("--threads", threads_, "Use at most N threads; results do not depend on it")
      ->check(whole_number("--threads", 1, 4096))
      ->type_name("N");
  app_.add_option("--seed", seed_, "Seed of everything random (default 1)")
      ->check(whole_number("--seed"))
      ->type_name("N");
  app_.add_flag("--quiet", quiet_, "No progress and no remarks on standard error");
}

bool CommandLine::parse() {
  std::vector<Diagnostic> mistakes;
  try {
    // CLI11 takes the last word first.
    app_.parse(std::vector<std::string>(words_.rbegin(), words_.rend()));
  } catch (const CLI::CallForHelp&) {
    std::cout << app_.help();
    return false;
  } catch (const CLI::ParseError& error) {
    mistakes.push_back(refused(error, app_));
  } catch (const InputError& error) {  // of validators
    mistakes = error.diagnostics();
  }
  for (Diagnostic& mistake : unexpected_words(app_)) mistakes.push_back(std::move(mistake));
  if (!mistakes.empty()) throw InputError(std::move(mistakes));

  thread_limit_.emplace(tbb::global_control::max_allowed_parallelism,
                        static_cast<std::size_t>(threads_));
  return true;
}

Diagnostic wrong_argument(const std::string& word, std::string rule, const std::string& nearest) {
  return {.file = "",
          .pointer = "",
          .value = word.empty() ? "" : '"' + word + '"',
          .rule = std::move(rule),
          .hint = nearest.empty() ? "" : "did you mean " + nearest + "?"};
}

CLI::Validator taking(const std::string& option, const std::string& kind,
                      const std::function<bool(const std::string&)>& fits) {
  return {[=](const std::string& word) {
            if (!fits(word)) throw InputError({wrong_argument(word, option + " takes " + kind)});
            return std::string();
          },
          ""};
}

bool is_whole_number(const std::string& word) {
  return !word.empty() && word.size() <= kMostDigits &&
         word.find_first_not_of("0123456789") == std::string::npos;
}

CLI::Validator whole_number(const std::string& option, std::uint64_t least, std::uint64_t most) {
  const std::string kind = most == kNoBound
                               ? fmt::format("a whole number from {} on", least)
                               : fmt::format("a whole number from {} to {}", least, most);
  return taking(option, kind, [=](const std::string& word) {
    return is_whole_number(word) && std::stoull(word) >= least && std::stoull(word) <= most;
  });
}

namespace {

CLI::Validator taking_number(const std::string& option, const std::string& kind,
                             const std::function<bool(double)>& fits) {
  return taking(option, kind, [fits](const std::string& word) {
    double value = 0;
    return CLI::detail::lexical_cast(word, value) && fits(value);
  });
}

}  // namespace

CLI::Validator number_between(const std::string& option, double least, double most) {
  return taking_number(option, fmt::format("a number from {:g} to {:g}", least, most),
                       [=](double value) { return value >= least && value <= most; })
      .description(fmt::format("{:g} to {:g}", least, most));
}

CLI::Validator positive_number(const std::string& option) {
  return taking_number(option, "a positive number",
                       [](double value) { return value > 0 && std::isfinite(value); })
      .description("positive");
}

std::vector<double> parse_numbers(std::string_view text, std::string_view option) {
  std::vector<double> numbers;
  for (std::size_t start = 0; start <= text.size();) {
    const std::string_view word = text.substr(start, text.find(',', start) - start);
    start += word.size() + 1;
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(number)) {
      throw InputError({wrong_argument(
          std::string(text), std::string(option) + " takes finite numbers separated by commas")});
    }
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace polyglide
