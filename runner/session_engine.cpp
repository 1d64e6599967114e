#include "runner/session_engine.h"

#include <algorithm>
#include <optional>

#include "data/telemetry.h"
#include "devices/telemetry_ring.h"
#include "protocols/random_stream.h"

namespace jnd {

namespace {

constexpr double kAssumedTrialOverhead_s = 4;  // before any trial was timed: reaching, cues and the answer

bool saturated(const Presentation& presentation) {
  return std::any_of(presentation.fingers.begin(), presentation.fingers.end(),
                     [](const FingerPresentation& finger) { return finger.saturated_share > 0; });
}

}  // namespace

std::vector<std::string> condition_codes(const Protocol& protocol, std::uint64_t seed) {
  std::vector<std::string> codes;
  for (std::size_t i = 0; i < protocol.conditions.size(); ++i)
    codes.emplace_back(1, static_cast<char>('A' + static_cast<int>(i)));
  RandomStream(seed, 0, "condition codes").shuffle(codes);
  return codes;
}

SessionEngine::SessionEngine(const Protocol& protocol, const Plan& plan, Rig& rig, Responder& responder,
                             SessionLog& log, Clock& clock, SessionView& view, const std::atomic<bool>& stop,
                             RecordPolicy record)
    : protocol_(protocol),
      plan_(plan),
      rig_(rig),
      responder_(responder),
      log_(log),
      clock_(clock),
      view_(view),
      stop_(stop),
      record_(record),
      adaptive_(protocol),
      codes_(condition_codes(protocol, plan.seed)),
      main_total_(main_trial_count(plan)) {
  for (const Trial& trial : plan.trials) blocks_ = std::max(blocks_, trial.block);
}

SessionEnd SessionEngine::run(const SessionState& state) {
  state_ = state;
  adaptive_ = AdaptiveRun(protocol_);
  finished_ = {state_.abandoned.begin(), state_.abandoned.end()};
  for (const TrialRecord& record : state_.completed) remember(record);
  main_done_ = static_cast<int>(std::count_if(plan_.trials.begin(), plan_.trials.end(), [&](const Trial& trial) {
    return !trial.practice && finished_.contains(trial.index);
  }));
  try {
    ask(Question::When::before_session, -1, 0);
    run_practice();
    run_main();
    ask(Question::When::after_session, -1, 0);
  } catch (const Interrupted&) {
    rig_.neutral();
    return SessionEnd::interrupted;
  } catch (...) {
    rig_.neutral();
    throw;
  }
  rig_.neutral();
  return SessionEnd::completed;
}

void SessionEngine::ask(Question::When when, int condition, int after_trial) {
  for (const Question& question : protocol_.questions) {
    if (question.when != when) continue;
    if (question.per_condition) {
      for (int i = 0; i < static_cast<int>(protocol_.conditions.size()); ++i) ask_one(question, i, after_trial);
    } else {
      ask_one(question, condition, after_trial);
    }
  }
}

void SessionEngine::ask_one(const Question& question, int condition, int after_trial) {
  const std::string name = condition < 0 ? "" : protocol_.conditions[static_cast<std::size_t>(condition)].name;
  const std::string key = question_key(question.id, name, after_trial);
  if (state_.answered.contains(key)) return;
  const std::optional<std::string> answer = responder_.reply(question, condition);
  if (stop_ || (!answer && question.required)) throw Interrupted{};
  log_.append(event_kind::kQuestionAnswered, question_body(question, name, answer, after_trial), stamp());
  state_.answered.insert(key);
}

void SessionEngine::run_practice() {
  if (!protocol_.practice || state_.practice_ended) return;
  const Practice& practice = *protocol_.practice;
  for (int round = 1; round <= practice.max_rounds; ++round) {
    std::vector<Trial> trials;
    for (const Trial& trial : plan_.trials)
      if (trial.practice && trial.round == round) trials.push_back(trial);
    run_block(open_trials(trials));
    const RoundTally tally = practice_[round];
    const double share = trials.empty() ? 0 : static_cast<double>(tally.correct) / static_cast<double>(trials.size());
    const bool passed = share >= practice.criterion_correct;
    if (!passed && round < practice.max_rounds) continue;
    log_.append(event_kind::kPracticeEnded, {{"rounds", round}, {"share_correct", share}, {"passed", passed}}, stamp());
    state_.practice_ended = true;
    view_.practice_over(round, share, passed);
    return;
  }
}

void SessionEngine::run_main() {
  for (auto first = plan_.trials.begin(); first != plan_.trials.end();) {
    const auto end = std::find_if(first, plan_.trials.end(), [&](const Trial& t) { return t.block != first->block; });
    if (!first->practice) {
      const std::vector<Trial> block(first, end);
      const bool series_over = end == plan_.trials.end() || end->series != first->series;
      run_block(open_trials(block));
      // How many main trials the plan has had by the end of this block: the place that keys questions and breaks, the
      // same however many trials were repeated or given up.
      const int planned =
          static_cast<int>(std::count_if(plan_.trials.begin(), end, [](const Trial& t) { return !t.practice; }));
      if (protocol_.design.arrangement == Arrangement::blocked)
        ask(Question::When::after_condition, block.back().condition, planned);
      if (series_over) ask(Question::When::after_series, -1, planned);
      if (end != plan_.trials.end()) take_breaks(planned, series_over);
    }
    first = end;
  }
}

// The trials of a block that are still to do: those never tried in the planned order, then the voided ones in the order
// in which they failed.
std::deque<Trial> SessionEngine::open_trials(const std::vector<Trial>& block) const {
  const auto done = [&](const Trial& trial) { return finished_.contains(trial.index); };
  std::deque<Trial> queue;
  for (const Trial& trial : block)
    if (!done(trial) && attempts_voided(trial.index) == 0) queue.push_back(trial);
  for (const int index : state_.void_order)
    for (const Trial& trial : block)
      if (trial.index == index && !done(trial)) queue.push_back(trial);
  return queue;
}

void SessionEngine::run_block(std::deque<Trial> queue) {
  drop_ended_tracks(queue);
  while (!queue.empty()) {
    const Trial planned = queue.front();
    const Trial trial = adaptive_.resolved(planned);  // an adaptive level is known when its turn comes
    queue.pop_front();
    if (attempts_voided(trial.index) >= protocol_.timeline.max_attempts)
      give_up(trial);
    else if (conduct(trial, outline_of(trial)) == TrialEnd::voided)
      queue.push_back(planned);
    drop_ended_tracks(queue);
    if (!trial.practice && !queue.empty()) take_breaks_within_block();
  }
}

// A track that has its reversals leaves the slots that were planned for it.
void SessionEngine::drop_ended_tracks(std::deque<Trial>& queue) const {
  std::erase_if(queue, [&](const Trial& trial) { return adaptive_.over(trial); });
}

// Main trials still to come; at most so many where the answers may end a track.
int SessionEngine::main_left() const {
  if (!protocol_.design.procedure) return main_total_ - main_done_;
  return static_cast<int>(std::count_if(plan_.trials.begin(), plan_.trials.end(), [&](const Trial& trial) {
    return !trial.practice && !finished_.contains(trial.index) && !adaptive_.over(trial);
  }));
}

// Attempts used up: the cell stays short, and the log says so.
void SessionEngine::give_up(const Trial& trial) {
  log_.append(event_kind::kTrialsShort, voided_body(protocol_, trial, attempts_voided(trial.index), "attempts used up"),
              stamp());
  finished_.insert(trial.index);
  if (!trial.practice) ++main_done_;
}

void SessionEngine::remember(const TrialRecord& record) {
  finished_.insert(record.trial.index);
  adaptive_.answered(record.trial, record.answer.judgement);
  if (!record.trial.practice) return;
  RoundTally& tally = practice_[record.trial.round];
  ++tally.answered;
  tally.correct += record.trial.same == (record.answer.judgement == Judgement::same) ? 1 : 0;
}

SessionEngine::TrialEnd SessionEngine::conduct(const Trial& trial, const TrialOutline& outline) {
  check_stop();
  if (!view_.ready(outline)) throw Interrupted{};
  const std::int64_t began = clock_.now_ns();
  ticks_.clear();
  TrialRecord record;
  record.trial = trial;
  record.attempt = outline.attempt;
  record.condition_name = protocol_.conditions[static_cast<std::size_t>(trial.condition)].name;
  record.series_name = protocol_.series[static_cast<std::size_t>(trial.series)].name;

  for (int interval = 0; interval < 2; ++interval) {
    if (interval == 1) sleep_s(protocol_.timeline.gap_s);
    record.presentations[static_cast<std::size_t>(interval)] = present(trial, outline.attempt, interval);
    const Presentation& presentation = record.presentations[static_cast<std::size_t>(interval)];
    note_fault(trial, outline.attempt, interval, presentation);
    check_stop();
    if (presentation.fault != Fault::none) {
      const TrialEnd end = void_trial(trial, outline, std::string(to_string(presentation.fault)));
      if (presentation.fault == Fault::emergency_stop) recover_from_stop(presentation.stopped_by);
      return end;
    }
  }
  if (protocol_.stimulus.on_saturation == OnSaturation::repeat &&
      (saturated(record.presentations[0]) || saturated(record.presentations[1])))
    return void_trial(trial, outline, "saturated");

  view_.cue(CuePlace::question, protocol_.timeline.question_cue);
  const TrialQuestion question{trial, outline.attempt, record.presentations, protocol_.timeline.answer_time_out_s};
  const std::optional<Answer> answer = responder_.judge(question);
  if (!answer) {
    check_stop();
    const StopSource source = rig_.stop.source();
    if (source == StopSource::none) return void_trial(trial, outline, "no_answer");
    const TrialEnd end = void_trial(trial, outline, std::string(to_string(Fault::emergency_stop)));
    recover_from_stop(std::string(to_string(source)));
    return end;
  }
  // An answer that was given is kept, also where a stop came with it.

  record.answer = *answer;
  record.duration_s = static_cast<double>(clock_.now_ns() - began) * 1e-9;
  append_trial(event_kind::kTrialCompleted, to_body(record));
  // From here on the answer is safe; only now is anyone told.
  view_.saved(outline, *answer);
  remember(record);
  if (!trial.practice) ++main_done_;
  seconds_in_trials_ += record.duration_s;
  ++trials_timed_;
  const Feedback feedback = trial.practice ? protocol_.practice->feedback : protocol_.feedback;
  if (feedback == Feedback::correctness) view_.feedback(trial.same == (answer->judgement == Judgement::same));
  sleep_s(protocol_.timeline.between_trials_s);
  return TrialEnd::answered;
}

// A stop's cause, and the ticks that led to it.
void SessionEngine::note_fault(const Trial& trial, int attempt, int interval, const Presentation& presentation) {
  if (record_ == RecordPolicy::off) return;
  if (presentation.fault == Fault::none || presentation.fault == Fault::no_contact) return;
  log_.append(event_kind::kDeviceFault, device_fault_body(trial, attempt, interval, presentation), stamp());
}

// Only a person's word clears the latch.
void SessionEngine::recover_from_stop(const std::string& stopped_by) {
  if (!view_.recover(stopped_by)) throw Interrupted{};
  rig_.stop.clear();
  log_.append(event_kind::kStopCleared, {{"stopped_by", stopped_by}, {"reason", "cleared by the operator"}}, stamp());
}

SessionEngine::TrialEnd SessionEngine::void_trial(const Trial& trial, const TrialOutline& outline,
                                                  const std::string& reason) {
  append_trial(event_kind::kTrialVoided, voided_body(protocol_, trial, outline.attempt, reason));
  ++state_.voided[trial.index];
  view_.voided(outline, reason, attempts_voided(trial.index) < protocol_.timeline.max_attempts);
  sleep_s(protocol_.timeline.between_trials_s);
  return TrialEnd::voided;
}

Presentation SessionEngine::present(const Trial& trial, int attempt, int interval) {
  const Timeline& timeline = protocol_.timeline;
  view_.cue(interval == 0 ? CuePlace::first : CuePlace::second,
            interval == 0 ? timeline.first_cue : timeline.second_cue);
  PresentRequest request;
  request.stimulus.stiffness = trial.stimuli[static_cast<std::size_t>(interval)];
  request.stimulus.cues = protocol_.conditions[static_cast<std::size_t>(trial.condition)].cues;
  request.explore_s = timeline.explore_s;
  request.no_contact_time_out_s = timeline.no_contact_time_out_s;
  request.stimulus.damping_n_s_per_m = protocol_.stimulus.damping_n_s_per_m;
  request.id = {trial.index, attempt, interval};
  Presentation presentation = rig_.present(request);
  keep_ticks(trial, interval, presentation);
  return presentation;
}

// Every tick of the interval, to be stored with the trial.
void SessionEngine::keep_ticks(const Trial& trial, int interval, const Presentation& presentation) {
  TelemetryRing* ring = rig_.telemetry();
  if (ring == nullptr) return;
  Telemetry telemetry;
  telemetry.unit = trial.unit;
  telemetry.channels = telemetry_channels(presentation);
  telemetry.dropped = ring->take_dropped();
  ring->drain(telemetry.ticks);
  if (!telemetry.channels.empty()) ticks_.push_back(encode_telemetry(interval, telemetry));
}

// A trial's event and its ticks are one transaction.
void SessionEngine::append_trial(std::string_view kind, nlohmann::ordered_json body) {
  if (!ticks_.empty()) body["telemetry"] = telemetry_body(ticks_);
  log_.append(kind, body, stamp(), ticks_);
  ticks_.clear();
}

void SessionEngine::take_breaks_within_block() {
  for (const Break& pause : protocol_.breaks)
    if (pause.after == Break::After::trials && main_done_ > 0 && main_done_ % pause.trials == 0)
      take_break(pause, main_done_);
}

void SessionEngine::take_breaks(int planned, bool series_over) {
  for (const Break& pause : protocol_.breaks) {
    const bool due = pause.after == Break::After::block || (pause.after == Break::After::series && series_over) ||
                     (pause.after == Break::After::trials && planned % pause.trials == 0);
    if (due) {
      take_break(pause, planned);
      return;  // one break at one place, the first that the protocol names
    }
  }
}

void SessionEngine::take_break(const Break& pause, int after_trial) {
  if (state_.breaks_after.contains(after_trial)) return;
  check_stop();
  const std::int64_t began = clock_.now_ns();
  view_.break_begins(pause);
  if (!view_.break_over(pause)) throw Interrupted{};
  const std::int64_t least = began + static_cast<std::int64_t>(pause.duration_s * 1e9);
  clock_.sleep_until_ns(least);
  log_.append(event_kind::kBreakTaken,
              {{"after_trial", after_trial}, {"duration_s", static_cast<double>(clock_.now_ns() - began) * 1e-9}},
              stamp());
  state_.breaks_after.insert(after_trial);
}

TrialOutline SessionEngine::outline_of(const Trial& trial) const {
  const int left = main_left();
  TrialOutline outline;
  outline.practice = trial.practice;
  outline.round = trial.round;
  outline.attempt = attempts_voided(trial.index) + 1;
  outline.block = trial.block;
  outline.blocks = blocks_;
  outline.condition_code = codes_[static_cast<std::size_t>(trial.condition)];
  if (trial.practice) {
    outline.total = protocol_.practice->trials;
    const auto tally = practice_.find(trial.round);
    outline.number = 1 + (tally == practice_.end() ? 0 : tally->second.answered);
  } else {
    outline.number = main_done_ + 1;
    outline.total = main_done_ + left;
    outline.at_most = protocol_.design.procedure && protocol_.design.procedure->reversals > 0;
  }
  const Timeline& timeline = protocol_.timeline;
  const double pace = trials_timed_ > 0 ? seconds_in_trials_ / trials_timed_
                                        : 2 * timeline.explore_s + timeline.gap_s + kAssumedTrialOverhead_s;
  outline.time_left_s = left * (pace + timeline.between_trials_s);
  return outline;
}

int SessionEngine::attempts_voided(int index) const {
  const auto found = state_.voided.find(index);
  return found == state_.voided.end() ? 0 : found->second;
}

void SessionEngine::sleep_s(double seconds) {
  clock_.sleep_until_ns(clock_.now_ns() + static_cast<std::int64_t>(seconds * 1e9));
}

void SessionEngine::check_stop() const {
  if (stop_) throw Interrupted{};
}

Stamp SessionEngine::stamp() const {
  return {clock_.utc_ns(), clock_.now_ns()};
}

}  // namespace jnd
