// What the log says of its sessions: who, how far, how they ended. It asks the table of events and no view: those may
// be missing in a file that is only read.
#include <algorithm>
#include <tuple>

#include <fmt/format.h>
#include <sqlite3.h>

#include "data/log/body_numbers.h"
#include "data/log/event_body.h"
#include "data/log/plain_name.h"
#include "data/study/schema.h"
#include "data/study/study_impl.h"
#include "protocols/input/json_text.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

std::string text_at(const Json& body, const char* key) {
  const auto found = body.find(key);
  return found != body.end() && found->is_string() ? found->get<std::string>() : std::string();
}

SessionInfo opened_info(const std::string& id, const Json& body) {
  SessionInfo info;
  info.id = id;
  info.participant = body.at("participant").get<std::string>();
  if (!plain_name(info.participant))
    throw StorageError(fmt::format("has the participant code \"{}\", which cannot be one", info.participant));
  info.participant_number = whole_at(body, "participant_number");
  info.number = whole_or(body, "session_number", 1);
  const auto kind = body.at("kind").get<std::string>();
  const std::optional<SessionKind> known = session_kind_from(kind);
  if (!known) throw StorageError(fmt::format("is of unknown kind \"{}\"", kind));
  info.kind = *known;
  info.state = "open";
  info.responder = text_at(body, "responder");
  info.trials_total = whole_or(body, "trials_total", 0);
  info.rig_sha256 = text_at(body, "rig_sha256");
  info.language = text_at(body, "language");
  info.group = text_at(body, "group");
  return info;
}

std::map<std::string, SessionInfo> opened_sessions(const std::string& path, SQLite::Database& database) {
  std::map<std::string, SessionInfo> sessions;
  SQLite::Statement query(database, "SELECT session, body, utc FROM event WHERE kind = 'session.opened'");
  while (query.executeStep()) {
    const std::string id = query.getColumn(0).getString();
    try {
      SessionInfo info = opened_info(id, json_from(query.getColumn(1).getString()));
      info.started = query.getColumn(2).getString();
      sessions.emplace(id, std::move(info));
    } catch (const StorageError& error) {
      throw StorageError(fmt::format("{}: session {} {}; run jnd verify", path, id, error.what()));
    } catch (const Json::exception& error) {
      throw StorageError(
          fmt::format("{}: session {}: its first event cannot be read: {}; run jnd verify", path, id, error.what()));
    }
  }
  return sessions;
}

// Calls with(info, row) for every row of a query whose first column is a session that was opened.
template <typename With>
void for_sessions(SQLite::Database& database, const char* sql, std::map<std::string, SessionInfo>& sessions,
                  With&& with) {
  SQLite::Statement query(database, sql);
  while (query.executeStep())
    if (const auto found = sessions.find(query.getColumn(0).getString()); found != sessions.end())
      with(found->second, query);
}

}  // namespace

std::vector<TakenBack> taken_back(SQLite::Database& database) {
  // Voids first, which are few; of a completion that was voided twice the first void counts. The plus keeps SQLite to
  // the index of trials.
  SQLite::Statement query(
      database,
      "SELECT c.session, c.seq, min(v.seq), c.practice FROM event v CROSS JOIN event c WHERE v.kind = 'trial.voided' "
      "AND c.kind = 'trial.completed' AND c.session = v.session AND c.trial = v.trial AND +c.seq < v.seq AND "
      "c.attempt = v.attempt GROUP BY c.session, c.seq ORDER BY c.session, c.seq");
  std::vector<TakenBack> found;
  while (query.executeStep())
    found.push_back({query.getColumn(0).getString(), query.getColumn(1).getInt64(), query.getColumn(2).getInt64(),
                     query.getColumn(3).getInt() != 0});
  return found;
}

std::map<ParticipantKey, bool> excluded_participants(SQLite::Database& database) {
  SQLite::Statement query(database,
                          "SELECT body FROM event WHERE session = 'study' AND kind = 'participant.excluded' ORDER BY "
                          "seq");
  std::map<ParticipantKey, bool> excluded;
  while (query.executeStep()) {
    // A body that cannot be read is verify's to report.
    const Json body = json_if_valid(query.getColumn(0).getString());
    if (!body.is_object()) continue;
    const std::optional<SessionKind> kind = session_kind_from(text_at(body, "kind"));
    const auto replace = body.find("replace");
    if (kind)
      excluded[{*kind, text_at(body, "participant")}] =
          replace != body.end() && replace->is_boolean() && replace->get<bool>();
  }
  return excluded;
}

