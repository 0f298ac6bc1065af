#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace SQLite {
class Database;
}

namespace polyglide {

/// What a store belongs to: facts that make its results reusable, such as
/// {"space": content hash, "seed": "1", "version": "0.1.0"}.
using StoreIdentity = std::map<std::string, std::string>;

/// Finished evaluations of one campaign, durable on disk (SQLite, WAL).
///
/// An evaluation is a text (JSON, by convention) under a kind, such as "verdict"
/// or "tuning", and a key, such as a candidate's id. A finished evaluation is on
/// disk at most half a second after put(), so `kill -9` loses no more than that; opening the
/// file again continues the campaign. Two programs on one file do no harm.
/// All members may be called from any thread.
class Store {
 public:
  /// Opens or creates the file and missing folders.
  /// @throws InputError: the folder cannot be written, the file is no store, is of
  ///         a later version, or belongs to another identity (every fact that differs).
  Store(const std::filesystem::path& file, const StoreIdentity& identity);

  /// Writes what is pending.
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  /// The stored text, or nothing when this evaluation is not finished yet.
  [[nodiscard]] std::optional<std::string> find(const std::string& kind, const std::string& key);

  /// All finished evaluations of a kind, by key.
  [[nodiscard]] std::map<std::string, std::string> all(const std::string& kind);

  /// Records a finished evaluation; a second one under the same key replaces it.
  /// @throws InputError when the disk is full or the file no longer writable.
  void put(const std::string& kind, const std::string& key, const std::string& text);

  /// Makes everything put so far durable now.
  void flush();

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  void open(const StoreIdentity& identity);
  void commit();  ///< needs mutex_
  void commit_regularly(const std::stop_token& stop);

  std::filesystem::path file_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::unique_ptr<SQLite::Database> database_;
  bool pending_ = false;  ///< a transaction is open
  std::jthread writer_;   ///< last, so that it ends before what it uses
};

}  // namespace polyglide
