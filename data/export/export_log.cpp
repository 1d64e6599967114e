#include "data/export/export_log.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "data/fields/field.h"
#include "data/log/body_numbers.h"
#include "data/log/event_body.h"
#include "data/log/utc_time.h"
#include "data/study/study_impl.h"
#include "protocols/input/json_text.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

// A kind of event that gets a row, and what its cells are called in its body.
struct Rule {
  std::string_view kind, event;
  const char* text;      // or null: the kind has none
  const char* subject;   // or null
  const char* duration;  // in seconds, or null
};

constexpr std::array kRules = {Rule{event_kind::kNote, "note", "text", nullptr, nullptr},
                               Rule{event_kind::kPaused, "paused", "reason", nullptr, nullptr},
                               Rule{event_kind::kContinued, "continued", nullptr, nullptr, "paused_s"},
                               Rule{event_kind::kLeft, "left", "reason", nullptr, nullptr},
                               Rule{event_kind::kSessionResumed, "resumed", "reason", nullptr, "gap_s"},
                               Rule{event_kind::kBlockEnded, "block_ended", "reason", nullptr, nullptr},
                               Rule{event_kind::kStopCleared, "stop_cleared", "reason", nullptr, nullptr},
                               Rule{event_kind::kChecklist, "checklist", "answer", "question", nullptr},
                               Rule{event_kind::kConsent, "consent", nullptr, "language", nullptr},
                               Rule{event_kind::kSessionUnblinded, "session_unblinded", nullptr, "shown", nullptr},
                               Rule{event_kind::kExcluded, "excluded", "reason", nullptr, nullptr},
                               Rule{event_kind::kUnblinded, "unblinded", "reason", nullptr, nullptr}};

const Rule* rule_of(std::string_view kind) {
  const auto* const found =
      std::find_if(kRules.begin(), kRules.end(), [&](const Rule& rule) { return rule.kind == kind; });
  return found == kRules.end() ? nullptr : &*found;
}

std::string text_at(const Json& body, const char* key) {
  const auto found = key == nullptr ? body.end() : body.find(key);
  if (found == body.end() || found->is_null()) return {};
  return found->is_string() ? found->get<std::string>() : found->dump();
}

std::optional<double> number_of(const Json& body, const char* key) {
  const auto found = key == nullptr ? body.end() : body.find(key);
  return found != body.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

// Throws nlohmann::json::exception where the number is not whole or does not fit.
std::optional<int> whole_of(const Json& body, const char* key) {
  const auto found = body.find(key);
  return found != body.end() && found->is_number() ? std::optional(whole(*found)) : std::nullopt;
}

LogRow row_of(const Event& event, const Rule& rule, const Json& body) {
  LogRow row;
  row.seq = event.seq;
  row.utc = to_iso8601(event.stamp.utc_ns);
  row.event = rule.event;
  row.trial = whole_of(body, "after_trial");
  row.subject = text_at(body, rule.subject);
  row.cause = text_at(body, "cause");
  row.text = event.kind == event_kind::kConsent ? (body.value("refused", false) ? "refused" : "given")
                                                : text_at(body, rule.text);
  row.by = text_at(body, "by");
  row.duration_s = number_of(body, rule.duration);
  return row;
}

// text: why; subject: what had been answered.
LogRow taken_back_row(const Event& completed, const Event& voided, const Json& answer, const Json& body) {
  LogRow row;
  row.seq = voided.seq;
  row.utc = to_iso8601(voided.stamp.utc_ns);
  row.event = kTakenBackEvent;
  row.trial = whole_of(answer, "index");
  row.attempt = whole_of(answer, "attempt");
  row.subject = text_at(answer, "answer");
  row.cause = text_at(body, "reason");
  row.text = text_at(body, "words");
  row.by = text_at(answer, "entered_by");
  row.duration_s = static_cast<double>(voided.stamp.utc_ns - completed.stamp.utc_ns) * 1e-9;
  return row;
}

// What `read` makes of the event's body.
template <typename Read>
LogRow read_row(const Event& event, Read&& read) {
  try {
    return read(json_from(event.body));
  } catch (const Json::exception& error) {
    throw StorageError(fmt::format("session {}, event {} ({}): the body cannot be read: {}; run jnd verify",
                                   event.session, event.seq, event.kind, error.what()));
  }
}

void add_session(const Study& study, const SessionInfo& session, const std::map<std::int64_t, std::int64_t>& voids,
                 std::vector<LogRow>& rows) {
  const std::vector<Event> events = study.events(session.id);
  const std::size_t first = rows.size();
  for (const Event& event : events) {
    const auto voided = voids.find(event.seq);
    if (voided != voids.end()) {
      const auto completed =
          std::find_if(events.begin(), events.end(), [&](const Event& one) { return one.seq == voided->second; });
      if (completed != events.end())
        rows.push_back(read_row(event, [&](const Json& body) {
          return read_row(*completed,
                          [&](const Json& answer) { return taken_back_row(*completed, event, answer, body); });
        }));
    } else if (const Rule* rule = rule_of(event.kind)) {
      rows.push_back(read_row(event, [&](const Json& body) { return row_of(event, *rule, body); }));
    }
  }
  for (std::size_t i = first; i < rows.size(); ++i) {
    rows[i].participant = session.participant;
    rows[i].session = session.id;
    rows[i].session_number = session.number;
    rows[i].kind = to_string(session.kind);
  }
}

}  // namespace

