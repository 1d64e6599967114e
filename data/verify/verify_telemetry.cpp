#include "data/verify/verify_telemetry.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "data/log/telemetry.h"
#include "data/log/trace_blob.h"
#include "data/study/study_facts.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

// How many records a blob has, and how many were lost before.
std::pair<std::int64_t, std::int64_t> held_by(const std::string& bytes) {
  if (is_trace(bytes)) {
    const Trace trace = decode_trace(bytes);
    return {static_cast<std::int64_t>(trace.samples.size()), trace.dropped};
  }
  const Telemetry telemetry = decode_telemetry(bytes);
  return {static_cast<std::int64_t>(telemetry.ticks.size()), telemetry.dropped};
}

// What is wrong with a stored blob, in words; empty where nothing is.
std::string fault_of(const TelemetryBlob& stored, const TelemetryBlob& named) {
  if (sha256_hex(stored.bytes) != named.sha256) return "was changed: its SHA-256 is not the one in the event";
  if (stored.sha256 != named.sha256 || stored.ticks != named.ticks || stored.dropped != named.dropped)
    return "has a SHA-256, ticks or dropped beside it that contradict the event";
  try {
    const auto [ticks, dropped] = held_by(stored.bytes);
    if (ticks != named.ticks || dropped != named.dropped)
      return fmt::format("holds {} ticks and {} dropped ones; the event says {} and {}", ticks, dropped, named.ticks,
                         named.dropped);
  } catch (const StorageError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TelemetryCheck::TelemetryCheck(SQLite::Database& database, const std::set<std::string>& lost)
    : database_(database), lost_(lost) {}

void TelemetryCheck::check(const Event& event, const nlohmann::ordered_json& body, std::vector<Problem>& problems) {
  const std::vector<TelemetryBlob> named = named_telemetry(body);
  if (named.empty()) return;
  for (const TelemetryBlob& one : named) {
    const auto problem = [&](std::string_view what) {
      const std::string where = fmt::format("Session {}, event {} ({})", event.session, event.seq, event.kind);
      problems.push_back({where, fmt::format("{}: the telemetry of interval {} {}.", where, one.interval + 1, what),
                          Reveals::nothing});
    };
    named_.push_back(telemetry_key(event.session, event.seq, one.interval));
    SQLite::Statement query(
        database_,
        "SELECT sha256, ticks, dropped, bytes FROM telemetry WHERE session = ? AND seq = ? AND interval = ?");
    query.bind(1, event.session);
    query.bind(2, event.seq);
    query.bind(3, one.interval);
    if (!query.executeStep()) {
      if (lost_.contains(named_.back()))
        ++missing_;
      else
        problem("is missing");
      continue;
    }
    ++blobs_;
    const TelemetryBlob stored{one.interval, query.getColumn(0).getString(), query.getColumn(1).getInt64(),
                               query.getColumn(2).getInt64(), query.getColumn(3).getString()};
    if (const std::string fault = fault_of(stored, one); !fault.empty()) problem(fault);
  }
}

void TelemetryCheck::finish(std::vector<Problem>& problems) {
  std::sort(named_.begin(), named_.end());
  SQLite::Statement query(database_, "SELECT session, seq, interval FROM telemetry ORDER BY session, seq, interval");
  while (query.executeStep()) {
    const std::string session = query.getColumn(0).getString();
    const std::int64_t seq = query.getColumn(1).getInt64();
    const int interval = query.getColumn(2).getInt();
    if (std::binary_search(named_.begin(), named_.end(), telemetry_key(session, seq, interval))) continue;
    const std::string where = fmt::format("Session {}, event {}", session, seq);
    problems.push_back(
        {where, fmt::format("{}: there is telemetry of interval {} that the event does not name.", where, interval + 1),
         Reveals::nothing});
  }
}

}  // namespace jnd
