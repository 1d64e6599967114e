// Records to event bodies and back. The keys are part of the file format: data/README.md describes them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/log/session_log.h"
#include "protocols/course/session_state.h"
#include "protocols/protocol.h"
#include "protocols/vocabulary.h"

namespace jnd {

namespace event_kind {
inline constexpr std::string_view kStudyCreated = "study.created";  // in the chain of the study itself
inline constexpr std::string_view kSessionOpened = "session.opened";
inline constexpr std::string_view kSessionResumed = "session.resumed";
inline constexpr std::string_view kSessionClosed = "session.closed";
inline constexpr std::string_view kTrialCompleted = "trial.completed";
inline constexpr std::string_view kTrialVoided = "trial.voided";
inline constexpr std::string_view kTrialsShort = "trial.abandoned";   // attempts used up: its cell is short
inline constexpr std::string_view kPracticeEnded = "practice.ended";  // body: rounds, correct share, passed
inline constexpr std::string_view kQuestionAnswered = "questionnaire.answered";
inline constexpr std::string_view kBreakTaken = "break.taken";
inline constexpr std::string_view kDeviceFault = "device.fault";         // before the trial.voided that it causes
inline constexpr std::string_view kStopCleared = "device.stop_cleared";  // body: reason, as the operator gives it
inline constexpr std::string_view kTrialBegan = "trial.began";  // a mark: index, attempt; a person feels it from now on
inline constexpr std::string_view kBlockEnded =
    "block.ended";  // by the operator: block, practice, reason, trials (indices left)
inline constexpr std::string_view kPaused = "session.paused";  // cause ("key", "ctrl-c", "storage", "break"), reason
inline constexpr std::string_view kContinued = "session.continued";  // paused_s
inline constexpr std::string_view kSessionUnblinded =
    "session.unblinded";  // shown ("forces"): the operator sees what tells the stimuli, from now on
inline constexpr std::string_view kLeft = "session.left";  // ended by the operator: cause, reason, for_good
inline constexpr std::string_view kNote = "note";  // text, by, after_trial; in a session or in the study's chain
inline constexpr std::string_view kChecklist = "checklist.answered";   // question, text, answer
inline constexpr std::string_view kInstructed = "instructions.shown";  // id, language
inline constexpr std::string_view kConsent = "consent.given";          // language, text, by; or "refused": true
inline constexpr std::string_view kReadiness =
    "readiness.checked";  // items (what, verdict, found), blocked, overridden
inline constexpr std::string_view kExploration =
    "exploration.completed";  // index, block, condition, object, duration_s, ...
inline constexpr std::string_view kExplorationBegan = "exploration.began";    // a mark, as trial.began
inline constexpr std::string_view kExplorationVoided = "exploration.voided";  // index, attempt, reason
// In the chain of the study itself.
inline constexpr std::string_view kExcluded = "participant.excluded";  // participant, kind, reason, replace
inline constexpr std::string_view kUnblinded = "unblinded";            // reason
inline constexpr std::string_view kMerged = "study.merged";            // what came from where
inline constexpr std::string_view kRecovered = "study.recovered";      // from which damaged file, what was lost
inline constexpr std::string_view kReworded =
    "protocol.same_meaning";  // other bytes, equal documents: sha256 of the file used
inline constexpr std::string_view kConnections =
    "rig.connections";  // body: devices and tracker, as RigConnections; when (opened, fault, missing, back, closed)
inline constexpr std::string_view kCalibration =
    "rig.calibration";  // serial, calibration_id, certificate: word for word, or null where it was not found
inline constexpr std::string_view kRealtime = "rig.realtime";  // body: policy, items of what, ok, detail, why_not
}  // namespace event_kind

// The reason of a trial.voided that takes the last answer back, by the operator's word.
inline constexpr std::string_view kTakenBack = "taken_back";

nlohmann::ordered_json to_body(const TrialRecord& record);          // trial.completed
TrialRecord trial_record_from(const nlohmann::ordered_json& body);  // throws StorageError
Trial trial_from(const nlohmann::ordered_json& body);  // of a completed, voided or abandoned trial; throws StorageError
// Of any finger in either interval, 0..1: what the analysis plan's saturation rule looks at.
double largest_saturated_share(const TrialRecord& record) noexcept;
// trial.voided: the trial with its attempt and the reason ("stale_pose", "no_answer", "saturated", ...).
// counts: whether it uses up one of the trial's attempts; interruptions, and blocks and practice that come again, do
// not.
nlohmann::ordered_json voided_body(const Trial& trial, int attempt, std::string_view reason, bool counts = true);
// The same with the names of its condition and series, which the view `voided` shows.
nlohmann::ordered_json voided_body(const Protocol& protocol, const Trial& trial, int attempt, std::string_view reason,
                                   bool counts = true);
// device.fault: why the presentation of `interval` (0 or 1) stopped, who stopped it, and presentation.last_ticks.
nlohmann::ordered_json device_fault_body(const Trial& trial, int attempt, int interval,
                                         const Presentation& presentation);
nlohmann::ordered_json question_body(std::string_view id, std::string_view when, std::string_view condition,
                                     const std::optional<std::string>& answer, int after_trial);
// The same with the question's text and kind, so that the log can be read without the protocol.
nlohmann::ordered_json question_body(const Question& question, std::string_view condition,
                                     const std::optional<std::string>& answer, int after_trial);
std::string_view to_string(Question::When when) noexcept;
std::string_view to_string(Question::Kind kind) noexcept;

// The text of a body as it is stored. Text that is not UTF-8 keeps its readable part (U+FFFD for the rest).
std::string body_text(const nlohmann::ordered_json& body);

}  // namespace jnd
