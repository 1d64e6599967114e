// Which of several specimens that are alike are handed over, and what an onlooker can tell from their codes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "protocols/planning/plan.h"
#include "protocols/protocol.h"

namespace jnd {

// So many specimens of a value are advised: to learn which are alike then takes more trials than a session has.
inline constexpr int kAdvisedCodes = 6;

// The codes of the specimens for the intervals, in order. Drawn for each attempt at each trial from a stream of its own,
// so that no code follows from the plan or says how often a value comes; never one specimen twice. Empty texts stand for values
// of which there is none.
std::vector<std::string> specimen_codes(const Protocol& protocol, const Plan& plan, int trial, int attempt,
                                        const Intervals& values);

// Of pairs of specimens in one trial, the share of which an onlooker tells rightly whether they are alike, who remembers
// which codes came together: what comes together most often is alike. chance: of one who always says what is right more
// often. Means over simulated plans; none where no trial has two that are alike, or all have.
struct ToldByCodes {
  double told = 0, chance = 0;
};
// codes: per value; 0: as the protocol has them.
std::optional<ToldByCodes> told_by_codes(const Protocol& protocol, int codes = 0);

}  // namespace jnd
