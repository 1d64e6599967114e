// The inside of a Study, shared by the files of this room: the connection, its mutex, and where each chain ends.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

#include "data/database.h"
#include "data/study.h"
#include "data/study_lock.h"

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
  std::int64_t row = 0;  // rowid of the completion
  std::string session;
  std::int64_t seq = 0;         // of the completion
  std::int64_t voided_seq = 0;  // of the trial.voided
  bool practice = false;
};
// By row. Of files of every version; voids are few, so that this costs next to nothing beside reading the trials.
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
  bool relaxed = false;                     // synchronous=NORMAL just now
  bool shaken = false;  // the disk failed: what it flushed before may not be what it holds (see write())

  // The connection; throws StorageError after close(). Call with the mutex held, as all below.
  SQLite::Database& database() const;
  void require_writable() const;
  void read_info();
  void read_ends();
  // Runs what adds events, in a transaction of its own or in autocommit. Where it fails for a reason that may pass
  // (StorageTrouble: full, an error of the disk, another program's lock) nothing was written, no transaction is open,
  // and it can be run again. `ends` must be put back by the caller where it was changed before the failure.
  template <typename Action>
  void write(Action&& action);
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
  std::vector<Event> events(const std::string& session) const;
  std::vector<TelemetryBlob> telemetry(const std::string& session, std::int64_t seq) const;
  std::vector<SessionInfo> sessions() const;
  void close();

 private:
  void steady();
  void tidy_after_failure() const;
};

template <typename Action>
void Study::Impl::write(Action&& action) {
  try {
    steady();
    action();
  } catch (const SQLite::Exception& error) {
    tidy_after_failure();
    shaken = shaken || is_disk_error(error);
    throw_write_error(path, error);
  } catch (...) {
    tidy_after_failure();
    throw;
  }
}

}  // namespace jnd
