// Every counted answer of a study, participant by participant, in the order in which it was given.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "data/study/study.h"
#include "data/study/trial_rows.h"
#include "protocols/protocol.h"

namespace jnd {

struct RasterAnswer {
  int condition = 0;      // place in the protocol
  int said = -1;          // class of the answer, from 0; -1: it has none
  int target = -1;        // the class that is correct; -1: none is
  bool excluded = false;  // by a registered rule: in no result
  bool judged() const noexcept { return said >= 0 && target >= 0; }
  bool correct() const noexcept { return judged() && said == target; }
};

struct AnswersOf {
  std::string participant;
  std::vector<RasterAnswer> answers;      // of all sessions, one after the other
  std::vector<std::size_t> sessions_end;  // places in `answers` behind the last of each session
  std::int64_t voided = 0;                // attempts that were repeated or left out; they are not in `answers`
};

// trials: those of read_counted_trials for these sessions, of which those of a participant stand together.
std::vector<AnswersOf> answer_raster(const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                                     const std::vector<CountedTrial>& trials);

}  // namespace jnd