std::vector<LogRow> log_rows(const Study& study, SessionKind kind, const std::vector<SessionInfo>& sessions) {
  std::map<std::string, std::map<std::int64_t, std::int64_t>> voids;  // by session: of a void, its completion
  {
    const Study::Impl& impl = study.impl();
    const std::scoped_lock lock(impl.mutex);
    with_storage_errors(impl.path, [&] {
      for (const TakenBack& one : taken_back(impl.database())) voids[one.session][one.voided_seq] = one.seq;
      return 0;
    });
  }
  std::vector<LogRow> rows;
  for (const SessionInfo& session : sessions) add_session(study, session, voids[session.id], rows);
  for (const Event& event : study.study_events()) {
    const Rule* rule = rule_of(event.kind);
    if (rule == nullptr) continue;
    LogRow row = read_row(event, [&](const Json& body) {
      LogRow of_study = row_of(event, *rule, body);
      of_study.participant = text_at(body, "participant");
      of_study.kind = text_at(body, "kind");
      return of_study;
    });
    if (row.kind.empty() || row.kind == to_string(kind)) rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<CsvColumn<LogRow>> log_columns() {
  using R = LogRow;
  std::string events;
  for (const Rule& rule : kRules) events.append(rule.event).append(" ");
  events.append(kTakenBackEvent);
  const Fields<R> fields = {
      {"participant", "code of the participant; empty where it is about the study", &R::participant},
      {"session", "session of the event; empty for an event of the study itself", &R::session},
      {"session_number", "which of the participant's sessions, from 1", &R::session_number},
      {"kind", "kind of the session; empty where it is about the study", &R::kind, {.levels = "real pilot simulated"}},
      {"seq", "number of the event in its session, or in the study's own chain", &R::seq},
      {"utc", "when it was saved, ISO 8601", &R::utc, {.type = CellType::time}},
      {"event", "what happened", &R::event, {.levels = events}},
      {"trial", "trial of the plan whose answer was taken back; for the others: main trials done before", &R::trial},
      {"attempt", "of a trial whose answer was taken back", &R::attempt},
      {"subject",
       "the answer that was taken back, empty while plans are sealed; the item of the checklist; the language of the "
       "consent",
       &R::subject},
      {"cause", "what brought it about, as the program names it", &R::cause},
      {"text", "the note, the reason or the answer as given", &R::text},
      {"by", "who entered it; empty where it was not noted", &R::by},
      {"duration_s",
       "of a pause or interruption; from an answer to its being taken back",
       &R::duration_s,
       {.unit = "s"}}};
  return csv_columns(fields);
}

}  // namespace jnd
