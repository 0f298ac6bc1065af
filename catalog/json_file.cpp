#include "catalog/json_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <fstream>

#include "catalog/problems.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

constexpr std::size_t kDeepest = 64;
constexpr std::size_t kMostValues = 2'000'000;
constexpr std::uintmax_t kLargestFile = 64ull << 20;

[[noreturn]] void refuse(const std::string& file, std::string rule, std::string pointer = "",
                         std::string value = "") {
  throw InputError({{file, std::move(pointer), std::move(value), std::move(rule), ""}});
}

/// Builds the document event by event, so that a hostile text is refused at the
/// first bracket too many: no recursion, no memory beyond what was accepted.
class Builder : public nlohmann::json_sax<json> {
 public:
  explicit Builder(const std::string& file) : file_(file) {}

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(json::object()); }
  bool start_array(std::size_t) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    json& object = *open_.back();
    if (object.contains(name)) {
      diagnostics_.push_back({file_, pointer_to(root_, object[name]), '"' + name + '"',
                              "this name is given twice in the same object", ""});
    }
    slot_ = &object[name];
    return true;
  }

  bool parse_error(std::size_t, const std::string&, const json::exception& error) override {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error …"
    std::string text = error.what();
    if (const auto end = text.find("] "); end != std::string::npos) text.erase(0, end + 2);
    // What was read last may be megabytes of anything.
    text.resize(std::min({text.size(), text.find("; last read"), std::size_t{200}}));
    refuse(file_, "must be JSON: " + text);
  }

  json finish() {
    if (!diagnostics_.empty()) throw InputError(diagnostics_);
    return std::move(root_);
  }

 private:
  json* place(json value) {
    if (++count_ > kMostValues)
      refuse(file_, fmt::format("must hold at most {} values", kMostValues));
    if (open_.empty()) return &(root_ = std::move(value));
    if (open_.back()->is_array()) return &open_.back()->emplace_back(std::move(value));
    return &(*slot_ = std::move(value));
  }
  bool put(json value) {
    place(std::move(value));
    return true;
  }
  bool open(json container) {
    if (open_.size() == kDeepest)
      refuse(file_, fmt::format("must not be nested deeper than {} levels", kDeepest));
    open_.push_back(place(std::move(container)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  const std::string& file_;
  json root_;
  std::vector<json*> open_;  ///< stable: a container is not appended to while a child is open
  json* slot_ = nullptr;
  std::size_t count_ = 0;
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace

std::string read_text(const std::filesystem::path& file) {
  const std::string label = file.string();
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) refuse(label, "there must be a file of this name");
  if (std::filesystem::is_directory(status)) refuse(label, "must be a file, not a folder");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuse(label, "must be readable");

  // A pipe has no size beforehand, so the limit is kept while reading.
  std::string text;
  std::string block(1 << 20, '\0');
  if (const auto size = std::filesystem::file_size(file, error); !error)
    text.reserve(std::min(size, kLargestFile + block.size()));
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) ||
         stream.gcount() > 0) {
    text.append(block, 0, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kLargestFile) refuse(label, "must not be larger than 64 MB");
  }
  return text;
}

json parse_json(std::string_view text, const std::string& file) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
    refuse(file, "must not be empty");
  Builder builder(file);
  json::sax_parse(text.begin(), text.end(), &builder);
  return builder.finish();
}

json read_json(const std::filesystem::path& file) {
  return parse_json(read_text(file), file.string());
}

void write_atomically(const std::filesystem::path& file, std::string_view text) {
  static std::atomic<unsigned> counter = 0;
  std::error_code error;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  std::filesystem::path draft = file;
  draft += fmt::format(".{}-{}.tmp", getpid(), counter++);
  {
    std::ofstream stream(draft, std::ios::binary);
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    stream.flush();
    if (!stream) {
      std::filesystem::remove(draft, error);
      refuse(file.string(), "must be writable: no such folder, no permission, or no space left");
    }
  }
  std::filesystem::rename(draft, file, error);
  if (!error) return;
  const std::string reason = error.message();
  std::filesystem::remove(draft, error);
  refuse(file.string(), "must be writable: " + reason);
}

std::string content_hash(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return fmt::format("{:016x}", hash);
}

}  // namespace polyglide
