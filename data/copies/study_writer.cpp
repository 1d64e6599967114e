#include "data/copies/study_writer.h"

#include <climits>

#include <fmt/format.h>

#include "data/log/chain.h"
#include "data/log/event_body.h"
#include "data/log/utc_time.h"
#include "data/study/database.h"
#include "data/study/schema.h"
#include "data/verify/verify.h"
#include "protocols/version.h"

namespace jnd {

namespace {

void bind_blob(SQLite::Statement& statement, int place, const std::string& bytes) {
  if (bytes.size() > INT_MAX) throw StorageError("a blob of more than 2 GB cannot be stored");
  statement.bindNoCopy(place, bytes.data(), static_cast<int>(bytes.size()));
}

}  // namespace

StudyWriter::StudyWriter(const std::filesystem::path& path) : file_(path), database_(create_database(file_.made())) {
  with_storage_errors(path, [&] {
    transaction_ = std::make_unique<SQLite::Transaction>(*database_);
    insert_event_ = std::make_unique<SQLite::Statement>(
        *database_,
        "INSERT INTO event (session, seq, kind, utc, monotonic_ns, version, body, hash) VALUES (?, ?, ?, ?, ?, ?, ?, "
        "?)");
    insert_telemetry_ = std::make_unique<SQLite::Statement>(
        *database_,
        "INSERT INTO telemetry (session, seq, interval, sha256, ticks, dropped, bytes) VALUES (?, ?, ?, ?, ?, ?, ?)");
  });
}

void StudyWriter::begin(const StudyInfo& info, Stamp stamp) {
  keep_protocol(info.protocol_sha256, info.protocol_name, info.protocol_bytes);
  with_storage_errors(file_.path(), [&] {
    SQLite::Statement study(*database_, "INSERT INTO study (id, seed, protocol) VALUES (1, ?, ?)");
    study.bind(1, std::to_string(info.seed));
    study.bind(2, info.protocol_sha256);
    insert_row(study, file_.path());
  });
  append(event_kind::kStudyCreated,
         {{"seed", std::to_string(info.seed)},
          {"protocol_sha256", info.protocol_sha256},
          {"protocol_name", info.protocol_name}},
         stamp);
}

void StudyWriter::keep_protocol(const std::string& sha256, const std::string& name, const std::string& bytes) {
  with_storage_errors(file_.path(), [&] {
    SQLite::Statement protocol(*database_, "INSERT INTO protocol (sha256, name, bytes) VALUES (?, ?, ?)");
    protocol.bind(1, sha256);
    protocol.bind(2, name);
    bind_blob(protocol, 3, bytes);
    insert_row(protocol, file_.path());
  });
}

void StudyWriter::append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) {
  Event event;
  event.session = kStudyChain;
  event.seq = ++own_events_;
  event.kind = kind;
  event.stamp = stamp;
  event.version = kVersion;
  event.body = body_text(body);
  const std::string utc = to_iso8601(stamp.utc_ns);
  event.hash = event_hash(heads_[event.session], event, utc);
  insert(event, utc);
}

void StudyWriter::copy(const StoredEvent& stored, const std::vector<TelemetryBlob>& telemetry) {
  const Event& event = stored.event;
  if (event.session == kStudyChain || event_hash(heads_[event.session], event, stored.utc) != event.hash)
    throw StorageError(
        fmt::format("session {}, event {}: does not follow from the event before it", event.session, event.seq));
  insert(event, stored.utc);
  with_storage_errors(file_.path(), [&] {
    for (const TelemetryBlob& blob : telemetry) {
      insert_telemetry_->bindNoCopy(1, event.session);
      insert_telemetry_->bind(2, event.seq);
      insert_telemetry_->bind(3, blob.interval);
      insert_telemetry_->bindNoCopy(4, blob.sha256);
      insert_telemetry_->bind(5, blob.ticks);
      insert_telemetry_->bind(6, blob.dropped);
      bind_blob(*insert_telemetry_, 7, blob.bytes);
      insert_row(*insert_telemetry_, file_.path());
      insert_telemetry_->reset();
    }
    insert_telemetry_->clearBindings();
  });
}

void StudyWriter::insert(const Event& event, const std::string& utc) {
  with_storage_errors(file_.path(), [&] {
    insert_event_->bindNoCopy(1, event.session);
    insert_event_->bind(2, event.seq);
    insert_event_->bindNoCopy(3, event.kind);
    insert_event_->bindNoCopy(4, utc);
    insert_event_->bind(5, event.stamp.monotonic_ns);
    insert_event_->bindNoCopy(6, event.version);
    insert_event_->bindNoCopy(7, event.body);
    insert_event_->bindNoCopy(8, event.hash);
    insert_row(*insert_event_, file_.path());
    insert_event_->reset();
    insert_event_->clearBindings();
  });
  heads_[event.session] = event.hash;
}

VerifyReport StudyWriter::finish(Problems problems) {
  with_storage_errors(file_.path(), [&] {
    transaction_->commit();
    transaction_.reset();
    insert_event_.reset();
    insert_telemetry_.reset();
    database_.reset();
  });
  VerifyReport report = verify(*Study::open(file_.made(), Study::Access::read_only));
  if (!report.problems.empty() && problems == Problems::refused) {
    throw StorageError(fmt::format("{}: was not made: verification finds {} problem{} in it; verify the sources",
                                   file_.path().string(), report.problems.size(),
                                   report.problems.size() == 1 ? "" : "s"));
  }
  file_.publish();
  return report;
}

nlohmann::ordered_json kept_event(const StoredEvent& stored) {
  const Event& event = stored.event;
  return {
      {"seq", event.seq},         {"kind", event.kind}, {"utc", stored.utc}, {"monotonic_ns", event.stamp.monotonic_ns},
      {"version", event.version}, {"body", event.body}, {"hash", event.hash}};
}

bool is_imported(std::string_view kind) noexcept {
  return kind != event_kind::kStudyCreated && kind != event_kind::kSessionClosed;
}

}  // namespace jnd
