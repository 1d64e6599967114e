// A study whose file is taken away while it is written to: what it holds goes into a new file beside it, whole and
// verified, before anything else happens.
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/backup.h"
#include "data/study_impl.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

// Pages of the log stay in memory until they are in the file, so that even a log that was cut off loses nothing: more
// than a log grows to before it is put into the file.
constexpr const char* kCache = "PRAGMA cache_size = -65536";  // kB, taken as it is needed

// "study-rescued.sqlite", or the next of its kind that is free.
fs::path free_name_beside(const fs::path& study) {
  for (int n = 1;; ++n) {
    fs::path name =
        study.parent_path() /
        (study.stem().string() + (n == 1 ? "-rescued" : fmt::format("-rescued-{}", n)) + study.extension().string());
    std::error_code ignored;
    if (!fs::exists(fs::symlink_status(name, ignored))) return name;
  }
}

bool is_at(const fs::path& path, int descriptor) {
  struct stat open {
  }, found{};
  return ::fstat(descriptor, &open) == 0 && ::stat(path.c_str(), &found) == 0 && open.st_ino == found.st_ino &&
         open.st_dev == found.st_dev;
}

// Whether every chain ends there as it does here.
bool same_ends(SQLite::Database& database, const std::map<std::string, ChainEnd>& ends) {
  std::int64_t events = 0;
  SQLite::Statement last(database, "SELECT hash FROM event WHERE session = ? AND seq = ?");
  for (const auto& [session, end] : ends) {
    last.bind(1, session);
    last.bind(2, end.seq);
    if (!last.executeStep() || last.getColumn(0).getString() != end.hash) return false;
    last.reset();
    events += end.seq;
  }
  return database.execAndGet("SELECT count(*) FROM event").getInt64() == events;
}

}  // namespace

void Study::Impl::begin_writing() {
  jnd::begin_writing(*connection);
  connection->exec(kCache);
  connection->execAndGet("SELECT count(*) FROM study");  // opens the log
  files = std::make_unique<StudyFiles>(lock->place(), lock->descriptor());
  const bool was_relaxed = relaxed;
  relaxed = false;
  shaken = false;
  if (was_relaxed) set_durability(SessionKind::simulated);
}

void Study::Impl::require_in_place() {
  if (!untold.empty()) throw StorageTrouble(std::exchange(untold, {}));
  if (former) choose_file();
  if (files && files->look(*connection) != StudyFiles::State::in_place) throw StorageTrouble(rescue());
}

void Study::Impl::confirm_written() {
  if (!files || files->look(*connection) == StudyFiles::State::in_place) return;
  try {
    untold = rescue();
  } catch (const StorageTrouble& trouble) {
    throw StorageError(trouble.what());  // the event is written: it must not be added once more
  }
}

std::string Study::Impl::rescue() {
  const StudyFiles::State state = files->look(*connection);
  const std::string what = files->in_words(state);
  fs::path place = lock->place();
  if (std::error_code ignored; !fs::is_directory(place.parent_path(), ignored)) place = files->whereabouts();
  const fs::path to = free_name_beside(place);
  const auto hopeless = [&](const std::string& why) {
    return StorageTrouble(fmt::format(
        "{} while it is written to. This event is not saved, and what was saved could not be put into another "
        "file ({}). Put back what was taken away, or see to that, and try again",
        what, why));
  };
  try {
    NewFile file(to);
    copy_into(file, *connection, path);
    const BackupReport copy = finish_copy(file);
    if (!copy.written) {
      // What verification finds may have been in the study before; what counts now is that every event is there.
      const auto made = open_database(file.made(), false);
      if (!with_storage_errors(file.made(), [&] { return same_ends(*made, ends); })) {
        const Problem& first = copy.verified.problems.front();
        throw hopeless("it cannot be read any more: " +
                       (first.reveals == Problem::Reveals::nothing ? first.text : first.where));
      }
    }
    if (!copy.written) file.publish();
  } catch (const StorageTrouble&) {
    throw;
  } catch (const StorageError& error) {
    throw hopeless(error.what());
  }
  auto rescued_lock = std::make_unique<StudyLock>(to);
  auto rescued = open_database(to, true);
  forget_statements();
  files->leave(connection, state);
  former = std::make_unique<Former>(Former{path, std::move(lock)});
  path = to;
  lock = std::move(rescued_lock);
  connection = std::move(rescued);
  with_storage_errors(path, [&] { begin_writing(); });
  return fmt::format(
      "{} while it is written to. All that was saved is now in {}. Put back what was taken away and try "
      "again, "
      "or just try again: then it goes on in that new file",
      what, to.string());
}

void Study::Impl::choose_file() {
  const std::unique_ptr<Former> before = std::move(former);
  if (!is_at(before->lock->place(), before->lock->descriptor())) return;
  std::unique_ptr<SQLite::Database> database;
  try {
    database = open_database(before->path, true);
    if (!with_storage_errors(before->path, [&] { return same_ends(*database, ends); })) return;
  } catch (const StorageError&) {
    return;  // it is back, but not as it was
  }
  const fs::path rescued = path;
  forget_statements();
  with_storage_errors(path, [&] { end_writing(*connection); });
  connection = std::move(database);
  ::unlink(rescued.c_str());  // nothing was added to it
  path = before->path;
  lock = std::move(before->lock);
  with_storage_errors(path, [&] { begin_writing(); });
}

void Study::Impl::forget_statements() {
  insert.reset();
  insert_telemetry.reset();
}

}  // namespace jnd
