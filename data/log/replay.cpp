#include "data/log/replay.h"

#include <string>
#include <type_traits>
#include <variant>

#include <fmt/format.h>

#include "data/log/body_numbers.h"
#include "data/log/event_body.h"
#include "data/log/storage_error.h"
#include "protocols/input/json_text.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

// Empty where there is none, or null.
std::string text_at(const Json& body, const char* key) {
  const auto found = body.find(key);
  return found != body.end() && found->is_string() ? found->get<std::string>() : std::string();
}

template <typename Event>
struct Logged;  // as which kind, and how its body is read

template <>
struct Logged<SessionOpened> {
  static constexpr std::string_view kKind = event_kind::kSessionOpened;
  static SessionOpened from(const Json& body) { return {text_at(body, "boot_id")}; }
};
template <>
struct Logged<SessionResumed> {
  static constexpr std::string_view kKind = event_kind::kSessionResumed;
  static SessionResumed from(const Json& body) {
    return {text_at(body, "boot_id"), body.value("redo_block", false), body.value("practice_again", false)};
  }
};
template <>
struct Logged<SessionClosed> {
  static constexpr std::string_view kKind = event_kind::kSessionClosed;
  static SessionClosed from(const Json&) { return {}; }
};
template <>
struct Logged<SessionLeft> {
  static constexpr std::string_view kKind = event_kind::kLeft;
  static SessionLeft from(const Json& body) { return {body.value("for_good", false)}; }
};
template <>
struct Logged<ItemChecked> {
  static constexpr std::string_view kKind = event_kind::kChecklist;
  static ItemChecked from(const Json& body) { return {text_at(body, "question")}; }
};
template <>
struct Logged<InstructionShown> {
  static constexpr std::string_view kKind = event_kind::kInstructed;
  static InstructionShown from(const Json& body) { return {body.at("id").get<std::string>()}; }
};
template <>
struct Logged<ConsentAsked> {
  static constexpr std::string_view kKind = event_kind::kConsent;
  static ConsentAsked from(const Json& body) { return {!body.value("refused", false)}; }
};
template <>
struct Logged<QuestionAnswered> {
  static constexpr std::string_view kKind = event_kind::kQuestionAnswered;
  static QuestionAnswered from(const Json& body) {
    const Json& condition = body.at("condition");
    return {question_key(body.at("question").get<std::string>(),
                         condition.is_null() ? "" : condition.get<std::string>(), whole_at(body, "after_trial"))};
  }
};
template <>
struct Logged<BreakTaken> {
  static constexpr std::string_view kKind = event_kind::kBreakTaken;
  static BreakTaken from(const Json& body) { return {whole_at(body, "after_trial")}; }
};
template <>
struct Logged<TrialBegan> {
  static constexpr std::string_view kKind = event_kind::kTrialBegan;
  static TrialBegan from(const Json& body) { return {whole_at(body, "index"), whole_at(body, "attempt")}; }
};
template <>
struct Logged<TrialAnswered> {
  static constexpr std::string_view kKind = event_kind::kTrialCompleted;
  static TrialAnswered from(const Json& body) { return {trial_record_from(body)}; }
};
template <>
struct Logged<TrialVoided> {
  static constexpr std::string_view kKind = event_kind::kTrialVoided;
  static TrialVoided from(const Json& body) {
    return {trial_from(body).index, whole_at(body, "attempt"), body.value("counts", true), body.value("anew", false),
            text_at(body, "reason") == kTakenBack};
  }
};
template <>
struct Logged<TrialGivenUp> {
  static constexpr std::string_view kKind = event_kind::kTrialsShort;
  static TrialGivenUp from(const Json& body) { return {trial_from(body).index}; }
};
template <>
struct Logged<BlockEnded> {
  static constexpr std::string_view kKind = event_kind::kBlockEnded;
  static BlockEnded from(const Json& body) {
    BlockEnded event;
    for (const Json& index : body.at("trials")) event.trials.push_back(whole(index));
    event.practice = body.value("practice", false);
    return event;
  }
};
template <>
struct Logged<PracticeEnded> {
  static constexpr std::string_view kKind = event_kind::kPracticeEnded;
  static PracticeEnded from(const Json&) { return {}; }
};
template <>
struct Logged<ExplorationBegan> {
  static constexpr std::string_view kKind = event_kind::kExplorationBegan;
  static ExplorationBegan from(const Json& body) { return {whole_at(body, "index"), whole_at(body, "attempt")}; }
};
template <>
struct Logged<ExplorationEnded> {
  static constexpr std::string_view kKind = event_kind::kExploration;
  static ExplorationEnded from(const Json& body) { return {whole_at(body, "index"), whole_at(body, "attempt")}; }
};
template <>
struct Logged<ExplorationVoided> {
  static constexpr std::string_view kKind = event_kind::kExplorationVoided;
  static ExplorationVoided from(const Json& body) {
    return {whole_at(body, "index"), whole_at(body, "attempt"), body.value("counts", true),
            body.value("will_repeat", true)};
  }
};

// Tries every alternative of the variant in turn.
template <typename... Events>
std::optional<CourseEvent> first_of(std::string_view kind, const Json& body, const std::variant<Events...>*) {
  std::optional<CourseEvent> event;
  (void)((Logged<Events>::kKind == kind && (event = Logged<Events>::from(body), true)) || ...);
  return event;
}

}  // namespace

std::string_view kind_of(const CourseEvent& event) noexcept {
  return std::visit([](const auto& one) { return Logged<std::decay_t<decltype(one)>>::kKind; }, event);
}

std::optional<CourseEvent> course_event_from(std::string_view kind, const Json& body) {
  return first_of(kind, body, static_cast<const CourseEvent*>(nullptr));
}

SessionState replay(const std::vector<Event>& events) {
  SessionState state;
  for (const Event& event : events) {
    try {
      if (const auto change = course_event_from(event.kind, json_from(event.body))) jnd::apply(*change, state);
    } catch (const StorageError& error) {
      throw StorageError(fmt::format("session {}, event {} ({}): {}; run jnd verify", event.session, event.seq,
                                     event.kind, error.what()));
    } catch (const nlohmann::json::exception& error) {
      throw StorageError(fmt::format("session {}, event {} ({}): the body cannot be read: {}; run jnd verify",
                                     event.session, event.seq, event.kind, error.what()));
    }
    state.left = event.kind == event_kind::kLeft;
    state.last_monotonic_ns = event.stamp.monotonic_ns;
    state.last_utc_ns = event.stamp.utc_ns;
  }
  return state;
}

}  // namespace jnd
