#include "data/copies/backup.h"

#include <algorithm>
#include <cerrno>

#include <SQLiteCpp/Backup.h>
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include "data/copies/new_file.h"
#include "data/study/schema.h"
#include "data/study/study_impl.h"
#include "data/verify/verify.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

constexpr int kPagesAtATime = 1024;  // 4 MB: how soon an interruption is noticed

// False where interrupted.
bool copy_pages(SQLite::Database& source, const fs::path& to, const std::function<bool()>& stop) {
  SQLite::Database copy(fs::absolute(to).string(), SQLite::OPEN_READWRITE);
  // A file that is thrown away unless it is finished needs no journal; it is flushed before it gets its name.
  copy.exec("PRAGMA journal_mode = OFF");
  copy.exec("PRAGMA synchronous = OFF");
  {
    // One transaction holds one view of the source, so that a session which goes on never makes the copy begin anew.
    SQLite::Transaction view(source);
    SQLite::Statement(source, "SELECT count(*) FROM study").executeStep();
    SQLite::Backup backup(copy, source);
    for (int result = SQLITE_OK; result != SQLITE_DONE;) {
      if (stop && stop()) return false;
      result = backup.executeStep(kPagesAtATime);
      if (result != SQLITE_OK && result != SQLITE_DONE) throw SQLite::Exception(copy.getHandle(), result);
    }
    view.commit();
  }
  return true;
}

// The copy of a study in use says that it has a write-ahead log; a closed study is one file.
void leave_wal_mode(const fs::path& made) {
  SQLite::Database copy(fs::absolute(made).string(), SQLite::OPEN_READWRITE);
  SQLite::Statement(copy, "PRAGMA journal_mode = DELETE").executeStep();
}

// Of an error while one file is copied into the other: what is written only fails in other ways.
bool is_of_source(const SQLite::Exception& error) {
  const int code = error.getErrorCode();
  if (code == SQLITE_IOERR_READ || code == SQLITE_IOERR_SHORT_READ) return true;
  const int primary = code & 0xFF;
  return primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB || primary == SQLITE_BUSY || primary == SQLITE_LOCKED;
}

bool has_event(const std::vector<Event>& events, const std::string& hash) {
  return std::any_of(events.begin(), events.end(), [&](const Event& event) { return event.hash == hash; });
}

// Whether all that an earlier file holds is in the study too: each of its chains is the beginning of the study's.
bool holds_all_of(const Study& study, const std::vector<Event>& own, const std::vector<SessionInfo>& sessions) {
  if (!own.empty() && !has_event(study.events(kStudyChain), own.back().hash)) return false;
  return std::all_of(sessions.begin(), sessions.end(),
                     [&](const SessionInfo& session) { return has_event(study.events(session.id), session.head); });
}

}  // namespace

Earlier judge(const Study& study, const fs::path& to) {
  std::vector<Event> own;
  std::vector<SessionInfo> sessions;
  try {
    const StudyInfo& info = study.info();
    const auto earlier = Study::open(to, Study::Access::read_only);
    if (earlier->info().seed != info.seed || earlier->info().protocol_sha256 != info.protocol_sha256)
      return Earlier::foreign;
    own = earlier->events(kStudyChain);
    sessions = earlier->sessions();
  } catch (const StorageError&) {
    return Earlier::foreign;
  }
  return holds_all_of(study, own, sessions) ? Earlier::of_this_study : Earlier::further;
}

namespace {

// A backup takes the place of an earlier one only, and of none that has something which this study lacks: that is no
// backup, but a study that sessions went on in.
void refuse_another(const Study& study, const fs::path& to) {
  if (!fs::exists(to)) return;
  const Earlier earlier = judge(study, to);
  if (earlier == Earlier::foreign)
    throw StorageError(fmt::format(
        "{}: is no backup of this study; it was not changed. Remove it yourself or choose another name", to.string()));
  if (earlier == Earlier::further)
    throw StorageError(
        fmt::format("{}: has events that this study lacks, so that it is no earlier backup; it was not changed. Look "
                    "which of the two is to be kept, and choose another name",
                    to.string()));
}

}  // namespace

BackupReport back_up(const Study& study, const fs::path& to, bool replace, const std::function<bool()>& stop) {
  const Study::Impl& impl = study.impl();
  refuse_beside(impl.path, to);
  NewFile file(to, replace);
  refuse_another(study, to);
  {
    const std::scoped_lock lock(impl.mutex);
    if (!copy_into(file, impl.database(), impl.path, stop)) {
      BackupReport interrupted;
      interrupted.interrupted = true;
      return interrupted;
    }
  }
  // Looked at once more: another program may have put something there during a long copy.
  return finish_copy(file, [&study](const fs::path& earlier) { refuse_another(study, earlier); });
}

bool copy_into(NewFile& file, SQLite::Database& source, const fs::path& path, const std::function<bool()>& stop) {
  try {
    return copy_pages(source, file.made(), stop);
  } catch (const SQLite::Exception& error) {
    const int system_error = errno;
    throw storage_error(is_of_source(error) ? path : file.path(), error, system_error);
  }
}

BackupReport finish_copy(NewFile& file, const std::function<void(const fs::path&)>& may_go) {
  BackupReport report;
  with_storage_errors(file.path(), [&] { leave_wal_mode(file.made()); });
  {
    const auto copy = Study::open(file.made(), Study::Access::read_only);
    report.verified = verify(*copy);
    if (!report.verified.problems.empty()) return report;
    report.sessions = copy->sessions();
    const std::vector<Event> own = copy->events(kStudyChain);
    if (!own.empty()) report.study_head = own.back().hash;
  }
  report.bytes = fs::file_size(file.made());
  file.publish(may_go);
  report.written = true;
  return report;
}

}  // namespace jnd
