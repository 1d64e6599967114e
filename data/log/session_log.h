// Where a session's events go. The engine knows only this seam: a study file, memory, or a log that fails on demand.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace jnd {

struct Stamp {
  std::int64_t utc_ns = 0;        // since 1970-01-01T00:00:00Z
  std::int64_t monotonic_ns = 0;  // of the machine's (or the simulation's) monotonic clock
};

struct Event {
  std::string session;
  std::int64_t seq = 0;  // from 1 in each session
  std::string kind;      // data/README.md lists them
  Stamp stamp;
  std::string version;  // of the program that wrote it
  std::string body;     // JSON text as stored
  std::string hash;     // SHA-256, 64 hexadecimal digits
};

// The ticks of one interval as they are stored beside an event. data/log/telemetry.h makes and reads them.
struct TelemetryBlob {
  int interval = 0;          // 0, 1 or 2
  std::string sha256;        // of bytes, 64 lower-case hexadecimal digits
  std::int64_t ticks = 0;    // records in it
  std::int64_t dropped = 0;  // records that were lost before they could be kept
  std::string bytes;         // compressed
  bool operator==(const TelemetryBlob&) const = default;
};

// Thread rule: one session's log is used by one thread; logs of several sessions may be used at the same time.
class SessionLog {
 public:
  virtual ~SessionLog() = default;
  // One transaction, committed when this returns. Throws StorageError; then nothing was written.
  virtual void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) = 0;
  // The same with the ticks that belong to the event, in the same transaction. body["telemetry"] must be
  // telemetry_body(telemetry), so that the hash of the event covers the blobs. A log that keeps no telemetry keeps the
  // event.
  virtual void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp,
                      const std::vector<TelemetryBlob>& telemetry);
  // One transaction that is not flushed: it survives the end of the program, not a power cut, until the next append.
  // For marks whose loss costs no answer (trial.began), so that a trial costs one flush.
  virtual void mark(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) {
    append(kind, body, stamp);
  }
  // All events so far, in order: what a resumed session replays.
  virtual std::vector<Event> events() const = 0;
};

// Keeps events in memory: for counts without a study, and for tests.
class MemoryLog final : public SessionLog {
 public:
  void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) override;
  void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp,
              const std::vector<TelemetryBlob>& telemetry) override;
  std::vector<Event> events() const override { return events_; }
  // Of the event `seq`; empty where it has none.
  std::vector<TelemetryBlob> telemetry(std::int64_t seq) const;

 private:
  std::vector<Event> events_;
  std::map<std::int64_t, std::vector<TelemetryBlob>> telemetry_;  // by seq
};

// Throws StorageError where body["telemetry"] does not name exactly these blobs: a hash that no event carries protects
// nothing.
void require_named(const nlohmann::ordered_json& body, const std::vector<TelemetryBlob>& telemetry);

}  // namespace jnd
