// Thresholds of a study whose answers set the levels: one row a track, and one a participant and condition.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/thresholds/adaptive_threshold.h"
#include "data/results/study_analysis.h"
#include "data/study/study.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/protocol.h"
#include "protocols/tasks/task.h"

namespace jnd {

struct AdaptiveRow {
  std::string participant;
  SessionKind kind = SessionKind::simulated;
  int condition = 0;                     // place in the protocol
  int track = 0;                         // from 1; 0: all tracks of the condition
  bool finished = false;                 // the stopping rule was met; of all tracks
  int trials = 0;                        // answered, with a difference
  int hits = 0;                          // of these, "different" said
  int catch_trials = 0;                  // answered
  int false_alarms = 0;                  // of these, "different" said
  double false_alarm_rate = 0;           // 0..1; NaN without catch trials
  AdaptiveThreshold threshold;           // in the study's unit
  double weber = 0;                      // of the reference; NaN without a threshold
  std::vector<double> levels;            // of a track: presented differences, in order
  std::vector<double> reversals;         // of a staircase's track: their levels
  std::vector<TrackPosterior> course{};  // of a track of the Bayesian procedure: after each of `levels`
  std::optional<int> group{};            // of the participant, place in Protocol::groups
  std::vector<LevelCount> answers{};     // of all tracks: for one model of everybody's
};

// Over the participants whose threshold in the condition is ok.
struct AdaptiveGroup {
  int condition = 0;
  int n = 0, of = 0;        // used of those who get it
  double mean = 0, sd = 0;  // of the thresholds; NaN for n = 0, and the sd for n = 1
  double false_alarms = 0;  // mean rate of the same participants; NaN where one has no catch trials
};

struct AdaptiveResults {
  Attendance attendance;
  std::vector<AdaptiveRow> rows;     // by participant, condition that they get; tracks first, then all
  std::vector<AdaptiveGroup> group;  // by condition
};

// protocol: one with a procedure. Sessions of one kind, by participant number; open ones too, as far as they are.
// Practice is left out. Registered exclusions are not applied: an excluded answer has moved the levels all the same.
// Throws StorageError where an event contradicts the protocol.
AdaptiveResults adaptive_results(const Study& study, const Protocol& protocol, SessionKind kind);
// AdaptiveRow::answers. trials: of the same sessions.
void add_answers(AdaptiveResults& results, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                 const CountedTrials& trials);

// The rows of one session from its events.
std::vector<AdaptiveRow> adaptive_rows(const std::vector<Event>& events, const Protocol& protocol,
                                       const std::string& participant, SessionKind kind);
// Their summary. rows: of any number of sessions.
// Over all sessions of a participant: the tracks of later ones are numbered on. group: of the participant.
std::vector<AdaptiveRow> adaptive_rows(const std::vector<std::vector<Event>>& sessions, const Protocol& protocol,
                                       const std::string& participant, SessionKind kind,
                                       std::optional<int> group = std::nullopt);
std::vector<AdaptiveGroup> adaptive_group(const std::vector<AdaptiveRow>& rows, const Protocol& protocol);

}  // namespace jnd
