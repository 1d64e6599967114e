#include "data/log/session_log.h"

#include <algorithm>

#include <fmt/format.h>

#include "data/log/body_numbers.h"
#include "data/log/event_body.h"
#include "data/log/storage_error.h"
#include "data/log/telemetry.h"

namespace jnd {

void SessionLog::append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp,
                        const std::vector<TelemetryBlob>& /*telemetry*/) {
  append(kind, body, stamp);
}

void MemoryLog::append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) {
  Event event;
  event.seq = static_cast<std::int64_t>(events_.size()) + 1;
  event.kind = kind;
  event.stamp = stamp;
  event.body = body_text(body);
  events_.push_back(std::move(event));
}

void MemoryLog::append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp,
                       const std::vector<TelemetryBlob>& telemetry) {
  require_named(body, telemetry);
  append(kind, body, stamp);
  if (!telemetry.empty()) telemetry_[events_.back().seq] = telemetry;
}

std::vector<TelemetryBlob> MemoryLog::telemetry(std::int64_t seq) const {
  const auto found = telemetry_.find(seq);
  return found == telemetry_.end() ? std::vector<TelemetryBlob>{} : found->second;
}

void require_named(const nlohmann::ordered_json& body, const std::vector<TelemetryBlob>& telemetry) {
  if (telemetry.empty()) return;
  if (!body.contains("telemetry") || body.at("telemetry") != telemetry_body(telemetry))
    throw StorageError("an event must name the telemetry that is stored with it (\"telemetry\" in its body)");
}

// What a session's events say has happened: kill the program anywhere, and this says where the session goes on.

namespace {

using Json = nlohmann::ordered_json;

// Empty where there is none, or null.
std::string text_at(const Json& body, const char* key) {
  const auto found = body.find(key);
  return found != body.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// The trial is done with, whatever became of it.
void settle(SessionState& state, int index) {
  if (state.pending && state.pending->index == index) state.pending.reset();
}

void attempted(SessionState& state, int index, int attempt) {
  int& highest = state.attempts[index];
  highest = std::max(highest, attempt);
}

void complete(SessionState& state, const Json& body) {
  state.completed.push_back(trial_record_from(body));
  const TrialRecord& record = state.completed.back();
  if (record.trial.practice) state.practice_due = false;
  state.taken_back = false;
  attempted(state, record.trial.index, record.attempt);
  settle(state, record.trial.index);
}

// Also of a trial that was answered: the answer is taken back.
void take_void(SessionState& state, const Json& body) {
  const int index = trial_from(body).index;
  const int attempt = whole_at(body, "attempt");
  if (text_at(body, "reason") == "taken_back") state.taken_back = true;
  attempted(state, index, attempt);
  if (body.value("counts", true)) ++state.voided[index];
  std::erase(state.void_order, index);
  if (!body.value("anew", false)) state.void_order.push_back(index);  // anew: in its planned place, as if never tried
  std::erase_if(state.completed,
                [&](const TrialRecord& record) { return record.trial.index == index && record.attempt == attempt; });
  settle(state, index);
}

void end_practice(SessionState& state) {
  state.practice_ended = true;
  state.practice_due = false;
}

void end_block(SessionState& state, const Json& body) {
  for (const Json& index : body.at("trials")) {
    state.abandoned.insert(whole(index));
    settle(state, whole(index));
  }
  if (body.value("practice", false)) end_practice(state);
}

void resume(SessionState& state, const Json& body) {
  state.boot_id = text_at(body, "boot_id");
  if (!body.value("practice_again", false)) return;
  state.practice_ended = false;
  state.practice_due = true;
}

bool apply_to_trials(std::string_view kind, const Json& body, SessionState& state) {
  if (kind == event_kind::kTrialBegan) {
    state.pending = PendingTrial{whole_at(body, "index"), whole_at(body, "attempt")};
    attempted(state, state.pending->index, state.pending->attempt);
  } else if (kind == event_kind::kTrialCompleted) {
    complete(state, body);
  } else if (kind == event_kind::kTrialVoided) {
    take_void(state, body);
  } else if (kind == event_kind::kTrialsShort) {
    state.abandoned.insert(trial_from(body).index);
    settle(state, trial_from(body).index);
  } else if (kind == event_kind::kBlockEnded) {
    end_block(state, body);
  } else if (kind == event_kind::kPracticeEnded) {
    end_practice(state);
  } else if (kind == event_kind::kExploration) {
    state.explored.insert(whole_at(body, "index"));
  } else if (kind == event_kind::kExplorationVoided) {
    state.explored.erase(whole_at(body, "index"));
  } else {
    return false;
  }
  return true;
}

// Other kinds (notes, pauses, faults) change nothing about what is still to do.
void apply_to_session(std::string_view kind, const Json& body, SessionState& state) {
  if (kind == event_kind::kSessionOpened) {
    state.opened = true;
    state.boot_id = text_at(body, "boot_id");
  } else if (kind == event_kind::kSessionResumed) {
    resume(state, body);
  } else if (kind == event_kind::kSessionClosed) {
    state.closed = true;
  } else if (kind == event_kind::kQuestionAnswered) {
    const Json& condition = body.at("condition");
    state.answered.insert(question_key(body.at("question").get<std::string>(),
                                       condition.is_null() ? "" : condition.get<std::string>(),
                                       whole_at(body, "after_trial")));
  } else if (kind == event_kind::kBreakTaken) {
    state.breaks_after.insert(whole_at(body, "after_trial"));
  } else if (kind == event_kind::kInstructed) {
    state.instructed.insert(body.at("id").get<std::string>());
  } else if (kind == event_kind::kConsent) {
    state.consented = !body.value("refused", false);
  } else if (kind == event_kind::kLeft) {
    state.ended_for_good = state.ended_for_good || body.value("for_good", false);
  }
}

void apply(const Event& event, SessionState& state) {
  const Json body = Json::parse(event.body);
  if (!apply_to_trials(event.kind, body, state)) apply_to_session(event.kind, body, state);
  state.left = event.kind == event_kind::kLeft;
  state.last_monotonic_ns = event.stamp.monotonic_ns;
  state.last_utc_ns = event.stamp.utc_ns;
}

}  // namespace

SessionState replay(const std::vector<Event>& events) {
  SessionState state;
  for (const Event& event : events) {
    try {
      apply(event, state);
    } catch (const StorageError& error) {
      throw StorageError(fmt::format("session {}, event {} ({}): {}; run jnd verify", event.session, event.seq,
                                     event.kind, error.what()));
    } catch (const nlohmann::json::exception& error) {
      throw StorageError(fmt::format("session {}, event {} ({}): the body cannot be read: {}; run jnd verify",
                                     event.session, event.seq, event.kind, error.what()));
    }
  }
  return state;
}

}  // namespace jnd
