// A study whose file is taken away while it is written to: what it holds goes into a new file beside it, whole and
// verified, before anything else happens.
#include <numeric>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include "analysis/numerics/stop_request.h"
#include "data/copies/backup.h"
#include "data/copies/rescued_copy.h"
#include "data/files/descriptor.h"
#include "data/files/left_beside.h"
#include "data/study/study_impl.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

// Pages of the log stay in memory until they are in the file, so that even a log that was cut off loses nothing: more
// than a log grows to before it is put into the file.
constexpr const char* kCache = "PRAGMA cache_size = -65536";  // kB, taken as it is needed

// The first that is free.
fs::path free_name_beside(const fs::path& study) {
  for (int n = 1;; ++n) {
    fs::path name = rescued_name(study, n);
    std::error_code ignored;
    if (!fs::exists(fs::symlink_status(name, ignored)) && !left_beside(name)) return name;
  }
}

std::int64_t count_events(SQLite::Database& database) {
  return database.execAndGet("SELECT count(*) FROM event").getInt64();
}

// Of chains without a gap.
std::int64_t length_of(const std::map<std::string, ChainEnd>& ends) {
  return std::accumulate(ends.begin(), ends.end(), std::int64_t{0},
                         [](std::int64_t sum, const auto& one) { return sum + one.second.seq; });
}

// Whether every chain ends there as it does here, with no more gaps than it has here.
bool same_ends(SQLite::Database& database, const std::map<std::string, ChainEnd>& ends, std::int64_t gaps) {
  SQLite::Statement last(database, "SELECT hash FROM event WHERE session = ? AND seq = ?");
  for (const auto& [session, end] : ends) {
    last.bind(1, session);
    last.bind(2, end.seq);
    if (!last.executeStep() || last.getColumn(0).getString() != end.hash) return false;
    last.reset();
  }
  return count_events(database) == length_of(ends) - gaps;
}

void write_image(const StudyImage& image, const NewFile& file) {
  const int made = ::open(file.made().c_str(), O_WRONLY | O_CLOEXEC);
  const int error = made < 0 ? errno : image.write_to(made);
  if (made >= 0) ::close(made);
  if (error != 0) throw cannot_write(file.path(), error);
}

}  // namespace

void Study::Impl::begin_writing() {
  jnd::begin_writing(*connection);
  connection->exec(kCache);
  connection->exec("PRAGMA wal_autocheckpoint = 0");   // shorten_log() does it
  gaps = length_of(ends) - count_events(*connection);  // opens the log, too
  // One that a killed program left goes into the file: its pages are not in the memory that makes good a log cut off.
  // Where a reader is in the way it stays.
  std::error_code none;
  if (const auto size = fs::file_size(lock->place().string() + "-wal", none); !none && size > 0)
    SQLite::Statement(*connection, "PRAGMA wal_checkpoint(TRUNCATE)").executeStep();
  files = std::make_unique<StudyFiles>(lock->place(), lock->descriptor());
  const bool was_normal = synchronous_normal;
  synchronous_normal = false;
  disk_failed = false;
  if (was_normal) set_durability(SessionKind::simulated);
  if (people) files->keep_image();
}

void Study::Impl::require_in_place() {
  const auto to_try_again = [this](const std::string& what_happened) {
    return StorageTrouble(what_happened + (back ? " Try again"
                                                : " Put back what was taken away and try again, or just try again: "
                                                  "then it goes on in that new file"));
  };
  if (!untold.empty()) throw to_try_again(std::exchange(untold, {}));
  if (former) choose_file();
  if (!files) return;
  const StudyFiles::State state = files->look(*connection);
  if (state == StudyFiles::State::in_place) return;
  if (state == StudyFiles::State::unseen)
    throw StorageTrouble(
        fmt::format("{}: this event is not saved, all earlier ones are. See to the disk or the folder and try again",
                    files->in_words(state)));
  const std::string what_happened =
      rescue(state, "This event is not saved, and what was saved could not be put into another file");
  throw to_try_again(what_happened);
}

bool Study::Impl::confirm_written() {
  if (!files) return false;
  const StudyFiles::State state = files->look(*connection);
  if (state == StudyFiles::State::in_place) return true;
  if (state == StudyFiles::State::unseen) return false;  // which is told before the next event
  try {
    untold = rescue(state,
                    "This event and all before it are saved in what was taken away, but could not be put into another "
                    "file");
  } catch (const StorageTrouble& trouble) {
    throw StorageError(trouble.what());  // the event is written: it must not be added once more
  }
  return true;
}

std::string Study::Impl::rescue(StudyFiles::State state, const char* fate) {
  // Of what was damaged nothing must come into the file, also where this fails and is given up.
  if (state == StudyFiles::State::log_cut || state == StudyFiles::State::file_cut)
    sqlite3_db_config(connection->getHandle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  const std::string what = fmt::format("While the session was writing to the study, {}", files->in_words(state));
  const auto hopeless = [&](const std::string& why) {
    return StorageTrouble(
        fmt::format("{}. {} ({}). Put back what was taken away, or see to that, and try again", what, fate, why));
  };
  fs::path place = lock->place();
  if (std::error_code ignored; !fs::is_directory(place.parent_path(), ignored)) place = files->whereabouts();
  if (place.empty()) throw hopeless("its folder is gone too: make it again");
  const fs::path to = free_name_beside(place);
  try {
    NewFile file(to);
    if (state == StudyFiles::State::file_cut && files->image() != nullptr)
      write_image(*files->image(), file);
    else
      copy_into(file, *connection, path);
    BackupReport copy;
    try {
      copy = finish_copy(file);
    } catch (const Stopped&) {
      // The program was asked to end: the copy is whole, and must not be lost because there is no time to verify it.
    }
    if (!copy.written) {
      // What verification finds may have been in the study before; what counts now is that every event is there.
      // Not by open_database(), whose statements end where the program was asked to.
      const bool whole = with_storage_errors(file.made(), [&] {
        SQLite::Database made(file.made().string(), SQLite::OPEN_READONLY);
        return same_ends(made, ends, gaps);
      });
      if (!whole) {
        std::string why = "it cannot be read any more";
        if (!copy.verified.problems.empty()) {
          const Problem& first = copy.verified.problems.front();
          why += ": " + (first.reveals == Reveals::nothing ? first.text : first.where);
        }
        throw hopeless(why);
      }
      file.publish();
    }
  } catch (const StorageTrouble&) {
    throw;
  } catch (const StorageError& error) {
    throw hopeless(error.what());
  } catch (const fs::filesystem_error& error) {
    throw hopeless(error.what());
  }
  auto rescued_lock = std::make_unique<StudyLock>(to);
  auto rescued = open_database(to, true);
  forget_statements();
  const bool in_study = files->leave(connection, state);
  back = in_study && (state == StudyFiles::State::log_removed || state == StudyFiles::State::log_replaced);
  if (state != StudyFiles::State::file_cut) former = std::make_unique<Former>(Former{path, std::move(lock)});
  path = to;
  lock = std::move(rescued_lock);
  connection = std::move(rescued);
  with_storage_errors(path, [&] { begin_writing(); });
  return fmt::format("{}. All that was saved is now in {}{}.", what, to.string(),
                     back ? ", and in the study again" : "");
}

void Study::Impl::choose_file() {
  const std::unique_ptr<Former> before = std::move(former);
  if (!is_at(before->lock->place(), before->lock->descriptor(), Links::followed)) return;
  std::unique_ptr<SQLite::Database> database;
  try {
    database = open_database(before->path, true);
    if (!with_storage_errors(before->path, [&] { return same_ends(*database, ends, gaps); })) return;
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
