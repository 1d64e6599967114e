// Same-different answers with sureness: the JND of each participant and condition from all degrees of all answers in one
// model (analysis/ratings/sureness.h). Counted trials only.
#pragma once

#include <string>
#include <vector>

#include "analysis/ratings/sureness.h"
#include "data/study/study.h"
#include "data/study/trial_rows.h"
#include "protocols/protocol.h"

namespace jnd {

struct SurenessRow {
  std::string participant;
  int condition = 0;  // place in the protocol
  int trials = 0;
  Sureness fit;
};

// trials: those of read_counted_trials for these sessions. Empty where the protocol does not ask how sure one is. By
// participant, then condition, of those with a trial.
std::vector<SurenessRow> study_sureness(const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                                        const std::vector<CountedTrial>& trials);

}  // namespace jnd
