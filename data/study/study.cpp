#include "data/study/study.h"

#include <charconv>
#include <climits>
#include <cstdio>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <sqlite3.h>

#include "data/files/draft.h"
#include "data/files/left_beside.h"
#include "data/log/chain.h"
#include "data/log/event_body.h"
#include "data/log/utc_time.h"
#include "data/study/new_session.h"
#include "data/study/schema.h"
#include "data/study/study_facts.h"
#include "data/study/study_impl.h"
#include "protocols/input/sha256.h"
#include "protocols/version.h"

namespace jnd {

std::optional<std::uint64_t> seed_from(std::string_view text) noexcept {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return seed;
}

Study::Study(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Study::~Study() {
  try {
    const std::scoped_lock lock(impl_->mutex);
    impl_->close(impl_->write_failed);
  } catch (const std::exception& error) {
    // Everything acknowledged is committed; the next opening replays the write-ahead log. But it may be in a new file
    // now, or in one that was taken away, and only this says so.
    std::fputs((std::string("jnd: ") + error.what() + "\n").c_str(), stderr);
  }
}

std::unique_ptr<Study> Study::create(const std::filesystem::path& path, const std::string& protocol_name,
                                     const std::string& protocol_bytes, std::uint64_t seed, Stamp stamp) {
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  impl->info = {seed, sha256_hex(protocol_bytes), protocol_name, protocol_bytes};
  impl->lock = std::make_unique<StudyLock>(path);
  if (std::filesystem::exists(path))
    throw StorageError(fmt::format("{}: exists already; it was not changed", path.string()));
  refuse_left_beside(path);
  // Made under another name and renamed when whole: killed at any instant, there is a study or there is none.
  {
    Draft draft(path, Draft::What::file);
    impl->connection = create_database(draft.path());
    impl->fill_new(stamp);
    if (!draft.publish()) throw StorageError(fmt::format("{}: exists already; it was not changed", path.string()));
  }
  impl->lock->hold_file();
  impl->connection = open_database(path, true);
  with_storage_errors(path, [&] { impl->begin_writing(); });
  return std::unique_ptr<Study>(new Study(std::move(impl)));
}

std::unique_ptr<Study> Study::open(const std::filesystem::path& path, Access access) {
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  const bool writable = access == Access::read_write;
  // A missing or foreign file is named as such before a lock file is made beside it.
  if (!writable || !std::filesystem::exists(path)) {
    impl->connection = open_database(path, false);
  } else {
    impl->lock = std::make_unique<StudyLock>(path);
    impl->lock->refuse_other_names();
    impl->connection = open_database(path, true);
  }
  with_storage_errors(path, [&] {
    impl->read_info();
    if (!writable) return;
    impl->read_ends();
    impl->begin_writing();
  });
  return std::unique_ptr<Study>(new Study(std::move(impl)));
}

const StudyInfo& Study::info() const noexcept {
  return impl_->info;
}

std::filesystem::path Study::path() const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->path;
}

std::vector<Event> Study::events(const std::string& session) const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->events(session);
}

std::vector<TelemetryBlob> Study::telemetry(const std::string& session, std::int64_t seq) const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->telemetry(session, seq);
}

std::vector<SessionInfo> Study::sessions() const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->sessions();
}

std::string Study::head() const {
  const std::scoped_lock lock(impl_->mutex);
  return with_storage_errors(impl_->path, [&] {
    SQLite::Statement last(impl_->database(), "SELECT hash FROM event WHERE session = ? ORDER BY seq DESC LIMIT 1");
    last.bind(1, kStudyChain);
    return last.executeStep() ? last.getColumn(0).getString() : std::string();
  });
}

void Study::close() {
  const std::scoped_lock lock(impl_->mutex);
  impl_->close();
}

SQLite::Database& Study::Impl::database() const {
  if (!connection) throw StorageError(fmt::format("{}: this study was closed", path.string()));
  return *connection;
}

void Study::Impl::require_writable() const {
  database();
  if (!lock) throw StorageError(fmt::format("{}: was opened for reading only", path.string()));
}

// The rows of a study without sessions; closes the connection.
void Study::Impl::fill_new(Stamp stamp) {
  with_storage_errors(path, [&] {
    SQLite::Transaction transaction(database());
    SQLite::Statement protocol(database(), "INSERT INTO protocol (sha256, name, bytes) VALUES (?, ?, ?)");
    protocol.bind(1, info.protocol_sha256);
    protocol.bind(2, info.protocol_name);
    protocol.bind(3, info.protocol_bytes.data(), static_cast<int>(info.protocol_bytes.size()));
    insert_row(protocol, path);
    SQLite::Statement study(database(), "INSERT INTO study (id, seed, protocol) VALUES (1, ?, ?)");
    study.bind(1, std::to_string(info.seed));
    study.bind(2, info.protocol_sha256);
    insert_row(study, path);
    append(kStudyChain, event_kind::kStudyCreated,
           body_text({{"seed", std::to_string(info.seed)},
                      {"protocol_sha256", info.protocol_sha256},
                      {"protocol_name", info.protocol_name}}),
           stamp);
    transaction.commit();
  });
  insert.reset();
  connection.reset();
}

