// What a session's events say has happened: kill the program anywhere, and this says where the session goes on.
#include <algorithm>

#include <fmt/format.h>

#include "data/event_body.h"
#include "data/storage_error.h"

namespace jnd {

namespace {

void apply(const Event& event, const nlohmann::ordered_json& body, SessionState& state) {
  if (event.kind == event_kind::kSessionOpened) {
    state.opened = true;
  } else if (event.kind == event_kind::kSessionClosed) {
    state.closed = true;
  } else if (event.kind == event_kind::kTrialCompleted) {
    state.completed.push_back(trial_record_from(body));
  } else if (event.kind == event_kind::kTrialVoided) {
    const int index = trial_from(body).index;
    ++state.voided[index];
    std::erase(state.void_order, index);
    state.void_order.push_back(index);
  } else if (event.kind == event_kind::kTrialsShort) {
    state.abandoned.insert(trial_from(body).index);
  } else if (event.kind == event_kind::kPracticeEnded) {
    state.practice_ended = true;
  } else if (event.kind == event_kind::kQuestionAnswered) {
    const auto& condition = body.at("condition");
    state.answered.insert(question_key(body.at("question").get<std::string>(),
                                       condition.is_null() ? "" : condition.get<std::string>(),
                                       body.at("after_trial").get<int>()));
  } else if (event.kind == event_kind::kBreakTaken) {
    state.breaks_after.insert(body.at("after_trial").get<int>());
  }
  // Other kinds (session.resumed, notes) change nothing about what is still to do.
}

}  // namespace

SessionState replay(const std::vector<Event>& events) {
  SessionState state;
  for (const Event& event : events) {
    try {
      apply(event, nlohmann::ordered_json::parse(event.body), state);
    } catch (const StorageError& error) {
      throw StorageError(fmt::format("session {}, event {} ({}): {}; run jnd verify", event.session, event.seq,
                                     event.kind, error.what()));
    } catch (const nlohmann::json::exception& error) {
      throw StorageError(fmt::format("session {}, event {} ({}): the body cannot be read: {}; run jnd verify",
                                     event.session, event.seq, event.kind, error.what()));
    }
    state.last_monotonic_ns = event.stamp.monotonic_ns;
    state.last_utc_ns = event.stamp.utc_ns;
  }
  return state;
}

}  // namespace jnd
