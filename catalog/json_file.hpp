#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "catalog/diagnostics.hpp"

namespace polyglide {

/// The text of a file. @throws InputError: missing, unreadable, larger than 64 MB.
[[nodiscard]] std::string read_text(const std::filesystem::path& file);

/// Reads and parses a JSON file.
/// Refused with an InputError, never a crash: missing or unreadable file, empty
/// file, more than 64 MB or 2 million values, text that is not JSON (line and
/// column), nesting deeper than 64, the same key twice in one object, numbers that
/// are not finite.
[[nodiscard]] nlohmann::json read_json(const std::filesystem::path& file);

/// The same from text in memory; `file` labels messages.
[[nodiscard]] nlohmann::json parse_json(std::string_view text, const std::string& file);

/// Writes a file so that it is either the old or the new one, whole, at any
/// moment (temporary file beside it, then rename). Creates missing folders.
void write_atomically(const std::filesystem::path& file, std::string_view text);

/// Checks a document against catalog/schema/<schema>.schema.json and returns
/// every violation with pointer, value, rule (the schema's own description) and
/// the nearest valid word. Knows the keywords our schemas use.
[[nodiscard]] std::vector<Diagnostic> check_schema(const nlohmann::json& document,
                                                   const std::string& schema,
                                                   const std::string& file);

/// 64-bit FNV-1a of the text as 16 hex digits; names runs and candidates. Not
/// cryptographic.
[[nodiscard]] std::string content_hash(std::string_view text);

}  // namespace polyglide