void Study::Impl::read_info() {
  SQLite::Statement query(
      database(),
      "SELECT study.seed, protocol.sha256, protocol.name, protocol.bytes FROM study JOIN protocol ON "
      "protocol.sha256 = study.protocol");
  if (!query.executeStep())
    throw StorageError(fmt::format("{}: holds no protocol: it is damaged; it was not changed", path.string()));
  const std::string text = query.getColumn(0).getString();
  const std::optional<std::uint64_t> seed = seed_from(text);
  if (!seed)
    throw StorageError(fmt::format("{}: its seed \"{}\" is not a number of 64 bits: it is damaged; it was not changed",
                                   path.string(), text));
  info.seed = *seed;
  info.protocol_sha256 = query.getColumn(1).getString();
  info.protocol_name = query.getColumn(2).getString();
  info.protocol_bytes = query.getColumn(3).getString();
}

void Study::Impl::close(bool told) {
  if (!connection) return;
  std::string trouble = std::exchange(untold, {});
  if (lock && files) {
    const StudyFiles::State state = files->look(*connection);
    if (state != StudyFiles::State::in_place && state != StudyFiles::State::unseen)
      trouble = rescue(state, "What was saved could not be put into another file");
  }
  if (!trouble.empty())
    trouble += back ? " Go on with the study; the other file is a copy" : " Use that file from now on";
  forget_statements();
  files.reset();  // from here on SQLite itself takes the log away, also where it then fails
  try {
    if (lock) with_storage_errors(path, [&] { end_writing(*connection); });
  } catch (const StorageError& error) {
    if (!trouble.empty()) throw StorageError(fmt::format("{}. {}", trouble, error.what()));
    if (!told) throw;
  }
  connection.reset();
  former.reset();
  lock.reset();
  if (!trouble.empty()) throw StorageError(trouble);
}

// Sessions of a study: opening, appending to their chains, closing. And the study's own chain.

namespace {

class StudyLog final : public SessionLog {
 public:
  StudyLog(Study::Impl& study, std::string session) : study_(study), session_(std::move(session)) {}

  void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) override {
    append(kind, body, stamp, {});
  }

  void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp,
              const std::vector<TelemetryBlob>& telemetry) override {
    require_named(body, telemetry);
    const std::string text = body_text(body);  // outside the mutex: other sessions go on meanwhile
    const std::scoped_lock lock(study_.mutex);
    require_open();
    study_.write([&] { study_.append(session_, kind, text, stamp, telemetry); });
  }

  void mark(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) override {
    const std::string text = body_text(body);
    const std::scoped_lock lock(study_.mutex);
    require_open();
    study_.write([&] { study_.append_mark(session_, kind, text, stamp); }, true);
  }

  std::vector<Event> events() const override {
    const std::scoped_lock lock(study_.mutex);
    return study_.events(session_);
  }

 private:
  void require_open() const {
    study_.require_writable();
    if (study_.ends.at(session_).closed)
      throw StorageError(
          fmt::format("{}: session {} is closed; nothing can be added to it", study_.path.string(), session_));
  }

  Study::Impl& study_;
  std::string session_;
};

}  // namespace

std::unique_ptr<SessionLog> Study::open_session(const NewSession& session) {
  const std::scoped_lock lock(impl_->mutex);
  impl_->require_writable();
  require_admissible(session, *impl_);
  if (session.kind == SessionKind::real) refuse_network_file_system(impl_->path);
  const std::string body = body_text(opened_body(session, impl_->info, impl_->ends.at(kStudyChain).hash));
  impl_->write([&] {
    impl_->set_durability(session.kind);
    impl_->append(session.id, event_kind::kSessionOpened, body, session.stamp);
  });
  ChainEnd& end = impl_->ends.at(session.id);
  end.participant = session.participant;
  end.participant_number = session.participant_number;
  end.number = session.number;
  end.kind = session.kind;
  return std::make_unique<StudyLog>(*impl_, session.id);
}

