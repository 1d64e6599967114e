// The answers to questions of kind rating and number, as numbers.
#pragma once

#include <vector>

#include "data/study/study.h"
#include "protocols/protocol.h"

namespace jnd {

// One such question with its answers, by participant (in the order of participants_of).
struct RatedQuestion {
  int question = 0;     // place in Protocol::questions
  bool paired = false;  // answered for each condition
  // participants x conditions (paired), x series (by_series), or x 1. Where a question came more than once in a condition of a
  // session: the mean of its answers; over several sessions of a participant the mean of those. NaN where there is none.
  std::vector<double> ratings{};
  bool by_series = false;  // answered after each of several series
  std::size_t columns(const Protocol& protocol) const noexcept {
    return paired ? protocol.conditions.size() : by_series ? protocol.series.size() : 1;
  }
};

// Every question of kind rating or number, in the protocol's order. sessions: those of a participant stand together.
std::vector<RatedQuestion> read_ratings(const Study& study, const Protocol& protocol,
                                        const std::vector<SessionInfo>& sessions);

}  // namespace jnd
