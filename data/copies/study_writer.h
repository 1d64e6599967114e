// A new study file out of events that exist already: each keeps its bytes, its times and its hash.
//
// For merge and recover. The study's own chain is written anew, because it says what became of the file; sessions are
// copied to the letter, so that heads in lab books and reports go on to hold.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>
#include <nlohmann/json.hpp>

#include "data/copies/new_file.h"
#include "data/study/study.h"
#include "data/verify/verify.h"

namespace jnd {

// An event with the text of its time, which the hash covers.
struct StoredEvent {
  Event event;
  std::string utc;
};

class StudyWriter {
 public:
  // Throws StorageError where the file exists or cannot be made.
  explicit StudyWriter(const std::filesystem::path& path);

  // First of all: protocol, seed, and study.created.
  void begin(const StudyInfo& info, Stamp stamp);
  // A protocol of other bytes that sessions name; kept beside the study's own.
  void keep_protocol(const std::string& sha256, const std::string& name, const std::string& bytes);
  // To the study's own chain.
  void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp);
  // The next event of a session, with what was stored beside it. Throws StorageError where its hash does not follow
  // from the event before it.
  void copy(const StoredEvent& stored, const std::vector<TelemetryBlob>& telemetry);
  // Verifies the whole file and gives it its name. refused: with problems it throws StorageError, and no file is
  // there.
  enum class Problems { refused, kept };
  VerifyReport finish(Problems problems);

 private:
  void insert(const Event& event, const std::string& utc);

  NewFile file_;
  std::unique_ptr<SQLite::Database> database_;
  std::unique_ptr<SQLite::Transaction> transaction_;
  std::unique_ptr<SQLite::Statement> insert_event_, insert_telemetry_;
  std::map<std::string, std::string> heads_;  // by session: hash of the last event
  std::int64_t own_events_ = 0;               // of the study's chain
};

// An event as the body of another one keeps it: {seq, kind, utc, monotonic_ns, version, body (the text), hash}.
nlohmann::ordered_json kept_event(const StoredEvent& stored);

// Whether such an event of a study's own chain goes on to hold and is appended to the new chain too: exclusions, notes,
// unblindings and what later programs add. Only a study's creation and the closings of its sessions are written anew.
bool is_imported(std::string_view kind) noexcept;

}  // namespace jnd