std::unique_ptr<SessionLog> Study::resume_session(const std::string& id) {
  const std::scoped_lock lock(impl_->mutex);
  impl_->require_writable();
  const auto found = impl_->ends.find(id);
  if (found == impl_->ends.end() || id == kStudyChain)
    throw StorageError(fmt::format("{}: there is no session {}; jnd status lists them", impl_->path.string(), id));
  if (found->second.closed)
    throw StorageError(fmt::format("{}: session {} is closed: it cannot be resumed", impl_->path.string(), id));
  if (impl_->excluded.contains({found->second.kind, found->second.participant}))
    throw StorageError(fmt::format("{}: participant {} was excluded from this study: session {} does not go on",
                                   impl_->path.string(), found->second.participant, id));
  if (found->second.kind == SessionKind::real) refuse_network_file_system(impl_->path);
  with_storage_errors(impl_->path, [&] { impl_->set_durability(found->second.kind); });
  return std::make_unique<StudyLog>(*impl_, id);
}

void Study::close_session(const std::string& id, Stamp stamp) {
  const std::scoped_lock lock(impl_->mutex);
  impl_->require_writable();
  const auto found = impl_->ends.find(id);
  if (found == impl_->ends.end() || id == kStudyChain || found->second.closed)
    throw StorageError(fmt::format("{}: session {} is not open", impl_->path.string(), id));
  const ChainEnd before = found->second;
  const ChainEnd study_before = impl_->ends.at(kStudyChain);
  bool committed = false;
  try {
    impl_->write([&] {
      SQLite::Database& database = impl_->database();
      SQLite::Statement totals(database, "SELECT trials_done, trials_voided FROM sessions WHERE session = ?");
      totals.bind(1, id);
      totals.executeStep();
      const int completed = totals.getColumn(0).getInt(), voided = totals.getColumn(1).getInt();
      totals.reset();
      SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
      impl_->append(id, event_kind::kSessionClosed,
                    body_text({{"trials_completed", completed},
                               {"trials_voided", voided},
                               {kStudyHeadKey, impl_->ends.at(kStudyChain).hash}}),
                    stamp);
      impl_->append(kStudyChain, event_kind::kSessionClosed,
                    body_text({{"session", id},
                               {"participant", before.participant},
                               {"kind", to_string(before.kind)},
                               {"head", impl_->ends.at(id).hash}}),
                    stamp);
      transaction.commit();
      committed = true;
      impl_->ends.at(id).closed = true;
    });
  } catch (...) {
    if (committed) throw;  // what follows the writing failed
    impl_->ends.at(id) = before;
    impl_->ends.at(kStudyChain) = study_before;
    throw;
  }
}

void Study::add_study_event(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) {
  const std::scoped_lock lock(impl_->mutex);
  impl_->require_writable();
  const std::string text = body_text(body);
  impl_->write([&] { impl_->add_study_event(kind, text, stamp); });
  if (kind == event_kind::kExcluded) impl_->excluded = excluded_participants(impl_->database());
}

std::vector<Event> Study::study_events() const {
  return events(kStudyChain);
}

