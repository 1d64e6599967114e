// Where a session's events go. The engine knows only this seam: a study file, memory, or a log that fails on demand.
#pragma once

#include <cstdint>
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

// Thread rule: one session's log is used by one thread; logs of several sessions may be used at the same time.
class SessionLog {
 public:
  virtual ~SessionLog() = default;
  // One transaction, committed when this returns. Throws StorageError; then nothing was written.
  virtual void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) = 0;
  // All events so far, in order: what a resumed session replays.
  virtual std::vector<Event> events() const = 0;
};

// Keeps events in memory: for counts without a study, and for tests.
class MemoryLog final : public SessionLog {
 public:
  void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) override;
  std::vector<Event> events() const override { return events_; }

 private:
  std::vector<Event> events_;
};

}  // namespace jnd
