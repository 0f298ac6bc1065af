#include "cli/command_line.hpp"

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
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  app_.add_option("--seed", seed_, "Seed of everything random (default 1)")
      ->check(whole_number())
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
    mistakes.push_back(
        wrong_argument("", std::string(error.what()) + " (see " + app_.get_name() + " --help)"));
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

CLI::Validator whole_number() {
  return CLI::Validator(
      [](const std::string& word) {
        const bool digits =
            !word.empty() && word.find_first_not_of("0123456789") == std::string::npos;
        return digits && word.size() <= 18 ? std::string()
                                           : "\"" + word + "\" is no whole number from 0 on";
      },
      "");
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
