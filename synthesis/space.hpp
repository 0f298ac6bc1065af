#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace polyglide {

/// One decision of a design space: which of its options a candidate takes.
struct Choice {
  struct Option {
    std::string label;
    nlohmann::json value;      ///< as in Space::document
    std::vector<int> choices;  ///< choices inside the value, by index, each once
  };
  std::string name;  ///< its name, or its place in the file when written in place
  std::string about;
  std::vector<Option> options;  ///< at least one
};

/// A design space: a layout with choices in it. Made by load_space() or
/// parse_space(), which check it; then fixed, so share it between threads.
struct Space {
  std::string name, title, about;
  std::string file;                      ///< for messages
  std::string hash;                      ///< content hash of the file's document
  std::vector<std::string> known;        ///< catalog entries to look for
  nlohmann::json document;               ///< the layout; every choice in it is {"choose": index}
  std::vector<int> choices_in_document;  ///< by index, each once
  std::vector<Choice> choices;  ///< in an order where a choice comes before those in its options
  std::map<std::vector<int>, std::uint64_t> ways;  ///< number of ways to make all of an
                                                   ///< ascending list of choices; at least all
                                                   ///< lists that candidate() comes across
};

/// One way to choose everything.
struct RawCandidate {
  std::uint64_t index = 0;
  nlohmann::json layout;  ///< a "polyglide/layout/1" document without unused parameters
  std::map<std::string, std::string> choices;  ///< label taken, by name of the choice
};

/// Reads a "polyglide/space/1" file.
/// @throws InputError with every mistake: against the schema, a choice that is not
///         declared (with the nearest name), that has no options, a label twice, or that
///         contains itself; a `known` name that is not in the catalog; and, for every option
///         of every choice, what is wrong with one layout that takes it.
[[nodiscard]] Space load_space(const std::filesystem::path& file);

/// The same from a document in memory; `file` only labels messages.
[[nodiscard]] Space parse_space(nlohmann::json document, const std::string& file);

/// Number of ways to choose everything: a choice counts once however often its
/// name (the one after "as", if there is one) is used, and a choice inside an option only where
/// that option is taken. A space without choices has one. At most 2^53; load_space refuses more.
[[nodiscard]] std::uint64_t raw_count(const Space& space);

/// The candidate of that index, 0 <= index < raw_count(space); the first choice
/// varies slowest. Cost: about 50 µs.
/// @throws std::out_of_range
[[nodiscard]] RawCandidate raw_candidate(const Space& space, std::uint64_t index);

}  // namespace polyglide
