// Telemetry of a study: stored in one transaction with the event it belongs to, and read back.
#include <climits>

#include <fmt/format.h>

#include "data/study/study_impl.h"

namespace jnd {

void Study::Impl::append(const std::string& session, std::string_view kind, const std::string& body, Stamp stamp,
                         const std::vector<TelemetryBlob>& telemetry) {
  if (telemetry.empty()) return append(session, kind, body, stamp);
  if (!insert_telemetry)
    insert_telemetry = std::make_unique<SQLite::Statement>(
        database(),
        "INSERT INTO telemetry (session, seq, interval, sha256, ticks, dropped, bytes) VALUES (?, ?, ?, ?, "
        "?, ?, ?)");
  const ChainEnd before = ends.at(session);
  try {
    SQLite::Transaction transaction(database(), SQLite::TransactionBehavior::IMMEDIATE);
    append(session, kind, body, stamp);
    for (const TelemetryBlob& blob : telemetry) {
      if (blob.bytes.size() > INT_MAX) throw StorageError(fmt::format("{}: telemetry is too large", path.string()));
      insert_telemetry->bindNoCopy(1, session);
      insert_telemetry->bind(2, ends.at(session).seq);
      insert_telemetry->bind(3, blob.interval);
      insert_telemetry->bindNoCopy(4, blob.sha256);
      insert_telemetry->bind(5, blob.ticks);
      insert_telemetry->bind(6, blob.dropped);
      insert_telemetry->bindNoCopy(7, blob.bytes.data(), static_cast<int>(blob.bytes.size()));
      insert_row(*insert_telemetry, path);
      insert_telemetry->reset();
    }
    insert_telemetry->clearBindings();
    transaction.commit();
  } catch (...) {
    insert_telemetry->tryReset();
    insert_telemetry->clearBindings();
    ends.at(session) = before;
    throw;
  }
}

std::vector<TelemetryBlob> Study::Impl::telemetry(const std::string& session, std::int64_t seq) const {
  return with_storage_errors(path, [&] {
    std::vector<TelemetryBlob> blobs;
    if (!has_telemetry(database())) return blobs;
    SQLite::Statement query(database(),
                            "SELECT interval, sha256, ticks, dropped, bytes FROM telemetry WHERE session = ? AND seq = "
                            "? ORDER BY interval");
    query.bind(1, session);
    query.bind(2, seq);
    while (query.executeStep())
      blobs.push_back({query.getColumn(0).getInt(), query.getColumn(1).getString(), query.getColumn(2).getInt64(),
                       query.getColumn(3).getInt64(), query.getColumn(4).getString()});
    return blobs;
  });
}

}  // namespace jnd
