// One session, from the first question to the last: the same engine for people and for simulated participants.
//
// The engine owns nothing durable. Every answer is one committed event, and the state it starts from is a replay of the
// events so far: kill it anywhere, run it again with the replayed state, and it goes on at the next unanswered trial.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <unordered_set>
#include <vector>

#include "data/event_body.h"
#include "data/session_log.h"
#include "devices/clock.h"
#include "devices/responder.h"
#include "devices/rig.h"
#include "protocols/adaptive_run.h"
#include "protocols/plan.h"
#include "protocols/protocol.h"
#include "runner/record_policy.h"
#include "runner/session_view.h"

namespace jnd {

enum class SessionEnd {
  completed,   // everything asked and answered; the caller closes the session
  interrupted  // the operator or a signal ended it; resumable
};

class SessionEngine {
 public:
  // All references must outlive the engine. stop: set from a signal handler or another thread.
  SessionEngine(const Protocol& protocol, const Plan& plan, Rig& rig, Responder& responder, SessionLog& log,
                Clock& clock, SessionView& view, const std::atomic<bool>& stop,
                RecordPolicy record = RecordPolicy::events);

  // state: replay of the log's events. Throws StorageError where an event cannot be written (nothing is lost: what was
  // said to be saved is saved).
  SessionEnd run(const SessionState& state);

 private:
  enum class TrialEnd { answered, voided };
  struct Interrupted {};  // unwinds to run()

  void ask(Question::When when, int condition, int after_trial);
  void ask_one(const Question& question, int condition, int after_trial);
  void run_practice();
  void run_main();
  void run_block(std::deque<Trial> queue);
  TrialEnd conduct(const Trial& trial, const TrialOutline& outline);
  Presentation present(const Trial& trial, int attempt, int interval);
  void keep_ticks(const Trial& trial, int interval, const Presentation& presentation);
  void append_trial(std::string_view kind, nlohmann::ordered_json body);
  void note_fault(const Trial& trial, int attempt, int interval, const Presentation& presentation);
  void recover_from_stop(const std::string& stopped_by);
  TrialEnd void_trial(const Trial& trial, const TrialOutline& outline, const std::string& reason);
  void give_up(const Trial& trial);
  void remember(const TrialRecord& record);
  void take_breaks_within_block();
  void take_breaks(int planned, bool series_over);
  void take_break(const Break& pause, int after_trial);
  void drop_ended_tracks(std::deque<Trial>& queue) const;
  int main_left() const;
  std::deque<Trial> open_trials(const std::vector<Trial>& block) const;
  TrialOutline outline_of(const Trial& trial) const;
  void sleep_s(double seconds);
  void check_stop() const;
  Stamp stamp() const;
  int attempts_voided(int index) const;

  const Protocol& protocol_;
  const Plan& plan_;
  Rig& rig_;
  Responder& responder_;
  SessionLog& log_;
  Clock& clock_;
  SessionView& view_;
  const std::atomic<bool>& stop_;
  RecordPolicy record_;

  SessionState state_;
  AdaptiveRun adaptive_;
  std::unordered_set<int> finished_;  // indices of trials answered or given up
  struct RoundTally {
    int answered = 0, correct = 0;
  };
  std::map<int, RoundTally> practice_;  // by round
  std::vector<std::string> codes_;      // of the conditions
  int main_total_ = 0;
  int main_done_ = 0;  // answered or given up
  int blocks_ = 0;
  std::vector<TelemetryBlob> ticks_;  // of the present trial's intervals
  double seconds_in_trials_ = 0;      // of this run, for the time left
  int trials_timed_ = 0;
};

// Letters for the conditions, dealt by the study's seed, so that the console gives nothing away.
std::vector<std::string> condition_codes(const Protocol& protocol, std::uint64_t seed);

}  // namespace jnd
