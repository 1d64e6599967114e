#include "data/study/database.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <string_view>

#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "analysis/numerics/stop_request.h"
#include "data/files/draft.h"
#include "data/study/continuation.h"
#include "data/study/schema_check.h"
#include "data/study/study_lock.h"
#include "protocols/input/file_trouble.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

constexpr int kBusyTimeout_ms = 5000;
constexpr const char* kQuickCheck = "quick_check(1)";
constexpr const char* kWholeCheck = "integrity_check(1)";  // of the indexes too
constexpr int kStepsBetweenLooks = 10'000;                 // of SQLite's virtual machine: well below a millisecond

void refuse_other_files(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (error && status.type() != fs::file_type::not_found) throw cannot_read(path, error.value());
  if (!fs::exists(status))
    throw StorageError(fmt::format("{}: there is no such study; jnd run and jnd simulate create one", path.string()));
  if (!fs::is_regular_file(status)) throw StorageError(fmt::format("{}: is not a file", path.string()));
  std::ifstream file(path, std::ios::binary);
  if (!file) throw cannot_read(path, errno);
  std::array<char, 16> start{};
  file.read(start.data(), start.size());
  if (std::string_view(start.data(), static_cast<std::size_t>(file.gcount())) !=
      std::string_view("SQLite format 3\0", 16))
    throw StorageError(
        fmt::format("{}: is not a study (not an SQLite file); it was not changed. Check the name", path.string()));
}

int pragma(SQLite::Database& database, const char* name) {
  SQLite::Statement query(database, fmt::format("PRAGMA {}", name));
  return query.executeStep() ? query.getColumn(0).getInt() : 0;
}

void refuse_other_databases(const fs::path& path, SQLite::Database& database, int newest) {
  const int application = pragma(database, "application_id");
  if (application == kApplicationIdBeforeRelease) throw written_before_release(path);
  if (application != kApplicationId)
    throw StorageError(fmt::format("{}: is an SQLite database but not a jnd study; it was not changed", path.string()));
  const int version = pragma(database, "user_version");
  if (version > newest)
    throw StorageError(fmt::format(
        "{}: was written by a newer jnd (file version {}, this program knows up to {}); it was not changed. "
        "Install the newer program to go on",
        path.string(), version, newest));
  if (version < 1)
    throw StorageError(
        fmt::format("{}: is an unfinished study (file version {}); it was not changed", path.string(), version));
}

// A view in a table's place, a foreign trigger or a rewritten column could hang the program, swallow what it writes, or
// show other answers than were given. Reading does without triggers, indexes and views that were dropped: verify tells
// of them.
void refuse_other_schema(const fs::path& path, SQLite::Database& database, bool writable, SchemaSteps steps) {
  SQLite::Transaction reading(database);  // a writer may bring the file up to date meanwhile
  for (const SchemaDifference& one : schema_differences(database, steps))
    if (writable || !one.readable())
      throw StorageError(
          fmt::format("{}: is not a study of this program: {}; it was not changed. jnd recover makes a "
                      "new study of the events that are in it",
                      path.string(), to_string(one)));
  reading.commit();
}

// Extended codes carry the primary one in their lowest byte.
int primary_code(const SQLite::Exception& error) noexcept {
  return error.getErrorCode() & 0xFF;
}

// SQLite tells a full disk and an error of the disk; which error that was, errno says where a write failed.
FileTrouble trouble_of(const fs::path& path, const SQLite::Exception& error, int system_error) {
  switch (primary_code(error)) {
    case SQLITE_FULL:
      return file_trouble(path, ENOSPC, FileUse::write);
    case SQLITE_IOERR: {
      constexpr std::array kOfWriting = {ENOSPC, EDQUOT, EFBIG, EROFS};
      const bool known = std::find(kOfWriting.begin(), kOfWriting.end(), system_error) != kOfWriting.end();
      return file_trouble(path, known ? system_error : EIO, FileUse::write);
    }
    default:
      if (const int obstacle = write_obstacle(path); obstacle != 0) return file_trouble(path, obstacle, FileUse::write);
      return {error.what(), "check the permissions of the file, its folder and the files beside it (-wal, -shm)"};
  }
}

StorageError damaged(const fs::path& path, const std::string& how) {
  return StorageError(
      fmt::format("{}: is damaged ({}); it was not changed. Go on with a copy or a backup; jnd verify says more",
                  path.string(), how));
}

