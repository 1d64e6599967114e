// Conditions in words.
#pragma once

#include <string>

#include "protocols/protocol.h"

namespace jnd {

// "4", "true", "left".
std::string parameter_text(const ParameterValue& value);

// What a condition is to whoever carries it out, its label and its parameters: "four fingers (fingers = 4)".
std::string condition_words(const Condition& condition);

}  // namespace jnd
