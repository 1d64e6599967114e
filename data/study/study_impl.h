// The inside of a Study, shared by the files of this room: the connection, its mutex, and where each chain ends.
#pragma once

#include <cerrno>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

#include "data/files/study_files.h"
#include "data/study/database.h"
#include "data/study/study.h"
#include "data/study/study_lock.h"

namespace jnd {

// The last event of a chain, and what its session.opened says.
struct ChainEnd {
  std::int64_t seq = 0;
  std::string hash;  // empty before the first event
  bool closed = false;
  std::string participant;
  int participant_number = 0;
  int number = 1;  // which of the participant's sessions
  SessionKind kind = SessionKind::simulated;
};

// Codes of one kind of session stand for one participant.
using ParticipantKey = std::pair<SessionKind, std::string>;

// An answer that was taken back: its completion is followed by a trial.voided of the same attempt.
struct TakenBack {
  std::string session;
  std::int64_t seq = 0;         // of the completion
  std::int64_t voided_seq = 0;  // of the trial.voided
  bool practice = false;
};
// By session and seq, without the views. Voids are few, so that this costs next to nothing beside reading the trials.
std::vector<TakenBack> taken_back(SQLite::Database& database);
// Who was left out, and whether the number is free again.
std::map<ParticipantKey, bool> excluded_participants(SQLite::Database& database);

struct Study::Impl {
  std::filesystem::path path;
  StudyInfo info;
  mutable std::mutex mutex;         // guards everything below
  std::unique_ptr<StudyLock> lock;  // for writing only; outlives the connection
  std::unique_ptr<SQLite::Database> connection;
  std::unique_ptr<SQLite::Statement> insert, insert_telemetry;
  std::map<std::string, ChainEnd> ends;     // for writing only
  std::map<ParticipantKey, bool> excluded;  // for writing only: whether the number is free again
  bool people = false;                      // a real or pilot session was opened: synchronous=FULL for good
  bool synchronous_normal = false;          // synchronous=NORMAL just now
  std::unique_ptr<StudyFiles> files;        // for writing only
  struct Former {
    std::filesystem::path path;
    std::unique_ptr<StudyLock> lock;
  };
  std::unique_ptr<Former> former;  // after a rescue, until it is known which file the study goes on in
  std::string untold;              // of a rescue after an event was written
  bool back = false;               // of the last rescue: only the log was gone, and the study itself holds all again
  std::int64_t gaps = 0;           // events that the chains lacked when it was opened for writing
  bool disk_failed = false;        // the disk failed: what it flushed before may not be what it holds (see write())
  bool write_failed = false;       // the disk did not take the last event, which its writer was told

  // The connection; throws StorageError after close(). Call with the mutex held, as all below.
  SQLite::Database& database() const;
  void require_writable() const;
  void read_info();
  void read_ends();
  void fill_new(Stamp stamp);
  // Once the study is open for writing. Keeps synchronous as it was.
  void begin_writing();
  // Runs what adds events, in a transaction of its own or in autocommit. Where it fails for a reason that may pass
  // (StorageTrouble: full, an error of the disk, another program's lock) nothing was written, no transaction is open,
  // and it can be run again. The study is looked for before and after: what returns is in a file that can be found.
  // `ends` must be put back by the caller where it was changed and nothing was committed. What is in the log goes into
  // the study where there is much of it; not after a mark, because that would flush, and a flush that fails unseen would
  // leave a hole in the log before the answers that follow.
  template <typename Action>
  void write(Action&& action, bool mark = false);
  // Within write(): one event, committed unless a transaction is open.
  void append(const std::string& session, std::string_view kind, const std::string& body, Stamp stamp);
  // In one transaction with the event's telemetry.
  void append(const std::string& session, std::string_view kind, const std::string& body, Stamp stamp,
              const std::vector<TelemetryBlob>& telemetry);
  // Without a flush.
  void append_mark(const std::string& session, std::string_view kind, const std::string& body, Stamp stamp);
  void add_study_event(std::string_view kind, const std::string& body, Stamp stamp);
  void set_durability(SessionKind kind);
  void synchronize(bool full);
  void shorten_log() const;
  std::vector<Event> events(const std::string& session) const;
  std::vector<TelemetryBlob> telemetry(const std::string& session, std::int64_t seq) const;
  std::vector<SessionInfo> sessions() const;
  // told: nothing is said of a disk that does not let the log be taken away either.
  void close(bool told = false);

 private:
  void recover_from_disk_failure();
  void tidy_after_failure() const;
  void forget_statements();
  // Throws StorageTrouble, once for each rescue, where the study or its log is not in its place; the next time it goes
  // on: in the study's own file where that is back as it was, else in the new one.
  void require_in_place();
  // Whether the study is in its place, or else was rescued.
  bool confirm_written();
  // Copies everything into a new file beside the study, verifies it (not where the program was asked to end meanwhile),
  // and goes over to it. Returns what happened, in words; throws StorageTrouble where it cannot be done, with what that
  // means for the event that is added just now.
  std::string rescue(StudyFiles::State state, const char* fate);
  void choose_file();
};

template <typename Action>
void Study::Impl::write(Action&& action, bool mark) {
  try {
    require_in_place();
    recover_from_disk_failure();
    action();
    if (confirm_written() && !mark) shorten_log();
    write_failed = false;
  } catch (const SQLite::Exception& error) {
    const int system_error = errno;  // before the tidying calls the system again
    tidy_after_failure();
    disk_failed = disk_failed || is_disk_error(error);
    write_failed = is_disk_error(error) || is_full(error);
    throw_write_error(path, error, system_error);
  } catch (...) {
    tidy_after_failure();
    throw;
  }
}

}  // namespace jnd
