#include "data/verify_telemetry.h"

#include <algorithm>

#include <fmt/format.h>

#include "data/body_numbers.h"
#include "data/database.h"
#include "data/event_body.h"
#include "data/schema.h"
#include "data/study_impl.h"
#include "data/telemetry.h"
#include "protocols/sha256.h"

namespace jnd {

namespace {

// What is wrong with a stored blob, in words; empty where nothing is.
std::string fault_of(const TelemetryBlob& stored, const TelemetryBlob& named) {
  if (sha256_hex(stored.bytes) != named.sha256) return "was changed: its SHA-256 is not the one in the event";
  if (stored.sha256 != named.sha256 || stored.ticks != named.ticks || stored.dropped != named.dropped)
    return "has a SHA-256, ticks or dropped beside it that contradict the event";
  try {
    const Telemetry read = decode_telemetry(stored.bytes);
    if (static_cast<std::int64_t>(read.ticks.size()) != named.ticks || read.dropped != named.dropped)
      return fmt::format("holds {} ticks and {} dropped ones; the event says {} and {}", read.ticks.size(),
                         read.dropped, named.ticks, named.dropped);
  } catch (const StorageError& error) {
    return error.what();
  }
  return {};
}

std::set<std::string> lost_of(SQLite::Database& database) {
  std::set<std::string> lost;
  SQLite::Statement query(database, "SELECT body FROM event WHERE session = ? AND kind = ?");
  query.bind(1, kStudyChain);
  query.bind(2, std::string(event_kind::kRecovered));
  while (query.executeStep()) {
    const auto body = nlohmann::ordered_json::parse(query.getColumn(0).getString(), nullptr, false);
    if (!body.is_object() || !body.contains("telemetry_lost")) continue;
    try {
      for (const auto& one : body.at("telemetry_lost"))
        lost.insert(telemetry_key(one.at("session").get<std::string>(), whole_at<std::int64_t>(one, "seq"),
                                  whole_at(one, "interval")));
    } catch (const nlohmann::json::exception&) {
      continue;  // nothing is forgiven by what cannot be read
    }
  }
  return lost;
}

}  // namespace

std::string telemetry_key(std::string_view session, std::int64_t seq, int interval) {
  return fmt::format("{}/{}/{}", session, seq, interval);
}

std::set<std::string> lost_in_recovery(const Study& study) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  return with_storage_errors(impl.path, [&] { return lost_of(impl.database()); });
}

TelemetryCheck::TelemetryCheck(SQLite::Database& database)
    : database_(database), present_(has_telemetry(database)), lost_(lost_of(database)) {}

void TelemetryCheck::check(const Event& event, const nlohmann::ordered_json& body, std::vector<std::string>& problems) {
  const std::vector<TelemetryBlob> named = named_telemetry(body);
  if (named.empty()) return;
  for (const TelemetryBlob& one : named) {
    const auto problem = [&](std::string_view what) {
      problems.push_back(fmt::format("Session {}, event {} ({}): the telemetry of interval {} {}.", event.session,
                                     event.seq, event.kind, one.interval + 1, what));
    };
    named_.push_back(telemetry_key(event.session, event.seq, one.interval));
    if (!present_) {
      problem("is missing");
      continue;
    }
    SQLite::Statement query(
        database_,
        "SELECT sha256, ticks, dropped, bytes FROM telemetry WHERE session = ? AND seq = ? AND interval = ?");
    query.bind(1, event.session);
    query.bind(2, event.seq);
    query.bind(3, one.interval);
    if (!query.executeStep()) {
      if (!lost_.contains(named_.back())) problem("is missing");
      continue;
    }
    ++blobs_;
    const TelemetryBlob stored{one.interval, query.getColumn(0).getString(), query.getColumn(1).getInt64(),
                               query.getColumn(2).getInt64(), query.getColumn(3).getString()};
    if (const std::string fault = fault_of(stored, one); !fault.empty()) problem(fault);
  }
}

void TelemetryCheck::finish(std::vector<std::string>& problems) {
  if (!present_) return;
  std::sort(named_.begin(), named_.end());
  SQLite::Statement query(database_, "SELECT session, seq, interval FROM telemetry ORDER BY session, seq, interval");
  while (query.executeStep()) {
    const std::string session = query.getColumn(0).getString();
    const std::int64_t seq = query.getColumn(1).getInt64();
    const int interval = query.getColumn(2).getInt();
    if (!std::binary_search(named_.begin(), named_.end(), telemetry_key(session, seq, interval)))
      problems.push_back(
          fmt::format("Session {}, event {}: there is telemetry of interval {} that the event does not name.", session,
                      seq, interval + 1));
  }
}

}  // namespace jnd
