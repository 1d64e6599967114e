#include "runner/session/trial_conductor.h"

#include <algorithm>
#include <optional>

#include "data/log/telemetry.h"
#include "devices/loop/telemetry_ring.h"
#include "runner/session/device_health.h"
#include "runner/session/rig_connections.h"

namespace jnd {

namespace {

// Within a device's 0.05 .. 1 g, and weaker than the burst of any stimulus above 150 N/m.
constexpr double kTap_g = 0.5;
constexpr double kTap_s = 0.15;  // the burst of 100 ms, and its end

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

std::optional<double> TrialConductor::conduct(const Trial& trial, const TrialOutline& outline) {
  const Attempt attempt{trial, outline};
  const Protocol& protocol = parts_.protocol;
  ticks_.clear();
  await_rig(parts_, recorder_, after_trial());
  // A stop that came meanwhile: nothing is presented before a person has cleared it.
  handle_interrupts(parts_, recorder_, after_trial());
  recorder_.record_mark(TrialBegan{trial.index, outline.attempt},
                        {{"index", trial.index}, {"attempt", outline.attempt}});
  const std::int64_t began = parts_.clock.now_ns();
  TrialRecord record;
  record.trial = trial;
  record.attempt = outline.attempt;
  record.condition_name = protocol.conditions[static_cast<std::size_t>(trial.condition)].name;
  record.series_name = protocol.series[static_cast<std::size_t>(trial.series)].name;

  for (int interval = 0; interval < 2; ++interval) {
    if (interval == 1 && !wait_until(parts_, after_s(protocol.timeline.gap_s)) && voided_by_interruption(attempt))
      return std::nullopt;
    if (!cue(attempt, interval == 0 ? CuePlace::first : CuePlace::second)) return std::nullopt;
    Presentation& presentation = record.presentations[static_cast<std::size_t>(interval)];
    presentation = present(attempt, interval);
    if (voided_after(attempt, interval, presentation)) return std::nullopt;
  }
  if (protocol.stimulus.on_saturation == OnSaturation::repeat &&
      (saturated(record.presentations[0]) || saturated(record.presentations[1]))) {
    void_attempt(attempt, "saturated", {}, true);
    return std::nullopt;
  }

  if (!cue(attempt, CuePlace::question)) return std::nullopt;
  const TrialQuestion question{trial, outline.attempt, record.presentations, protocol.timeline.answer_time_out_s};
  const std::optional<Answer> answer = parts_.responder.judge(question);
  if (!answer) {
    voided_unanswered(attempt);
    return std::nullopt;
  }
  // An answer that was given is kept, also where a stop came with it.
  record.answer = *answer;
  record.duration_s = static_cast<double>(parts_.clock.now_ns() - began) * 1e-9;
  nlohmann::ordered_json body = to_body(record);
  if (!ticks_.empty()) body["telemetry"] = telemetry_body(ticks_);
  recorder_.record(TrialAnswered{record}, body, ticks_);
  ticks_.clear();
  // From here on the answer is safe; only now is anyone told.
  parts_.view.saved(outline, *answer);
  const Feedback feedback = trial.practice ? protocol.practice->feedback : protocol.feedback;
  if (feedback == Feedback::correctness) parts_.view.feedback(trial.same == (answer->judgement == Judgement::same));
  wait_between_trials();
  return record.duration_s;
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

bool TrialConductor::cue(const Attempt& attempt, CuePlace place) {
  const Timeline& timeline = parts_.protocol.timeline;
  const CueSignal& signal = place == CuePlace::first    ? timeline.first_cue
                            : place == CuePlace::second ? timeline.second_cue
                                                        : timeline.question_cue;
  const int interval = place == CuePlace::first ? 0 : 1;
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

Presentation TrialConductor::present(const Attempt& attempt, int interval) {
  const Protocol& protocol = parts_.protocol;
  const Timeline& timeline = protocol.timeline;
  const Trial& trial = attempt.trial;
  PresentRequest request;
  request.stimulus.stiffness = trial.stimuli[static_cast<std::size_t>(interval)];
  request.stimulus.cues = protocol.conditions[static_cast<std::size_t>(trial.condition)].cues;
  request.explore_s = timeline.explore_s;
  request.no_contact_time_out_s = timeline.no_contact_time_out_s;
  request.stimulus.damping_n_s_per_m = protocol.stimulus.damping_n_s_per_m;
  request.id = {trial.index, attempt.outline.attempt, interval};
  Presentation presentation = parts_.rig.present(request);
  keep_ticks(trial, interval, presentation);
  parts_.view.health(health_of(presentation));
  return presentation;
}

// Every tick of the interval, to be stored with the trial.
void TrialConductor::keep_ticks(const Trial& trial, int interval, const Presentation& presentation) {
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
  return wait_until(parts_, earliest_ns_, OperatorHeard::yes);
}

}  // namespace jnd
