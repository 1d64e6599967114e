// How often a participant of a planned design gets a hit or false-alarm rate of 0 or 1, where d' hangs on a correction.
#pragma once

#include <string_view>

#include "protocols/protocol.h"

namespace jnd {

// The probability, 0..1, that in at least one series of that condition a rate is 0 or 1 or has no trials at all.
// Yes-no model with d' = difference / JND and an unbiased criterion; JND: the protocol's published value of the
// condition, else a quarter of the reference.
double extreme_rate_probability(const Protocol& protocol, std::string_view condition);

}  // namespace jnd
