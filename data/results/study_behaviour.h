// How the answers were given, beside how good they were: does the order of the intervals matter, does a participant
// lean towards one answer, does performance drift over the session, and which of a stimulus's traces explains the
// answers? Counted trials only: practice and excluded trials take no part.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/behaviour/cue_strategy.h"
#include "analysis/behaviour/drift.h"
#include "analysis/behaviour/order_effect.h"
#include "analysis/behaviour/response_bias.h"
#include "analysis/numerics/special_values.h"
#include "data/study/study.h"
#include "data/study/trial_rows.h"
#include "protocols/protocol.h"

namespace jnd {

// Holm's p of each test over the rows of one kind: the conditions, or the participants. NaN where there is no test.
struct BehaviourHolm {
  double order = kNaN, bias = kNaN, drift = kNaN, session = kNaN;
};

struct BehaviourRow {
  std::string participant;  // empty: all together
  int condition = -1;       // place in the protocol; -1: all together
  OrderEffect order;
  ResponseBias bias;
  // d' in the second half of each cell's trials against the first: what is learnt or forgotten within a block. Halves
  // of the session would compare different series and conditions wherever those come in blocks.
  Drift drift;
  // Of everyone together, where the orders differ between participants: the second half of the session against the
  // first, each series held against itself. Empty in a participant's row.
  std::optional<StratifiedDrift> session_drift;
  BehaviourHolm holm;
};

struct CueRow {
  int condition = 0;
  CueStrategy strategy;  // over the trials of all participants
  // Participants by the cue that explains their own answers best: as many entries as cues, in the order of Cue.
  std::vector<int> best_of;
  int undecided = 0;  // participants for whom there was none
};

struct StudyBehaviour {
  std::vector<BehaviourRow> conditions;    // everyone together, by condition
  std::vector<BehaviourRow> participants;  // everything of one participant, by participant
  std::vector<CueRow> cues;                // by condition
};

// trials: those of read_counted_trials for these sessions.
StudyBehaviour study_behaviour(const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                               const std::vector<CountedTrial>& trials);

}  // namespace jnd
