// One attempt at one trial: two presentations, a question, an answer that is committed before the view is told.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "data/log/event_body.h"
#include "runner/session/course_recorder.h"
#include "runner/session/session_parts.h"

namespace jnd {

class TrialConductor {
 public:
  // Both must outlive it.
  TrialConductor(const SessionParts& parts, const CourseRecorder& recorder);
  ~TrialConductor();
  TrialConductor(const TrialConductor&) = delete;
  TrialConductor& operator=(const TrialConductor&) = delete;

  // trial: with its stimuli known. Once rested(). How long it took, from the first cue to the answer; none where the
  // attempt was voided. Throws SessionEnds, StorageError.
  std::optional<double> conduct(const Trial& trial, const TrialOutline& outline);

  // Before READY: the rig gets ready for the first interval, so that what that takes shows in nothing. rested() then waits
  // for it too, for as long as this rig may take.
  void get_ready(const Trial& trial, const TrialOutline& outline);

  // Waits for what is left of the time between trials, also where something came first before. False: something does
  // again, which is to be seen to.
  bool rested();

  // trial.voided. reason: "no_answer", "saturated", "off_prescription", a fault, "repeated", "taken_back", "interrupted", ...; words: the
  // operator's. Of no attempt that is under way: take_back and the like, by the engine.
  void log_void(const Trial& trial, int attempt, const std::string& reason, const std::string& words, bool counts,
                bool anew = false);

 private:
  // The attempt under way.
  struct Attempt {
    const Trial& trial;
    const TrialOutline& outline;
    Intervals stimuli;  // of the trial, as answers have moved them
    int look = 0;       // how often they did
  };
  // All intervals, then the question. False, or no answer: the attempt was voided.
  bool present_all(const Attempt& attempt, TrialRecord& record);
  // Why the protocol has such a trial come again, before it is asked about; empty: it does not.
  std::string rule_broken_by(const TrialRecord& record) const;
  std::optional<Answer> ask(const Attempt& attempt, const TrialRecord& record);
  // A cue to the participant, on the devices where the protocol says tap. False: the tap failed, and the attempt was
  // voided.
  bool cue(const Attempt& attempt, CuePlace place);
  PresentRequest request_of(const Attempt& attempt, int interval) const;
  Presentation present(const Attempt& attempt, int interval);
  // Specimens of the interval into the participant's hands, of all intervals where they are felt together. False: the
  // attempt was voided.
  bool hand_over(const Attempt& attempt, int interval);
  void keep_ticks(const Trial& trial, int interval, const Presentation& presentation);
  // Why the attempt ends here: nothing, or it was voided.
  bool voided_after(const Attempt& attempt, int interval, const Presentation& presentation);
  bool voided_on_request(const Attempt& attempt);
  // By a signal or a stop, just now.
  bool voided_by_interruption(const Attempt& attempt);
  // The time between two intervals, in which the rig gets ready for the next. False: the attempt was voided.
  bool gap_passes(const Attempt& attempt, int next);
  void voided_unanswered(const Attempt& attempt);
  void void_attempt(const Attempt& attempt, const std::string& reason, const std::string& words, bool counts);
  // Felt, but ended by us: it comes again, and the log knows that it was felt.
  void void_interrupted(const Attempt& attempt, const std::string& reason);
  int after_trial() const noexcept { return recorder_.course().main_done(); }
  std::int64_t after_s(double seconds) const;  // of the session's clock
  void wait_between_trials();

  const SessionParts& parts_;
  const CourseRecorder& recorder_;
  std::vector<TelemetryBlob> ticks_;  // of the present trial's intervals
  std::int64_t earliest_ns_ = 0;      // of the next attempt, of the session's clock
};

}  // namespace jnd
