// The telemetry of a study against what its events say of it. Internal to this room.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>
#include <nlohmann/json.hpp>

#include "data/study.h"

namespace jnd {

// What names the ticks of one interval in a study: "session/seq/interval".
std::string telemetry_key(std::string_view session, std::int64_t seq, int interval);

// What a damaged study had already lost when it was recovered is known, and no problem of the new one.
std::set<std::string> lost_in_recovery(const Study& study);

class TelemetryCheck {
 public:
  explicit TelemetryCheck(SQLite::Database& database);

  // For every event, in the order of session and seq: recomputes the hash of each blob that its body names, and reads
  // it. Throws StorageError where the body's "telemetry" cannot be read.
  void check(const Event& event, const nlohmann::ordered_json& body, std::vector<std::string>& problems);
  // At the end: the blobs that no event names.
  void finish(std::vector<std::string>& problems);

  std::int64_t blobs() const noexcept { return blobs_; }

 private:
  SQLite::Database& database_;
  bool present_;                // the table: files of version 1 have none
  std::set<std::string> lost_;  // keys: study.recovered says that they could not be saved
  std::int64_t blobs_ = 0;
  std::vector<std::string> named_;  // keys
};

}  // namespace jnd
