// Words and numbers of a study as figures and pages write them.
#pragma once

#include <string>
#include <string_view>

#include "data/fields/number_text.h"
#include "protocols/protocol.h"

namespace jnd {

// With three digits that count; "-" where undefined.
std::string size_text(double value);
std::string_view unit_of(const Protocol& protocol) noexcept;
const std::string& condition_text(const Protocol& protocol, int place);  // its name
// "S" and its label, as "S: servo motors"; the name alone where the label says no more.
std::string condition_title(const Condition& condition);

}  // namespace jnd
