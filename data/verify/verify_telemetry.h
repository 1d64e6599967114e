// The telemetry of a study against what its events say of it. Internal to this room.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>
#include <nlohmann/json.hpp>

#include "data/study/problem.h"
#include "data/study/study.h"

namespace jnd {

class TelemetryCheck {
 public:
  // lost: keys of what a recovery could not save; must outlive this.
  TelemetryCheck(SQLite::Database& database, const std::set<std::string>& lost);

  // For every event, in the order of session and seq: recomputes the hash of each blob that its body names, and reads
  // it. Throws StorageError where the body's "telemetry" cannot be read.
  void check(const Event& event, const nlohmann::ordered_json& body, std::vector<Problem>& problems);
  // At the end: the blobs that no event names.
  void finish(std::vector<Problem>& problems);

  std::int64_t blobs() const noexcept { return blobs_; }
  std::int64_t lost() const noexcept { return missing_; }  // named, and said to be lost

 private:
  SQLite::Database& database_;
  const std::set<std::string>& lost_;
  std::int64_t blobs_ = 0, missing_ = 0;
  std::vector<std::string> named_;  // keys
};

}  // namespace jnd
