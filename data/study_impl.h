// The inside of a Study, shared by the files of this room: the connection, its mutex, and where each chain ends.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
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
  SessionKind kind = SessionKind::simulated;
};

struct Study::Impl {
  std::filesystem::path path;
  StudyInfo info;
  mutable std::mutex mutex;         // guards everything below
  std::unique_ptr<StudyLock> lock;  // for writing only; outlives the connection
  std::unique_ptr<SQLite::Database> connection;
  std::unique_ptr<SQLite::Statement> insert, insert_telemetry;
  std::map<std::string, ChainEnd> ends;  // for writing only
  bool people = false;                   // a real or pilot session was opened: synchronous=FULL for good

  // The connection; throws StorageError after close(). Call with the mutex held, as all below.
  SQLite::Database& database() const;
  void require_writable() const;
  void read_info();
  void read_ends();
  void append(const std::string& session, std::string_view kind, const std::string& body, Stamp stamp);
  // In one transaction with the event's telemetry.
  void append(const std::string& session, std::string_view kind, const std::string& body, Stamp stamp,
              const std::vector<TelemetryBlob>& telemetry);
  void set_durability(SessionKind kind);
  std::vector<Event> events(const std::string& session) const;
  std::vector<TelemetryBlob> telemetry(const std::string& session, std::int64_t seq) const;
  std::vector<SessionInfo> sessions() const;
  void close();
};

}  // namespace jnd