std::vector<SessionInfo> Study::Impl::sessions() const {
  return with_storage_errors(path, [&] {
    // One instant, whatever a session adds meanwhile.
    const bool own = sqlite3_get_autocommit(database().getHandle()) != 0;
    std::optional<SQLite::Transaction> reading;
    if (own) reading.emplace(database());
    std::map<std::string, SessionInfo> by_id = opened_sessions(path.string(), database());
    for_sessions(database(), "SELECT session, utc FROM event WHERE kind = 'session.closed'", by_id,
                 [](SessionInfo& info, SQLite::Statement& row) {
                   info.state = "closed";
                   info.ended = row.getColumn(1).getString();
                 });
    // The last one counts: a session that was closed complete was resumed after it was left.
    for_sessions(database(),
                 "SELECT session, body, kind, max(seq) FROM event WHERE kind IN ('session.left', 'session.resumed') "
                 "GROUP BY session",
                 by_id, [](SessionInfo& info, SQLite::Statement& row) {
                   const Json body = json_if_valid(row.getColumn(1).getString());
                   if (info.state != "closed" || !body.is_object()) return;
                   const auto for_good = body.find("for_good");
                   info.ended_early = row.getColumn(2).getString() == event_kind::kLeft && for_good != body.end() &&
                                      for_good->is_boolean() && for_good->get<bool>();
                 });
    for_sessions(database(),
                 "SELECT session, count(*) FROM event WHERE kind = 'trial.completed' AND practice = 0 GROUP BY session",
                 by_id,
                 [](SessionInfo& info, SQLite::Statement& row) { info.trials_done = row.getColumn(1).getInt(); });
    for_sessions(database(), "SELECT session, count(*) FROM event WHERE kind = 'trial.voided' GROUP BY session", by_id,
                 [](SessionInfo& info, SQLite::Statement& row) { info.trials_voided = row.getColumn(1).getInt(); });
    for_sessions(database(), "SELECT DISTINCT session FROM event WHERE kind = 'session.unblinded'", by_id,
                 [](SessionInfo& info, SQLite::Statement&) { info.unblinded = true; });
    // Of free interaction, which has no trials.
    for_sessions(database(),
                 "SELECT session, count(*) FROM event WHERE kind = 'exploration.completed' GROUP BY session", by_id,
                 [](SessionInfo& info, SQLite::Statement& row) { info.trials_done += row.getColumn(1).getInt(); });
    for_sessions(database(), "SELECT session, count(*) FROM event WHERE kind = 'exploration.voided' GROUP BY session",
                 by_id,
                 [](SessionInfo& info, SQLite::Statement& row) { info.trials_voided += row.getColumn(1).getInt(); });
    for (const TakenBack& one : taken_back(database()))
      if (const auto found = by_id.find(one.session); found != by_id.end() && !one.practice)
        --found->second.trials_done;
    const std::map<ParticipantKey, bool> left_out = excluded_participants(database());
    SQLite::Statement head(database(), "SELECT hash FROM event WHERE session = ? ORDER BY seq DESC LIMIT 1");
    std::vector<SessionInfo> sessions;
    for (auto& [id, info] : by_id) {
      head.bind(1, id);
      if (head.executeStep()) info.head = head.getColumn(0).getString();
      head.reset();
      const auto excluded_as = left_out.find({info.kind, info.participant});
      info.excluded = excluded_as != left_out.end();
      info.replaced = info.excluded && excluded_as->second;
      sessions.push_back(std::move(info));
    }
    // Never in the order of insertion, which depends on how sessions ran beside each other.
    std::sort(sessions.begin(), sessions.end(), [](const SessionInfo& a, const SessionInfo& b) {
      return std::tie(a.kind, a.participant_number, a.participant, a.number, a.started, a.id) <
             std::tie(b.kind, b.participant_number, b.participant, b.number, b.started, b.id);
    });
    return sessions;
  });
}

std::string state_text(const SessionInfo& session) {
  std::string text = session.state;
  if (session.excluded)
    text += ", excluded";
  else if (session.ended_early)
    text += ", ended early";
  return session.unblinded ? text + ", unblinded" : text;
}

}  // namespace jnd
