// The levels of one session under an adaptive procedure: a pure function of protocol and answers so far, so that a
// session that is taken up again, and a check of one long after, find the same.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocols/protocol.h"

namespace jnd {

// The JND by the posterior of the Bayesian procedure at one moment: exp of the mean of ln s, and its middle 95 %.
struct TrackPosterior {
  double jnd = 0, low = 0, high = 0;
};

// What one track has come to.
struct AdaptiveTrack {
  int condition = 0;  // place in Protocol::conditions
  int series = 0;     // place in Protocol::series
  int track = 1;      // from 1, place in AdaptiveProcedure::starts + 1
  // Of the next trial: its distance from the standard; where both sides have one, of that below it; across it the comparison.
  double level = 0;
  bool finished = false;               // it has its trials, or ended before
  std::vector<double> levels;          // of the answered trials with a difference
  std::vector<bool> correct;           // whether they were answered correctly; across: the comparison said to have more
  std::vector<double> reversals;       // of a staircase
  int catch_trials = 0;                // answered
  int false_alarms = 0;                // of these, answered wrongly: a difference said where there was none
  std::optional<QuestEstimate> quest;  // of QUEST: the posterior of log10 of the level
  std::vector<TrackPosterior>
      course{};  // of the Bayesian procedure: after each of `levels`, with the catch trials behind it
  std::optional<double> sd_ln_s{};  // of the Bayesian procedure: of the posterior, what stop.precision looks at
};

class AdaptiveRun {
 public:
  // Without a procedure every trial is what the plan says.
  explicit AdaptiveRun(const Protocol& protocol);
  AdaptiveRun(const AdaptiveRun&) = delete;
  AdaptiveRun& operator=(const AdaptiveRun&) = delete;
  AdaptiveRun(AdaptiveRun&&) noexcept;
  AdaptiveRun& operator=(AdaptiveRun&&) noexcept;
  ~AdaptiveRun();

  // The planned trial with the stimuli that it has if it is presented now. Throws std::out_of_range where the protocol
  // has no such track.
  Trial resolved(Trial planned) const;
  // Its track has its reversals, or its precision: the trial is not presented any more. A track that has its trials has
  // only catch trials left, which are presented, so that their share is kept.
  bool over(const Trial& planned) const;
  // The next answer, in the order in which they were given. Catch trials count, and move nothing but the posterior of the
  // Bayesian procedure.
  void answered(const Trial& trial, const Answer& answer);

  // By condition, series, then track; empty without a procedure.
  std::vector<AdaptiveTrack> tracks() const;

 private:
  struct State;
  const State& state_of(const Trial& trial) const;

  std::optional<AdaptiveProcedure> procedure_;
  TaskSpec task_;
  std::map<std::array<int, 3>, std::unique_ptr<State>> states_;  // by condition, series and track
};

// Whether a track may end before it has all its trials, so that the number of trials is a maximum.
bool can_end_early(const AdaptiveProcedure& procedure) noexcept;
bool can_end_early(const Protocol& protocol) noexcept;  // false where the levels are given
// What becomes then of the trials that are planned for it, in a line; empty where nothing ends a track early.
std::string early_end_note(const Protocol& protocol);
// What ends it, for sentences: "8 reversals", "a posterior standard deviation of ln JND of at most 0.2"; empty where nothing does.
std::string early_end_of(const AdaptiveProcedure& procedure);

// "staircase", "quest", "posterior".
std::string_view to_string(AdaptiveProcedure::Kind kind) noexcept;
std::span<const std::pair<std::string_view, AdaptiveProcedure::Kind>> procedure_words() noexcept;

// The rule of one track: with its start, or its guess, and the clamp.
StaircaseRule staircase_of_track(const AdaptiveProcedure& procedure, int track);
QuestParameters quest_of_track(const AdaptiveProcedure& procedure, int track);

// A QUEST level for a recommended log10 of it: within the clamp, to a thousandth of the unit, so that the last digits
// of a logarithm, which differ between machines, do not matter.
double quest_level(double log10_level, const std::array<double, 2>& clamp);

}  // namespace jnd
