#include "runner/session/trial_conductor.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "data/log/telemetry.h"
#include "data/log/trace_blob.h"
#include "devices/loop/telemetry_ring.h"
#include "protocols/condition_words.h"
#include "protocols/course/prescription.h"
#include "protocols/planning/specimen_codes.h"
#include "protocols/tasks/task.h"
#include "runner/session/device_health.h"
#include "runner/session/rig_connections.h"

namespace jnd {

namespace {

// Within a device's 0.05 .. 1 g, and weaker than the burst of any stimulus above 150 N/m.
constexpr double kTap_g = 0.5;
constexpr double kTap_s = 0.15;  // the burst of 100 ms, and its end

// A trial whose answers accept nothing after so many looks comes again.
constexpr int kMostLooks = 200;

// What the operator hands over.
HandOver specimens_of(const Trial& trial, const Intervals& stimuli, int interval, const Protocol& protocol,
                      const std::vector<std::string>& codes) {
  static constexpr std::array<const char*, 2> kSides = {"left", "right"};
  static constexpr std::array<const char*, kMostIntervals> kTurns = {"first", "second", "third"};
  const bool together = protocol.task.together;
  HandOver what;
  what.condition = condition_words(protocol.conditions[static_cast<std::size_t>(trial.condition)]);
  for (std::size_t i = 0; i < stimuli.size(); ++i) {
    if (!together && static_cast<int>(i) != interval) continue;
    what.items.push_back({together ? kSides[i] : stimuli.size() > 1 ? kTurns[i] : "", codes[i]});
  }
  return what;
}

bool saturated(const Presentation& presentation) {
  return std::any_of(presentation.fingers.begin(), presentation.fingers.end(),
                     [](const FingerPresentation& finger) { return finger.saturated_share > 0; });
}

}  // namespace

TrialConductor::TrialConductor(const SessionParts& parts, const CourseRecorder& recorder)
    : parts_(parts), recorder_(recorder) {
  parts_.rig.watch([this](const LoopSnapshot& snapshot) { parts_.view.health(health_of(snapshot)); });
}

TrialConductor::~TrialConductor() {
  parts_.rig.watch({});
}

void TrialConductor::get_ready(const Trial& trial, const TrialOutline& outline) {
  earliest_ns_ = std::max(earliest_ns_, parts_.rig.prepare(request_of({trial, outline, trial.stimuli}, 0)));
}

std::optional<double> TrialConductor::conduct(const Trial& trial, const TrialOutline& outline) {
  Attempt attempt{trial, outline, trial.stimuli};
  const Protocol& protocol = parts_.protocol;
  ticks_.clear();
  await_rig(parts_, recorder_, after_trial());
  // A stop that came meanwhile: nothing is presented before a person has cleared it.
  handle_interrupts(parts_, recorder_, after_trial());
  get_ready(trial, outline);  // a pause or a new start of the rig has undone it
  wait_out(parts_, recorder_, earliest_ns_, after_trial());
  recorder_.record_mark(TrialBegan{trial.index, outline.attempt},
                        {{"index", trial.index}, {"attempt", outline.attempt}});
  const std::int64_t began = parts_.clock.now_ns();
  TrialRecord record;
  record.trial = trial;
  record.attempt = outline.attempt;
  record.condition_name = protocol.conditions[static_cast<std::size_t>(trial.condition)].name;
  record.series_name = protocol.series[static_cast<std::size_t>(trial.series)].name;

  const Task& task = task_of(protocol.task.kind);
  record.presentations.resize(trial.stimuli.size());
  std::optional<Answer> answer;
  for (;;) {
    if (task.adjusts()) record.settings.push_back(attempt.stimuli[attempt.stimuli.size() - 1]);
    if (!present_all(attempt, record)) return std::nullopt;
    answer = ask(attempt, record);
    if (!answer) return std::nullopt;
    const std::optional<Intervals> moved = task.moved(attempt.stimuli, *answer, trial, protocol);
    if (!moved) break;
    attempt.stimuli = *moved;
    if (++attempt.look >= kMostLooks) {
      void_attempt(attempt, "not_accepted", {}, true);
      return std::nullopt;
    }
    if (!gap_passes(attempt, 0)) return std::nullopt;
  }
  answer = task.settled(*answer, attempt.stimuli);

  // An answer that was given is kept, also where a stop came with it.
  record.answer = *answer;
  if (!answer->number) record.answer_word = said_word(protocol.task, answer->said);
  record.duration_s = static_cast<double>(parts_.clock.now_ns() - began) * 1e-9;
  nlohmann::ordered_json body = to_body(record);
  if (!ticks_.empty()) body["telemetry"] = telemetry_body(ticks_);
  recorder_.record(TrialAnswered{record}, body, ticks_);
  ticks_.clear();
  // From here on the answer is safe; only now is anyone told.
  parts_.view.saved(outline, *answer);
  if (breaks_limit(record.breach)) parts_.view.off_prescription(outline);
  const Feedback feedback = trial.practice ? protocol.practice->feedback : protocol.feedback;
  const std::optional<bool> correct = is_correct(trial, *answer);
  if (feedback == Feedback::correctness && correct) parts_.view.feedback(*correct);
  wait_between_trials();
  return record.duration_s;
}

bool TrialConductor::present_all(const Attempt& attempt, TrialRecord& record) {
  const Protocol& protocol = parts_.protocol;
  ticks_.clear();
  // Together, all of it is one interval: what is felt of one place is felt of the other.
  const int intervals = felt_intervals(protocol.task);
  for (int interval = 0; interval < intervals; ++interval) {
    if (interval > 0 && !gap_passes(attempt, interval)) return false;
    if (!hand_over(attempt, interval)) return false;
    if (!cue(attempt, static_cast<CuePlace>(interval))) return false;
    Presentation& presentation = record.presentations[static_cast<std::size_t>(interval)];
    presentation = present(attempt, interval);
    if (voided_after(attempt, interval, presentation)) return false;
  }
  if (protocol.task.together) {
    Presentation &first = record.presentations[0], &second = record.presentations[1];
    second = first;
    second.delivered = std::exchange(first.delivered_beside, std::nullopt);
    second.delivered_beside.reset();
  }
  record.breach = breach_of(attempt.trial, record.presentations, protocol);
  const std::string against = rule_broken_by(record);
  if (against.empty()) return true;
  void_attempt(attempt, against, {}, true);
  return false;
}

std::string TrialConductor::rule_broken_by(const TrialRecord& record) const {
  const Protocol& protocol = parts_.protocol;
  if (protocol.stimulus.on_saturation == OnSaturation::repeat &&
      std::any_of(record.presentations.begin(), record.presentations.end(), saturated))
    return "saturated";
  const Condition& condition = protocol.conditions[static_cast<std::size_t>(record.trial.condition)];
  const Prescription* const prescription = prescription_of(protocol, condition);
  if (prescription != nullptr && prescription->on_breach == OnSaturation::repeat && breaks_limit(record.breach))
    return "off_prescription";
  return {};
}

std::optional<Answer> TrialConductor::ask(const Attempt& attempt, const TrialRecord& record) {
  if (!cue(attempt, CuePlace::question)) return std::nullopt;
  const TrialQuestion question{attempt.trial, attempt.outline.attempt, record.presentations,
                               parts_.protocol.timeline.answer_time_out_s, attempt.look};
  const std::optional<Answer> answer = parts_.responder.judge(question);
  if (!answer) voided_unanswered(attempt);
  return answer;
}

bool TrialConductor::voided_after(const Attempt& attempt, int interval, const Presentation& presentation) {
  // A stop that only makes way for a pause is no fault of the devices.
  const bool pausing = parts_.interrupts.pause && presentation.stopped_by == to_string(StopSource::signal);
  const bool device = presentation.fault != Fault::none && presentation.fault != Fault::no_contact;
  const bool counts = counts_as_attempt(parts_, presentation.fault);
  if (device && !pausing && parts_.record != RecordPolicy::off) {
    recorder_.append(event_kind::kDeviceFault,
                     device_fault_body(attempt.trial, attempt.outline.attempt, interval, presentation));
    note_connections(parts_, recorder_, "fault");
  }
  if (parts_.interrupts.end) {
    void_interrupted(attempt, "interrupted");
    throw SessionEnds{false, "signal", {}};
  }
  if (parts_.interrupts.pause) {  // the pause itself comes before the next trial
    void_attempt(attempt, "paused", {}, false);
    return true;
  }
  if (presentation.fault == Fault::none) return voided_on_request(attempt);
  void_attempt(attempt, std::string(to_string(presentation.fault)), {}, counts);
  if (presentation.fault == Fault::emergency_stop)
    recover_from_stop(parts_, recorder_, presentation.stopped_by, after_trial());
  return true;
}

bool TrialConductor::voided_on_request(const Attempt& attempt) {
  const OperatorRequest request = parts_.view.meanwhile();
  switch (request.kind) {
    case Request::repeat_trial:
      void_attempt(attempt, "repeated", request.text, true);
      return true;
    case Request::end_for_now:
    case Request::end_for_good:
      void_interrupted(attempt, "interrupted");
      throw SessionEnds{request.kind == Request::end_for_good, "operator", request.text};
    case Request::note:
      recorder_.note(request.text, after_trial());
      return false;
    default:
      return false;  // pauses, and what concerns other trials, wait for the next ready()
  }
}

bool TrialConductor::voided_by_interruption(const Attempt& attempt) {
  if (parts_.interrupts.end) {
    void_interrupted(attempt, "interrupted");
    throw SessionEnds{false, "signal", {}};
  }
  if (parts_.interrupts.pause) {
    void_attempt(attempt, "paused", {}, false);
    return true;
  }
  const StopSource source = parts_.rig.stop.source();
  if (source == StopSource::none) return false;
  void_attempt(attempt, std::string(to_string(Fault::emergency_stop)), {}, true);
  recover_from_stop(parts_, recorder_, std::string(to_string(source)), after_trial());
  return true;
}

// What the operator asks for meanwhile is seen to at once, and the rest of the gap passes after it.
bool TrialConductor::gap_passes(const Attempt& attempt, int next) {
  const std::int64_t over_ns = after_s(parts_.protocol.timeline.gap_s);
  const std::int64_t deadline_ns = std::max(over_ns, parts_.rig.prepare(request_of(attempt, next)));
  while (!wait_until(parts_, deadline_ns, OperatorHeard::in_gap))
    if (voided_by_interruption(attempt) || voided_on_request(attempt)) return false;
  return true;
}

void TrialConductor::voided_unanswered(const Attempt& attempt) {
  if (voided_by_interruption(attempt) || voided_on_request(attempt)) return;
  void_attempt(attempt, "no_answer", {}, true);
}

void TrialConductor::void_attempt(const Attempt& attempt, const std::string& reason, const std::string& words,
                                  bool counts) {
  log_void(attempt.trial, attempt.outline.attempt, reason, words, counts);
  const int used = recorder_.course().attempts_used(attempt.trial.index);
  parts_.view.voided(attempt.outline, reason, used < parts_.protocol.timeline.max_attempts);
  wait_between_trials();
}

void TrialConductor::void_interrupted(const Attempt& attempt, const std::string& reason) {
  parts_.rig.neutral();
  if (parts_.person) log_void(attempt.trial, attempt.outline.attempt, reason, {}, false);
}

void TrialConductor::log_void(const Trial& trial, int attempt, const std::string& reason, const std::string& words,
                              bool counts, bool anew) {
  nlohmann::ordered_json body = voided_body(parts_.protocol, trial, attempt, reason, counts);
  if (!words.empty()) body["words"] = words;
  if (anew) body["anew"] = true;
  if (!ticks_.empty()) body["telemetry"] = telemetry_body(ticks_);
  recorder_.record(TrialVoided{trial.index, attempt, counts, anew, reason == kTakenBack}, body, ticks_);
  ticks_.clear();
}

bool TrialConductor::hand_over(const Attempt& attempt, int interval) {
  const Protocol& protocol = parts_.protocol;
  if (protocol.rig.device != kSpecimenRig || !parts_.person) return true;
  const HandOver what = specimens_of(
      attempt.trial, attempt.stimuli, interval, protocol,
      specimen_codes(protocol, parts_.plan, attempt.trial.index, attempt.outline.attempt, attempt.stimuli));
  for (;;) {
    const OperatorRequest request = parts_.view.hand_over(what);
    if (request.kind == Request::go_on) return true;
    if (voided_by_interruption(attempt)) return false;
    switch (request.kind) {
      case Request::repeat_trial:
        void_attempt(attempt, "repeated", request.text, true);
        return false;
      case Request::end_for_now:
      case Request::end_for_good:
        void_interrupted(attempt, "interrupted");
        throw SessionEnds{request.kind == Request::end_for_good, "operator", request.text};
      case Request::note:
        recorder_.note(request.text, after_trial());
        break;
      default:
        break;
    }
  }
}

bool TrialConductor::cue(const Attempt& attempt, CuePlace place) {
  const Timeline& timeline = parts_.protocol.timeline;
  const bool question = place == CuePlace::question;
  const auto last = static_cast<int>(attempt.trial.stimuli.size()) - 1;
  const int interval = question ? last : static_cast<int>(place);
  const CueSignal& signal =
      question ? timeline.question_cue : timeline.interval_cues[static_cast<std::size_t>(interval)];
  parts_.view.cue(place, signal);
  if (signal.kind != "tap") return true;
  PresentRequest tap;
  tap.tap_g = kTap_g;
  tap.explore_s = kTap_s;
  tap.id = {attempt.trial.index, attempt.outline.attempt, interval};
  const Presentation given = parts_.rig.present(tap);
  if (TelemetryRing* ring = parts_.rig.telemetry()) {  // what is kept is the stimuli's
    std::vector<TickRecord> ticks;
    ring->drain(ticks);
    ring->take_dropped();
  }
  return given.fault == Fault::none || !voided_after(attempt, interval, given);
}

PresentRequest TrialConductor::request_of(const Attempt& attempt, int interval) const {
  const Protocol& protocol = parts_.protocol;
  const Timeline& timeline = protocol.timeline;
  const Trial& trial = attempt.trial;
  PresentRequest request;
  request.stimulus.stiffness = attempt.stimuli[static_cast<std::size_t>(interval)];
  const Condition& condition = protocol.conditions[static_cast<std::size_t>(trial.condition)];
  request.stimulus.cues = condition.cues;
  request.condition = &condition;
  request.of_standard = holds_standard(trial, attempt.stimuli, static_cast<std::size_t>(interval));
  if (protocol.task.together) {
    request.beside = attempt.stimuli[1];
    request.beside_of_standard = !request.of_standard;
  }
  request.explore_s = timeline.explore_s;
  request.contacts = timeline.interval_end == IntervalEnd::contacts ? timeline.contacts : 0;
  request.no_contact_time_out_s = timeline.no_contact_time_out_s;
  request.stimulus.damping_n_s_per_m = protocol.stimulus.damping_n_s_per_m;
  request.id = {trial.index, attempt.outline.attempt, interval};
  return request;
}

Presentation TrialConductor::present(const Attempt& attempt, int interval) {
  PresentRequest request = request_of(attempt, interval);
  if (parts_.protocol.timeline.interval_end == IntervalEnd::key) {
    request.enough = [this, id = request.id, began = parts_.clock.now_ns()] {
      return parts_.responder.enough(id, static_cast<double>(parts_.clock.now_ns() - began) * 1e-9);
    };
  }
  Presentation presentation = parts_.rig.present(request);
  parts_.view.health(health_of(presentation));  // first: it may tell of a stop
  keep_ticks(attempt.trial, interval, presentation);
  return presentation;
}

// Every tick of the interval, to be stored with the trial.
void TrialConductor::keep_ticks(const Trial& trial, int interval, const Presentation& presentation) {
  if (const Trace trace = parts_.rig.take_trace(); !trace.samples.empty() || trace.dropped > 0)
    ticks_.push_back(encode_trace(interval, trace));
  TelemetryRing* ring = parts_.rig.telemetry();
  if (ring == nullptr) return;
  Telemetry telemetry;
  telemetry.unit = trial.unit;
  telemetry.channels = telemetry_channels(presentation);
  telemetry.dropped = ring->take_dropped();
  ring->drain(telemetry.ticks);
  if (!telemetry.channels.empty()) ticks_.push_back(encode_telemetry(interval, telemetry));
}

std::int64_t TrialConductor::after_s(double seconds) const {
  return parts_.clock.now_ns() + static_cast<std::int64_t>(seconds * 1e9);
}

void TrialConductor::wait_between_trials() {
  earliest_ns_ = after_s(parts_.protocol.timeline.between_trials_s);
  (void)rested();
}

bool TrialConductor::rested() {
  return wait_until(parts_, earliest_ns_, OperatorHeard::between_trials);
}

}  // namespace jnd
