// The answers to questions of kind rating and number, as numbers.
#pragma once

#include <vector>

#include "data/study/study.h"
#include "protocols/protocol.h"

namespace jnd {

// One such question with its answers, by session (the places in the list that was asked for).
struct RatedQuestion {
  int question = 0;     // place in Protocol::questions
  bool paired = false;  // answered for each condition, or once
  // sessions x conditions (paired), or sessions x 1. Where a question came more than once in a condition: the mean of
  // its answers. NaN where there is none.
  std::vector<double> ratings;
};

// Every question of kind rating or number, in the protocol's order.
std::vector<RatedQuestion> read_ratings(const Study& study, const Protocol& protocol,
                                        const std::vector<SessionInfo>& sessions);
// The same with a row for each participant, in the order of participants_of: the mean over the participant's sessions.
std::vector<RatedQuestion> read_pooled_ratings(const Study& study, const Protocol& protocol,
                                               const std::vector<SessionInfo>& sessions);

}  // namespace jnd
