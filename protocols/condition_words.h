// Conditions in words and in letters.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocols/protocol.h"

namespace jnd {

// The letters that stand for conditions wherever their names would give something away, one for each of
// Protocol::conditions, assigned by the study's seed: the operator's console and the results of a blinded study show these.
std::vector<std::string> condition_codes(const Protocol& protocol, std::uint64_t seed);

// "4", "true", "left".
std::string parameter_text(const ParameterValue& value);

// What a condition is to whoever carries it out, its label and its parameters: "four fingers (fingers = 4)".
std::string condition_words(const Condition& condition);

}  // namespace jnd
