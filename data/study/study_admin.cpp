#include "data/study/study_admin.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "data/log/event_body.h"
#include "data/log/utc_time.h"
#include "data/study/study_impl.h"
#include "protocols/input/json_text.h"

namespace jnd {

namespace {

// Long enough for any reason, short enough that no event grows out of hand.
constexpr std::size_t kLongestText = 10'000;

void require_text(const Study& study, const std::string& text, const char* what) {
  const bool blank = std::all_of(text.begin(), text.end(), [](char c) { return c == ' ' || c == '\t' || c == '\n'; });
  const std::string where = study.impl().path.string();
  if (blank) throw StorageError(fmt::format("{}: {} is needed, in a few words", where, what));
  if (text.size() > kLongestText)
    throw StorageError(
        fmt::format("{}: {} of {} bytes is too long: take at most {}", where, what, text.size(), kLongestText));
}

template <typename Matches>
void require_participant(const Study& study, const std::string& participant, const std::string& of, Matches&& matches) {
  const std::vector<SessionInfo> sessions = study.sessions();
  if (std::any_of(sessions.begin(), sessions.end(), matches)) return;
  throw StorageError(fmt::format("{}: nobody of code {} has {}; jnd status lists who has", study.impl().path.string(),
                                 participant, of));
}

}  // namespace

void exclude_participant(Study& study, const std::string& participant, SessionKind kind, const std::string& reason,
                         bool replace, Stamp stamp) {
  require_text(study, reason, "a reason");
  require_participant(study, participant, fmt::format("a session of kind {} in this study", to_string(kind)),
                      [&](const SessionInfo& one) { return one.participant == participant && one.kind == kind; });
  for (const ExcludedParticipant& one : excluded_from(study))
    if (one.participant == participant && one.kind == kind)
      throw StorageError(fmt::format("{}: participant {} ({} sessions) is excluded already, since {}: {}",
                                     study.impl().path.string(), participant, to_string(kind), one.utc, one.reason));
  study.add_study_event(
      event_kind::kExcluded,
      {{"participant", participant}, {"kind", to_string(kind)}, {"reason", reason}, {"replace", replace}}, stamp);
}

void unblind(Study& study, const std::string& reason, Stamp stamp) {
  require_text(study, reason, "a reason");
  for (const Event& event : study.study_events())
    if (event.kind == event_kind::kUnblinded)
      throw StorageError(fmt::format("{}: this study is unblinded already, since {}", study.impl().path.string(),
                                     to_iso8601(event.stamp.utc_ns)));
  study.add_study_event(event_kind::kUnblinded, {{"reason", reason}}, stamp);
}

bool is_unblinded(const Study& study) {
  const std::vector<Event> events = study.study_events();
  return std::any_of(events.begin(), events.end(),
                     [](const Event& event) { return event.kind == event_kind::kUnblinded; });
}

void add_note(Study& study, const std::string& text, Stamp stamp, const std::optional<std::string>& participant) {
  require_text(study, text, "the text of a note");
  nlohmann::ordered_json body = {{"text", text}};
  if (participant) {
    require_participant(study, *participant, "a session in this study",
                        [&](const SessionInfo& one) { return one.participant == *participant; });
    body["participant"] = *participant;
  }
  study.add_study_event(event_kind::kNote, body, stamp);
}

int next_participant_number(const std::vector<SessionInfo>& sessions, SessionKind kind, int first, int step) {
  std::set<int> taken;
  for (const SessionInfo& session : sessions)
    if (session.kind == kind && !session.replaced) taken.insert(session.participant_number);
  int number = first;
  while (taken.contains(number)) number += step;
  return number;
}

std::vector<ExcludedParticipant> excluded_from(const Study& study) {
  std::vector<ExcludedParticipant> excluded;
  for (const Event& event : study.study_events()) {
    if (event.kind != event_kind::kExcluded) continue;
    try {
      const auto body = json_from(event.body);
      const std::optional<SessionKind> kind = session_kind_from(body.at("kind").get<std::string>());
      if (!kind) throw StorageError(fmt::format("unknown kind of session \"{}\"", body.at("kind").get<std::string>()));
      excluded.push_back({body.at("participant").get<std::string>(), *kind, body.at("reason").get<std::string>(),
                          body.at("replace").get<bool>(), to_iso8601(event.stamp.utc_ns)});
    } catch (const nlohmann::json::exception& error) {
      throw StorageError(fmt::format("{}: event {} of the study ({}) cannot be read: {}; run jnd verify",
                                     study.impl().path.string(), event.seq, event.kind, error.what()));
    }
  }
  return excluded;
}

}  // namespace jnd
