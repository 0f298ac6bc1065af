#include "synthesis/store.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <system_error>
#include <utility>
#include <vector>

#include "catalog/diagnostics.hpp"

namespace polyglide {
namespace {

constexpr int kApplication = 0x50474C44;  // "PGLD": tells our files from other SQLite files
constexpr int kVersion = 1;               // of the tables below
constexpr auto kCommitEvery = std::chrono::milliseconds(400);

constexpr const char* kTables = R"(
  CREATE TABLE identity (fact TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
  CREATE TABLE evaluation (kind TEXT NOT NULL, key TEXT NOT NULL, result TEXT NOT NULL,
                           PRIMARY KEY (kind, key)) WITHOUT ROWID;
)";

int pragma(SQLite::Database& database, const char* name) {
  return database.execAndGet(fmt::format("PRAGMA {}", name)).getInt();
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& value,
                         const std::string& rule) {
  throw InputError({{file.string(), "", value, rule, "name another store, or remove this one"}});
}

void create(SQLite::Database& database, const StoreIdentity& identity) {
  SQLite::Transaction transaction(database);
  database.exec(kTables);
  database.exec(fmt::format("PRAGMA application_id = {}", kApplication));
  database.exec(fmt::format("PRAGMA user_version = {}", kVersion));
  for (const auto& [fact, value] : identity) {
    SQLite::Statement insert(database, "INSERT INTO identity VALUES (?, ?)");
    insert.bind(1, fact);
    insert.bind(2, value);
    insert.exec();
  }
  transaction.commit();
}

StoreIdentity read_identity(SQLite::Database& database) {
  StoreIdentity identity;
  SQLite::Statement rows(database, "SELECT fact, value FROM identity");
  while (rows.executeStep()) identity[rows.getColumn(0)] = rows.getColumn(1).getString();
  return identity;
}

// Every fact in which the store and the campaign differ, as one mistake each.
std::vector<Diagnostic> differences(const StoreIdentity& stored, const StoreIdentity& asked,
                                    const std::string& file) {
  std::vector<Diagnostic> result;
  StoreIdentity facts = stored;
  facts.insert(asked.begin(), asked.end());
  const auto fact_in = [](const StoreIdentity& identity, const std::string& fact) {
    const auto found = identity.find(fact);
    return found == identity.end() ? std::string("(none)") : found->second;
  };
  for (const auto& [fact, unused] : facts) {
    const std::string has = fact_in(stored, fact), needs = fact_in(asked, fact);
    if (has != needs)
      result.push_back({file, "", has,
                        fmt::format("this store belongs to another campaign: its {} is {}, "
                                    "this run's is {}",
                                    fact, has, needs),
                        "name another store, or remove this one"});
  }
  return result;
}

}  // namespace

Store::Store(const std::filesystem::path& file, const StoreIdentity& identity) : file_(file) {
  try {
    open(identity);
  } catch (const SQLite::Exception& error) {
    refuse(file_, error.what(), "must be a campaign store that can be written");
  }
  writer_ = std::jthread([this](const std::stop_token& stop) { commit_regularly(stop); });
}

Store::~Store() {
  writer_.request_stop();
  if (writer_.joinable()) writer_.join();
  try {
    flush();
  } catch (const InputError&) {
    // The disk is full or gone: what was committed stays, the rest is computed again.
  }
}

void Store::open(const StoreIdentity& identity) {
  std::error_code no_folder;
  if (file_.has_parent_path()) std::filesystem::create_directories(file_.parent_path(), no_folder);
  if (no_folder) refuse(file_, no_folder.message(), "the store's folder must be writable");

  database_ = std::make_unique<SQLite::Database>(
      file_.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, 10'000 /* ms */);
  const bool empty = database_->execAndGet("SELECT count(*) FROM sqlite_master").getInt() == 0;
  if (!empty && pragma(*database_, "application_id") != kApplication)
    refuse(file_, "another SQLite file", "must be a campaign store");
  if (pragma(*database_, "user_version") > kVersion)
    refuse(file_, fmt::format("version {}", pragma(*database_, "user_version")),
           fmt::format("must be of version {} or earlier", kVersion));
  database_->exec("PRAGMA journal_mode = WAL");
  if (empty) create(*database_, identity);
  const auto wrong = differences(read_identity(*database_), identity, file_.string());
  if (!wrong.empty()) throw InputError(wrong);
}

std::optional<std::string> Store::find(const std::string& kind, const std::string& key) {
  const std::lock_guard lock(mutex_);
  SQLite::Statement row(*database_, "SELECT result FROM evaluation WHERE kind = ? AND key = ?");
  row.bind(1, kind);
  row.bind(2, key);
  if (!row.executeStep()) return std::nullopt;
  return row.getColumn(0).getString();
}

std::map<std::string, std::string> Store::all(const std::string& kind) {
  const std::lock_guard lock(mutex_);
  std::map<std::string, std::string> result;
  SQLite::Statement rows(*database_, "SELECT key, result FROM evaluation WHERE kind = ?");
  rows.bind(1, kind);
  while (rows.executeStep()) result[rows.getColumn(0)] = rows.getColumn(1).getString();
  return result;
}

void Store::put(const std::string& kind, const std::string& key, const std::string& text) {
  const std::lock_guard lock(mutex_);
  try {
    if (!pending_) database_->exec("BEGIN IMMEDIATE");
    pending_ = true;
    SQLite::Statement insert(*database_, "INSERT OR REPLACE INTO evaluation VALUES (?, ?, ?)");
    insert.bind(1, kind);
    insert.bind(2, key);
    insert.bind(3, text);
    insert.exec();
  } catch (const SQLite::Exception& error) {
    refuse(file_, error.what(), "the store must stay writable and its disk must have room");
  }
}

void Store::flush() {
  const std::lock_guard lock(mutex_);
  try {
    commit();
  } catch (const SQLite::Exception& error) {
    refuse(file_, error.what(), "the store must stay writable and its disk must have room");
  }
}

void Store::commit() {
  if (!pending_) return;
  database_->exec("COMMIT");
  pending_ = false;
}

// A thread of its own, because the next put() may be minutes away.
void Store::commit_regularly(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    wake_.wait_for(lock, stop, kCommitEvery, [] { return false; });
    try {
      commit();
    } catch (const SQLite::Exception&) {
      // Tried again next time; the caller learns of a lasting failure from put() or flush().
    }
  }
}

}  // namespace polyglide