void Study::Impl::append(const std::string& session, std::string_view kind, const std::string& body, Stamp stamp) {
  if (!insert)
    insert = std::make_unique<SQLite::Statement>(database(),
                                                 "INSERT INTO event (session, seq, kind, utc, monotonic_ns, version, "
                                                 "body, hash) VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  const auto found = ends.find(session);
  Event event;
  event.session = session;
  event.seq = (found == ends.end() ? 0 : found->second.seq) + 1;
  event.kind = kind;
  event.stamp = stamp;
  event.version = kVersion;
  event.body = body;
  const std::string utc = to_iso8601(stamp.utc_ns);
  event.hash = event_hash(found == ends.end() ? std::string_view() : std::string_view(found->second.hash), event, utc);
  insert->bindNoCopy(1, event.session);
  insert->bind(2, event.seq);
  insert->bindNoCopy(3, event.kind);
  insert->bindNoCopy(4, utc);
  insert->bind(5, event.stamp.monotonic_ns);
  insert->bindNoCopy(6, event.version);
  insert->bindNoCopy(7, event.body);
  insert->bindNoCopy(8, event.hash);
  try {
    insert_row(*insert, path);  // commits, unless the caller has a transaction open
  } catch (...) {
    insert->tryReset();
    insert->clearBindings();
    throw;
  }
  insert->reset();
  insert->clearBindings();
  ChainEnd& end = ends[session];
  end.seq = event.seq;
  end.hash = std::move(event.hash);
}

std::vector<Event> Study::Impl::events(const std::string& session) const {
  return with_storage_errors(path, [&] {
    SQLite::Statement query(
        database(),
        "SELECT seq, kind, utc, monotonic_ns, version, body, hash FROM event WHERE session = ? ORDER "
        "BY seq");
    query.bind(1, session);
    std::vector<Event> events;
    while (query.executeStep()) {
      Event event;
      event.session = session;
      event.seq = query.getColumn(0).getInt64();
      event.kind = query.getColumn(1).getString();
      event.stamp = {utc_ns_from(query.getColumn(2).getString()), query.getColumn(3).getInt64()};
      event.version = query.getColumn(4).getString();
      event.body = query.getColumn(5).getString();
      event.hash = query.getColumn(6).getString();
      events.push_back(std::move(event));
    }
    return events;
  });
}

void Study::Impl::read_ends() {
  SQLite::Statement last(database(), "SELECT session, max(seq) FROM event GROUP BY session");
  while (last.executeStep()) ends[last.getColumn(0).getString()].seq = last.getColumn(1).getInt64();
  SQLite::Statement hash(database(), "SELECT hash FROM event WHERE session = ? AND seq = ?");
  for (auto& [session, end] : ends) {
    hash.bind(1, session);
    hash.bind(2, end.seq);
    if (hash.executeStep()) end.hash = hash.getColumn(0).getString();
    hash.reset();
  }
  for (const SessionInfo& info : sessions()) {
    ChainEnd& end = ends[info.id];
    end.closed = info.state == "closed";
    end.participant = info.participant;
    end.participant_number = info.participant_number;
    end.number = info.number;
    end.kind = info.kind;
  }
  if (!ends.contains(kStudyChain))
    throw StorageError(
        fmt::format("{}: the study's own events are missing: it is damaged; it was not changed. jnd "
                    "recover makes a new study of what is in it",
                    path.string()));
  excluded = excluded_participants(database());
}

// How events reach the disk: what is flushed when, and what happens when the disk fails.

namespace {

// Checkpoints cost two flushes each; without people waiting they may come every 32 MB instead of every 4.
constexpr std::uint32_t kCheckpointPagesSimulated = 8000;
constexpr std::uint32_t kCheckpointPages = 1000;

}  // namespace

void Study::Impl::synchronize(bool full) {
  if (synchronous_normal == !full) return;
  database().exec(full ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = NORMAL");
  synchronous_normal = !full;
}

void Study::Impl::set_durability(SessionKind kind) {
  people = people || kind != SessionKind::simulated;
  synchronize(people);
  if (people && files && files->image() == nullptr) files->keep_image();
}

// SQLite itself would do it within the commit, before anybody has looked whether the study is whole. Where it fails the
// log stays, and nothing is lost.
void Study::Impl::shorten_log() const {
  if (StudyFiles::log_length(database()) >= (people ? kCheckpointPages : kCheckpointPagesSimulated))
    sqlite3_wal_checkpoint_v2(database().getHandle(), "main", SQLITE_CHECKPOINT_PASSIVE, nullptr, nullptr);
}

// A mark may go with a power cut.
void Study::Impl::append_mark(const std::string& session, std::string_view kind, const std::string& body, Stamp stamp) {
  synchronize(false);
  try {
    append(session, kind, body, stamp);
  } catch (...) {
    synchronize(people);
    throw;
  }
  synchronize(people);
}

void Study::Impl::add_study_event(std::string_view kind, const std::string& body, Stamp stamp) {
  const bool was_normal = synchronous_normal;
  synchronize(true);
  try {
    append(kStudyChain, kind, body, stamp);
  } catch (...) {
    synchronize(!was_normal);
    throw;
  }
  synchronize(!was_normal);
}

// A flush that failed is not made good by one that succeeds: the kernel has called the lost pages clean. So before
// anything is added after an error, all that is committed goes into the study itself, flushed there, and the
// write-ahead log begins anew.
void Study::Impl::recover_from_disk_failure() {
  if (!disk_failed) return;
  SQLite::Statement checkpoint(database(), "PRAGMA wal_checkpoint(TRUNCATE)");
  if (checkpoint.executeStep() && checkpoint.getColumn(0).getInt() != 0)
    throw StorageTrouble(
        fmt::format("{}: after the disk's error another program that reads the study is in the way: this event is not "
                    "saved, all earlier ones are. Close that program and try again",
                    path.string()));
  disk_failed = false;
}

// SQLite rolls back by itself in most cases, but does not promise it.
void Study::Impl::tidy_after_failure() const {
  if (!connection) return;
  if (insert) insert->tryReset();
  if (sqlite3_get_autocommit(connection->getHandle()) == 0)
    sqlite3_exec(connection->getHandle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

// Telemetry of a study: stored in one transaction with the event it belongs to, and read back.

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
