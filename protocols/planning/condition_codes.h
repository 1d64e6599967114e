// The letters that stand for conditions wherever their names would give something away.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocols/protocol.h"

namespace jnd {

// One for each of Protocol::conditions, assigned by the study's seed: the operator's console and the results of a
// blinded study show these.
std::vector<std::string> condition_codes(const Protocol& protocol, std::uint64_t seed);

}  // namespace jnd
