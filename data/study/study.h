// A study: one SQLite file that holds everything that happened. See data/README.md for the schema.
//
// One append-only table of events is the truth; trials, sessions and counts are views over it. Every event is
// committed on its own (WAL; synchronous=FULL for real and pilot sessions, NORMAL for simulated ones), and its hash
// chains over the stored bytes of the session's events before it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "data/log/session_log.h"
#include "data/log/storage_error.h"
#include "protocols/vocabulary.h"

namespace jnd {

// A seed as a study keeps it, decimal text; none where it is not a number of 64 bits.
std::optional<std::uint64_t> seed_from(std::string_view text) noexcept;

struct StudyInfo {
  std::uint64_t seed = 0;
  std::string protocol_sha256;
  std::string protocol_name;
  std::string protocol_bytes;
};

struct SessionInfo {
  std::string id;
  std::string participant;     // code: "P01"
  int participant_number = 0;  // of the plan
  int number = 1;              // which of the participant's sessions
  SessionKind kind = SessionKind::simulated;
  std::string state;      // "open" or "closed"
  std::string responder;  // "keyboard" or "profile NAME"
  int trials_done = 0;    // main trials answered
  int trials_voided = 0;
  int trials_total = 0;        // main trials planned
  std::string started, ended;  // ISO 8601 UTC; ended empty while open
  std::string head;            // hash of its last event
  std::string rig_sha256;      // of the rig's description; empty where it has none
  std::string language;        // of the participant; empty where none was chosen
  std::string group;           // of the participant; empty where the protocol has no groups
  bool ended_early = false;    // closed for good before its end: withdrawn, or without consent
  bool unblinded = false;      // its operator saw forces, at least in a part of it
  bool excluded = false;       // the participant: never analysed
  bool replaced = false;       // excluded, and the number is free again
};

// As people read it: "open", "closed, ended early", "closed, excluded", "open, unblinded".
std::string state_text(const SessionInfo& session);

struct NewSession {
  std::string id;
  std::string participant;
  int participant_number = 0;
  int number = 1;        // which of the participant's sessions
  std::string language;  // of the participant; empty: the protocol's own
  std::string group;     // of the participant; empty where the protocol has no groups
  std::string boot_id;   // of the machine's run: tells later whether the monotonic clock went on
  SessionKind kind = SessionKind::simulated;
  std::string responder;
  std::string profile_sha256;  // empty for people
  std::string rig, rig_mode, tracker;
  std::string rig_sha256;  // of the rig's description; empty where it has none
  int trials_total = 0;
  Stamp stamp;
};

// Thread rule: all members may be called from any thread (one connection behind one mutex).
class Study {
 public:
  // Creates the file; throws StorageError where it exists already or the folder cannot be written.
  static std::unique_ptr<Study> create(const std::filesystem::path& path, const std::string& protocol_name,
                                       const std::string& protocol_bytes, std::uint64_t seed, Stamp stamp);
  // Throws StorageError: missing, not a study, written by a newer program, locked by another process (for writing).
  enum class Access { read_only, read_write };
  static std::unique_ptr<Study> open(const std::filesystem::path& path, Access access);
  ~Study();

  const StudyInfo& info() const noexcept;
  // As it was named; of another file where its own was taken away and the study was rescued (data/README.md).
  std::filesystem::path path() const;
  std::vector<SessionInfo> sessions() const;  // by kind, then participant number
  std::string head() const;                   // hash of the last event of the study's own chain

  // Both logs must not outlive the study. Real sessions are refused on network file systems.
  // A new session, its session.opened event committed. Simulated and pilot sessions have numbers of their own; a
  // participant may have several sessions, each with its `number`. Refused for who was excluded.
  std::unique_ptr<SessionLog> open_session(const NewSession& session);
  // The log of a session that exists, to go on with it.
  std::unique_ptr<SessionLog> resume_session(const std::string& id);
  // Ends a session: session.closed in its chain, and its head hash into the study's chain.
  void close_session(const std::string& id, Stamp stamp);

  // Into the chain of the study itself, on the disk when this returns. data/study/study_admin.h has the usual ones.
  void add_study_event(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp);
  std::vector<Event> study_events() const;

  std::vector<Event> events(const std::string& session) const;
  // What was stored with one event, by interval; empty where there is none.
  std::vector<TelemetryBlob> telemetry(const std::string& session, std::int64_t seq) const;

  // Checkpoints the WAL away, so that the study is one file. Also done by the destructor, which cannot report.
  void close();

  struct Impl;
  Impl& impl() const noexcept { return *impl_; }

 private:
  explicit Study(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace jnd
