// jnd recover: what can be read of a damaged study, to the last whole event of every chain, in a new study.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "data/study/study.h"
#include "data/verify/verify.h"

namespace jnd {

// What became of one chain.
struct RecoveredChain {
  std::string session;
  std::string participant, kind;  // empty where its first event is lost
  std::int64_t events = 0;        // recovered
  std::int64_t unchained = 0;     // found behind a lost or changed event: nothing proves them, so they were left out
  std::int64_t last_found = 0;    // the highest number of an event that was found, proved or not; 0 where none was
  std::string last_kind{};        // of the last event recovered; empty where none was
  std::string last_utc{};         // its time, ISO 8601
  std::optional<std::int64_t> trials{};  // main trials answered among the recovered events; none where not counted
  std::int64_t telemetry = 0, telemetry_lost = 0;  // of the recovered events: intervals with and without their ticks
  bool closed = false;                             // complete, up to its session.closed
  bool cut = false;                                // events are known to be missing at its end
};

struct RecoveryReport {
  std::vector<RecoveredChain> sessions;
  RecoveredChain own;               // the study's own chain: exclusions, notes, closings
  std::int64_t unreadable = 0;      // bytes that the disk did not give
  std::vector<std::string> doubts;  // what could not be taken from the file as it should
  // What the file says that it held; none where that is lost.
  std::optional<std::int64_t> pages, events_added;
  std::int64_t pages_missing = 0;
  std::int64_t events_found = 0;  // of all chains, as events_added counts them
  VerifyReport verified;          // of the new study
  bool whole() const noexcept;    // nothing is known to be lost
};

// Reads `damaged` and the write-ahead log beside it, and writes the new study `to`, where nothing was. Events, their
// times and hashes are copied to the letter; study.recovered in the study's chain says what was lost and keeps the old
// chain's events; exclusions, notes and unblindings go on to hold. A session that is not complete is open in the new
// study. The damaged file is never changed.
// protocol: a file to use where the study's own copy of its protocol is lost; it must have the SHA-256 that the events
// name. Throws StorageError: nothing of a study was found, the protocol is lost, `to` exists, or the damaged study is
// open in another process.
RecoveryReport recover(const std::filesystem::path& damaged, const std::filesystem::path& to,
                       const std::optional<std::filesystem::path>& protocol, Stamp stamp);

}  // namespace jnd
