// Sessions of a study: opening, appending to their chains, closing, listing.
#include <algorithm>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "data/chain.h"
#include "data/event_body.h"
#include "data/schema.h"
#include "data/study_impl.h"
#include "data/utc_time.h"
#include "protocols/version.h"

namespace jnd {

namespace {

// Checkpoints cost two flushes each; without people waiting they may come every 32 MB instead of every 4.
constexpr int kCheckpointPagesSimulated = 8000;
constexpr int kCheckpointPages = 1000;

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
    study_.require_writable();
    if (study_.ends.at(session_).closed)
      throw StorageError(
          fmt::format("{}: session {} is closed; nothing can be added to it", study_.path.string(), session_));
    with_storage_errors(study_.path, [&] { study_.append(session_, kind, text, stamp, telemetry); });
  }

  std::vector<Event> events() const override {
    const std::scoped_lock lock(study_.mutex);
    return study_.events(session_);
  }

 private:
  Study::Impl& study_;
  std::string session_;
};

// Names become folders and cells of tables: letters, digits, '-', '_' and '.', not first a dot.
bool plain_name(std::string_view name) {
  return !name.empty() && name.size() <= 64 && name.front() != '.' && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
           c == '.';
  });
}

void refuse_names(const NewSession& session, const Study::Impl& study) {
  for (const auto& [what, name] :
       {std::pair<std::string_view, std::string_view>{"participant", session.participant}, {"session", session.id}})
    if (!plain_name(name))
      throw StorageError(fmt::format(
          "the {} name \"{}\" cannot be used: take letters, digits, '-', '_' and '.', at most 64, such as P01", what,
          name));
  if (study.ends.contains(session.id))
    throw StorageError(fmt::format("{}: session {} exists already", study.path.string(), session.id));
  for (const auto& [id, end] : study.ends) {
    if (id == kStudyChain || end.kind != session.kind) continue;
    if ((end.participant == session.participant) != (end.participant_number == session.participant_number))
      throw StorageError(fmt::format("{}: participant {} has number {} in session {}, so that {} cannot be number {}",
                                     study.path.string(), end.participant, end.participant_number, id,
                                     session.participant, session.participant_number));
  }
}

nlohmann::ordered_json opened_body(const NewSession& session, const StudyInfo& study) {
  return {{"participant", session.participant},
          {"participant_number", session.participant_number},
          {"kind", to_string(session.kind)},
          {"responder", session.responder},
          {"profile_sha256", session.profile_sha256.empty() ? nlohmann::ordered_json(nullptr)
                                                            : nlohmann::ordered_json(session.profile_sha256)},
          {"rig", session.rig},
          {"rig_mode", session.rig_mode},
          {"rig_sha256",
           session.rig_sha256.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(session.rig_sha256)},
          {"tracker", session.tracker},
          {"trials_total", session.trials_total},
          {"protocol_sha256", study.protocol_sha256},
          {"seed", std::to_string(study.seed)}};
}

int kind_place(const std::string& kind) {
  const std::optional<SessionKind> known = session_kind_from(kind);
  return known ? static_cast<int>(*known) : 3;
}

}  // namespace

std::unique_ptr<SessionLog> Study::open_session(const NewSession& session) {
  const std::scoped_lock lock(impl_->mutex);
  impl_->require_writable();
  refuse_names(session, *impl_);
  if (session.kind == SessionKind::real) refuse_network_file_system(impl_->path);
  return with_storage_errors(impl_->path, [&]() -> std::unique_ptr<SessionLog> {
    impl_->set_durability(session.kind);
    impl_->append(session.id, event_kind::kSessionOpened, body_text(opened_body(session, impl_->info)), session.stamp);
    ChainEnd& end = impl_->ends.at(session.id);
    end.participant = session.participant;
    end.participant_number = session.participant_number;
    end.kind = session.kind;
    return std::make_unique<StudyLog>(*impl_, session.id);
  });
}

std::unique_ptr<SessionLog> Study::resume_session(const std::string& id) {
  const std::scoped_lock lock(impl_->mutex);
  impl_->require_writable();
  const auto found = impl_->ends.find(id);
  if (found == impl_->ends.end() || id == kStudyChain)
    throw StorageError(fmt::format("{}: there is no session {}; jnd status lists them", impl_->path.string(), id));
  if (found->second.closed)
    throw StorageError(fmt::format("{}: session {} is closed: it cannot be resumed", impl_->path.string(), id));
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
  try {
    with_storage_errors(impl_->path, [&] {
      SQLite::Database& database = impl_->database();
      SQLite::Statement totals(database, "SELECT trials_done, trials_voided FROM sessions WHERE session = ?");
      totals.bind(1, id);
      totals.executeStep();
      const int completed = totals.getColumn(0).getInt(), voided = totals.getColumn(1).getInt();
      totals.reset();
      SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
      impl_->append(id, event_kind::kSessionClosed,
                    body_text({{"trials_completed", completed}, {"trials_voided", voided}}), stamp);
      impl_->append(kStudyChain, event_kind::kSessionClosed,
                    body_text({{"session", id},
                               {"participant", before.participant},
                               {"kind", to_string(before.kind)},
                               {"head", impl_->ends.at(id).hash}}),
                    stamp);
      transaction.commit();
      impl_->ends.at(id).closed = true;
    });
  } catch (...) {
    impl_->ends.at(id) = before;
    impl_->ends.at(kStudyChain) = study_before;
    throw;
  }
}

void Study::Impl::set_durability(SessionKind kind) {
  people = people || kind != SessionKind::simulated;
  database().exec(people ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = NORMAL");
  database().exec(fmt::format("PRAGMA wal_autocheckpoint = {}", people ? kCheckpointPages : kCheckpointPagesSimulated));
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
    insert->exec();  // commits, unless the caller has a transaction open
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

std::vector<SessionInfo> Study::Impl::sessions() const {
  return with_storage_errors(path, [&] {
    SQLite::Statement query(database(),
                            "SELECT session, participant, participant_number, kind, state, responder, trials_done, "
                            "trials_voided, trials_total, started, ended, head FROM sessions");
    std::vector<SessionInfo> sessions;
    while (query.executeStep()) {
      SessionInfo info;
      info.id = query.getColumn(0).getString();
      info.participant = query.getColumn(1).getString();
      info.participant_number = query.getColumn(2).getInt();
      const std::string kind = query.getColumn(3).getString();
      if (kind_place(kind) > 2)
        throw StorageError(
            fmt::format("{}: session {} is of unknown kind \"{}\"; run jnd verify", path.string(), info.id, kind));
      info.kind = static_cast<SessionKind>(kind_place(kind));
      info.state = query.getColumn(4).getString();
      info.responder = query.getColumn(5).getString();
      info.trials_done = query.getColumn(6).getInt();
      info.trials_voided = query.getColumn(7).getInt();
      info.trials_total = query.getColumn(8).getInt();
      info.started = query.getColumn(9).getString();
      info.ended = query.getColumn(10).getString();
      info.head = query.getColumn(11).getString();
      sessions.push_back(std::move(info));
    }
    // Never in the order of insertion, which depends on how sessions ran beside each other.
    std::sort(sessions.begin(), sessions.end(), [](const SessionInfo& a, const SessionInfo& b) {
      return std::tie(a.kind, a.participant_number, a.participant, a.started, a.id) <
             std::tie(b.kind, b.participant_number, b.participant, b.started, b.id);
    });
    return sessions;
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
    end.kind = info.kind;
  }
}

}  // namespace jnd
