// The registered analysis of a study: counts by participant, condition and series, and what its protocol's analysis
// plan makes of them. Practice never counts; exclusions are the registered ones, each counted with its reason.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/counts.h"
#include "analysis/group.h"
#include "analysis/jnd.h"
#include "analysis/yes_no.h"
#include "data/study.h"
#include "protocols/protocol.h"

namespace jnd {

// One participant, condition and series.
struct CellResult {
  std::string participant;
  SessionKind kind = SessionKind::simulated;
  int condition = 0, series = 0;  // places in the protocol
  Counts counts;
  int excluded = 0;  // trials left out by the registered rules
  int missing = 0;   // planned trials without an answer
  YesNo yes_no;      // under the registered correction
};

// One participant and condition.
struct ThresholdResult {
  std::string participant;
  SessionKind kind = SessionKind::simulated;
  int condition = 0;
  JndEstimate jnd;
  double median_response_time_s = 0;  // participant's own entries; 0 without one
  double mean_trial_s = 0;            // time per trial
};

struct GroupResult {
  int condition = 0;
  JndGroup jnd;  // mean, CI, median, ... with n used of N
};

struct ContrastResult {
  int a = 0, b = 0;
  MeanEstimate difference;  // paired JND difference a - b, N/m, over participants with both
};

struct SessionHead {
  std::string participant, session, hash;
  SessionKind kind = SessionKind::simulated;
  bool closed = false;
};

struct StudyAnalysis {
  SessionKind kind = SessionKind::simulated;
  int participants = 0;
  std::vector<CellResult> cells;            // by participant, condition, series
  std::vector<ThresholdResult> thresholds;  // by participant, condition
  std::vector<GroupResult> group;           // by condition
  std::vector<ContrastResult> contrasts;
  std::vector<SessionHead> heads;         // by participant
  std::map<std::string, int> exclusions;  // reason -> trials
};

// Sessions of one kind only: the three kinds are never pooled.
StudyAnalysis analyze(const Study& study, const Protocol& protocol, SessionKind kind);
// The kinds that the study holds, real first.
std::vector<SessionKind> kinds_in(const Study& study);

// The same from counts alone (no study): cells of one participant and condition.
struct CellCounts {
  std::string participant;
  int condition = 0, series = 0;
  Counts counts;
};
StudyAnalysis analyze_counts(const std::vector<CellCounts>& cells, const Protocol& protocol, SessionKind kind);

}  // namespace jnd
