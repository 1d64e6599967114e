// Opening the SQLite file of a study: what is refused, and with which words.
#pragma once

#include <cerrno>
#include <filesystem>
#include <memory>
#include <string>

#include <SQLiteCpp/SQLiteCpp.h>

#include "data/log/storage_error.h"
#include "data/study/schema.h"

namespace jnd {

// The schema in an empty file that exists (data/files/draft.h makes it), readable by its owner only. Throws
// StorageError.
std::unique_ptr<SQLite::Database> create_database(const std::filesystem::path& path);

// An existing study. Nothing is written before the file was found to be a whole study of the version that `steps` make,
// or of an older one, with the tables, triggers and views of that version and no others, and that a log or journal beside
// it goes on from it. Opened for writing, an older
// file becomes one of the newest version in one transaction; opened for reading it stays as it is. Throws StorageError.
std::unique_ptr<SQLite::Database> open_database(const std::filesystem::path& path, bool writable,
                                                SchemaSteps steps = schema_steps());

// The first line that a check of SQLite's ("quick_check(1)") says; "ok" if it finds nothing. Throws SQLite::Exception.
std::string damage_in(SQLite::Database& database, const char* check);

// Why a file with the mark of the programs before the release (kApplicationIdBeforeRelease) is not read.
StorageError written_before_release(const std::filesystem::path& path);

// Write-ahead log on, for as long as the file is open for writing.
void begin_writing(SQLite::Database& database);
// Everything into the one file, and no -wal or -shm beside it (unless a reader has the file open: then the last one to
// close it does that).
void end_writing(SQLite::Database& database);

// Whether statfs(2)'s f_type is a network file system (NFS, SMB, CIFS, AFS, Coda, 9P, Ceph): their locks and flushes
// cannot be trusted with people's answers.
bool is_network_file_system(long f_type) noexcept;
// Throws StorageError where the study is on one.
void refuse_network_file_system(const std::filesystem::path& path);

// Runs an INSERT of one row into the study at `path`. Throws StorageError where no row was stored although nothing
// failed (a trigger may swallow one), and SQLite::Exception.
void insert_row(SQLite::Statement& insert, const std::filesystem::path& path);

// Throws Stopped (analysis/numerics/stop_request.h) where reading ended because that was asked for: a file opened for
// reading ends its statements then.
void throw_if_stopped(const SQLite::Exception& error);

// What went wrong, where, and what to do, from SQLite's error. system_error: errno as it was when the error was caught;
// SQLite's code alone does not tell a quota from a broken disk. Throws Stopped as throw_if_stopped() does.
StorageError storage_error(const std::filesystem::path& path, const SQLite::Exception& error, int system_error);

// The same for events that could not be added: StorageTrouble where the same event may be added later.
[[noreturn]] void throw_write_error(const std::filesystem::path& path, const SQLite::Exception& error,
                                    int system_error);
// SQLITE_IOERR and its kin.
bool is_disk_error(const SQLite::Exception& error) noexcept;
// SQLITE_FULL: also where a quota or a limit of size ends the writing.
bool is_full(const SQLite::Exception& error) noexcept;

// Runs `action` and gives SQLite's errors as StorageError.
template <typename Action>
decltype(auto) with_storage_errors(const std::filesystem::path& path, Action&& action) {
  try {
    return action();
  } catch (const SQLite::Exception& error) {
    throw storage_error(path, error, errno);
  }
}

}  // namespace jnd