void refuse_damage(const fs::path& path, SQLite::Database& database) {
  if (const std::string damage = damage_in(database, kQuickCheck); damage != "ok") throw damaged(path, damage);
}

void configure(SQLite::Database& database) {
  database.setBusyTimeout(kBusyTimeout_ms);
  // Files come from anywhere: nothing in one may write to the schema. What its schema may call is decided by comparing
  // it with ours; an untrusted one could not, because SQLite of 2022 and before takes json_extract for unsafe there.
  sqlite3_db_config(database.getHandle(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  database.exec("PRAGMA foreign_keys = ON");
}

// One statement can take minutes on a large file. Not for a writer: it ends between events, never within one.
void end_reading_when_asked(SQLite::Database& database) {
  sqlite3_progress_handler(
      database.getHandle(), kStepsBetweenLooks, [](void*) { return stop_requested() ? 1 : 0; }, nullptr);
}

// An absolute name: SQLite gives names such as ":memory:" a meaning of their own.
std::unique_ptr<SQLite::Database> opened(const std::string& name, int flags) {
  auto database = std::make_unique<SQLite::Database>(name, flags);
  configure(*database);
  database->exec("PRAGMA query_only = ON");
  return database;
}

void refuse_no_study(const fs::path& path, SQLite::Database& database, bool writable, SchemaSteps steps) {
  refuse_other_databases(path, database, static_cast<int>(steps.size()));
  refuse_other_schema(path, database, writable, steps);
}

// The study without what lies beside it; null if it cannot be read so.
std::unique_ptr<SQLite::Database> opened_alone(const fs::path& path, SchemaSteps steps) {
  std::string name = "file://";
  for (const char c : fs::absolute(path).string())
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '/'
                ? std::string(1, c)
                : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  try {
    auto alone = opened(name + "?immutable=1", SQLite::OPEN_READONLY | SQLite::OPEN_URI);
    refuse_no_study(path, *alone, false, steps);
    return alone;
  } catch (const SQLite::Exception&) {
    return nullptr;
  } catch (const StorageError&) {
    return nullptr;
  }
}

bool is_damage(const SQLite::Exception& error) noexcept {
  const int code = primary_code(error);
  return code == SQLITE_CORRUPT || code == SQLITE_NOTADB || code == SQLITE_ERROR;
}

bool is_whole(SQLite::Database& database) {
  try {
    return damage_in(database, kWholeCheck) == "ok";
  } catch (const SQLite::Exception& error) {
    if (!is_damage(error)) throw;
    return false;
  }
}

// Whether `both`, the study with what lies beside it, is whole and goes on from the study. Throws StorageError if the
// study is whole without it only, and, for a writer, if it is whole neither way.
// most: bytes that the two together may have.
bool is_own(const fs::path& path, const fs::path& beside, SQLite::Database& both, bool writable, SchemaSteps steps,
            std::uintmax_t most = UINTMAX_MAX) {
  const std::unique_ptr<SQLite::Database> alone = opened_alone(path, steps);
  std::string why;
  try {
    refuse_no_study(path, both, false, steps);
    why = why_no_continuation(alone.get(), both);
    if (why.empty()) why = damage_in(both, kWholeCheck);
    if (why == "ok" && static_cast<std::uintmax_t>(pragma(both, "page_count")) *
                               static_cast<std::uintmax_t>(pragma(both, "page_size")) >
                           most)
      why = "it is of a larger file";
    if (why == "ok") return true;
  } catch (const StorageError& error) {
    if (!alone) throw;
    why = error.what();
  } catch (const SQLite::Exception& error) {
    if (!is_damage(error)) throw;
    why = error.what();
  }
  if (alone && is_whole(*alone))
    throw StorageError(
        fmt::format("{}: {}, which lies beside it, does not continue this study ({}); nothing was changed. It may hold "
                    "answers of the study that had this name before: move this study to another name, put that one "
                    "back and run jnd verify on it. Or move {} away, and keep it",
                    path.string(), beside.string(), why, beside.filename().string()));
  if (writable) throw damaged(path, why);
  return false;
}

// SQLite plays a rollback journal back before it reads anything, into the study also for a reader. It is tried on a
// copy.
void refuse_foreign_journal(const fs::path& path, SchemaSteps steps) {
  const fs::path place = real_place(path), journal = place.string() + "-journal";
  if (std::ifstream file(journal, std::ios::binary); file.get() <= 0) return;  // none, or one that is over
  const Draft copy(place, Draft::What::file);
  const auto copied = [&](const fs::path& from, const fs::path& to) {
    std::error_code error;
    if (!fs::copy_file(from, to, fs::copy_options::overwrite_existing, error)) throw cannot_write(to, error.value());
  };
  copied(place, copy.path());
  copied(journal, copy.path().string() + "-journal");
  // A transaction makes the file larger or leaves it: taken back it is no larger than it was found.
  is_own(path, journal, *opened(copy.path().string(), SQLite::OPEN_READWRITE), true, steps, fs::file_size(place));
}

// Until a log is known to be the study's, closing the study must not put it into the file.
void keep_log_out(SQLite::Database& database, bool out) {
  sqlite3_db_config(database.getHandle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, out ? 1 : 0, nullptr);
}

}  // namespace

std::string damage_in(SQLite::Database& database, const char* check) {
  try {
    SQLite::Statement query(database, fmt::format("PRAGMA {}", check));
    return query.executeStep() ? query.getColumn(0).getString() : "ok";
  } catch (const SQLite::Exception& error) {
    if (primary_code(error) != SQLITE_ERROR) throw;
    return "an event in it is not what was written";  // it looks into events for their columns: "malformed JSON"
  }
}

std::unique_ptr<SQLite::Database> create_database(const fs::path& path) {
  // Before anything is in it: -wal and -shm take over its mode.
  if (::chmod(path.c_str(), 0600) != 0) throw cannot_write(path, errno);
  return with_storage_errors(path, [&] {
    auto database = std::make_unique<SQLite::Database>(fs::absolute(path).string(), SQLite::OPEN_READWRITE);
    configure(*database);
    database->exec("PRAGMA synchronous = FULL");
    SQLite::Transaction transaction(*database);
    migrate(*database, 0);
    transaction.commit();
    return database;
  });
}

std::unique_ptr<SQLite::Database> open_database(const fs::path& path, bool writable, SchemaSteps steps) {
  refuse_other_files(path);
  const int newest = static_cast<int>(steps.size());
  // A reader opens for writing too where it may: after a crash SQLite must replay the write-ahead log, which needs its
  // index file. query_only then keeps it from changing any row.
  const int obstacle = write_obstacle(path);
  const bool may_write = obstacle == 0 || obstacle == ENOSPC;  // which passes, and reading needs no room
  if (writable && !may_write) throw cannot_write(path, obstacle);
  // Who writes to it has looked at what lies beside it.
  const bool looks = writable || !in_use(path, true);
  return with_storage_errors(path, [&] {
    if (looks && may_write) refuse_foreign_journal(path, steps);
    auto database = opened(fs::absolute(path).string(), may_write ? SQLite::OPEN_READWRITE : SQLite::OPEN_READONLY);
    if (!writable) end_reading_when_asked(*database);
    const fs::path log = real_place(path).string() + "-wal";
    std::error_code none;
    bool whole = false;  // is known to be
    if (const auto size = fs::file_size(log, none); looks && !none && size > 0) {
      keep_log_out(*database, true);
      whole = is_own(path, log, *database, writable, steps);
      keep_log_out(*database, !whole);
    }
    refuse_no_study(path, *database, writable, steps);
    if (!writable) return database;
    if (!whole) refuse_damage(path, *database);
    database->exec("PRAGMA query_only = OFF");
    const int version = pragma(*database, "user_version");
    if (version < newest) {
      SQLite::Transaction transaction(*database, SQLite::TransactionBehavior::IMMEDIATE);
      migrate(*database, version, steps);
      transaction.commit();
    }
    return database;
  });
}

StorageError written_before_release(const fs::path& path) {
  return StorageError(fmt::format(
      "{}: was written by a jnd from before its first release, whose files this program does not read; it was not "
      "changed. Simulate or run the study again with this program, or analyse the CSV files that were exported from it",
      path.string()));
}

void begin_writing(SQLite::Database& database) {
  database.exec("PRAGMA synchronous = FULL");
  SQLite::Statement mode(database, "PRAGMA journal_mode = WAL");
  if (!mode.executeStep() || mode.getColumn(0).getString() != "wal")
    throw StorageError(
        fmt::format("{}: this file system does not support SQLite's write-ahead log; keep the study on a local disk",
                    database.getFilename()));
}

void end_writing(SQLite::Database& database) {
  // Busy or locked (a reader that stays, or nothing read yet on this connection) is no error: what matters is
  // committed, and the next opening or closing puts the rest in its place.
  const auto unless_busy = [&](const char* pragma_text) {
    SQLite::Statement statement(database, pragma_text);
    const int result = statement.tryExecuteStep();
    if (result != SQLITE_ROW && result != SQLITE_BUSY && result != SQLITE_LOCKED)
      throw SQLite::Exception(database.getHandle(), result);
  };
  unless_busy("PRAGMA wal_checkpoint(TRUNCATE)");
  database.setBusyTimeout(0);
  unless_busy("PRAGMA journal_mode = DELETE");
}

void insert_row(SQLite::Statement& insert, const fs::path& path) {
  if (insert.exec() != 1)
    throw StorageError(fmt::format(
        "{}: a row was not stored although nothing failed: something in the file swallows it; run jnd verify",
        path.string()));
}

bool is_network_file_system(long f_type) noexcept {
  // statfs(2); SMB2 and Ceph from the kernel's own headers; Lustre, GPFS and the shared folders of VirtualBox and
  // VMware from their sources. As unsigned: some have the top bit of 32 set.
  constexpr std::array<unsigned, 13> kNetwork = {0x6969,     0x517B,     0xFF534D42, 0xFE534D42, 0x5346414F,
                                                 0x73757245, 0x01021997, 0x00C36400, 0x6B414653, 0x0BD00BD0,
                                                 0x47504653, 0x786F4256, 0xBACBACBC};
  return std::find(kNetwork.begin(), kNetwork.end(), static_cast<unsigned>(f_type)) != kNetwork.end();
}

void refuse_network_file_system(const fs::path& path) {
  struct statfs status {};
  if (::statfs(path.c_str(), &status) == 0 && is_network_file_system(static_cast<long>(status.f_type)))
    throw StorageError(
        fmt::format("{}: is on a network file system, which cannot promise that an answer is saved; run real sessions "
                    "with the study on a local disk",
                    path.string()));
}

void throw_if_stopped(const SQLite::Exception& error) {
  if (primary_code(error) == SQLITE_INTERRUPT && stop_requested()) throw Stopped();
}

StorageError storage_error(const fs::path& path, const SQLite::Exception& error, int system_error) {
  throw_if_stopped(error);
  const std::string where = path.string();
  switch (primary_code(error)) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return damaged(path, error.what());
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return StorageError(
          fmt::format("{}: another program holds the file ({}); close it and try again", where, error.what()));
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
    case SQLITE_FULL:
    case SQLITE_IOERR:
      return StorageError(fmt::format("{}: cannot be {} or written: {}. All events that were said to be saved are",
                                      where, is_disk_error(error) ? "read" : "opened",
                                      trouble_of(path, error, system_error).text()));
    default:
      return StorageError(fmt::format("{}: {}", where, error.what()));
  }
}

bool is_disk_error(const SQLite::Exception& error) noexcept {
  return primary_code(error) == SQLITE_IOERR;
}

bool is_full(const SQLite::Exception& error) noexcept {
  return primary_code(error) == SQLITE_FULL;
}

void throw_write_error(const fs::path& path, const SQLite::Exception& error, int system_error) {
  const std::string where = path.string();
  switch (primary_code(error)) {
    case SQLITE_FULL:
    case SQLITE_IOERR:
      throw StorageTrouble(fmt::format("{}: cannot be written: {}. This event is not saved, all earlier ones are",
                                       where, trouble_of(path, error, system_error).text()));
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw StorageTrouble(
          fmt::format("{}: another program holds the file ({}): this event is not saved, all earlier ones are. Close "
                      "that program and try again",
                      where, error.what()));
    case SQLITE_CONSTRAINT:
      throw StorageError(fmt::format(
          "{}: the study refuses this event ({}), as if another program had written to it meanwhile: the "
          "event is not saved, all earlier ones are. Close that program, look at the study with jnd verify, "
          "and take the session up again",
          where, error.what()));
    default:
      throw storage_error(path, error, system_error);
  }
}

}  // namespace jnd
