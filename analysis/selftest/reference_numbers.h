// Reference numbers of the statistics, computed by independent programs: the files *_reference.json beside this one,
// which CMake puts into the program. The self-test and the tests read the same ones.
#pragma once

#include <string_view>

#include <nlohmann/json.hpp>

#include "analysis/procedures/quest.h"

namespace jnd {

// "group" gives group_reference.json; every other file *_reference.json likewise.
const nlohmann::json& reference_numbers(std::string_view subject);

// JSON has no infinities and no NaN: they are the strings "Inf", "-Inf", "NaN" and R's "NA". null is NaN too.
double reference_number(const nlohmann::json& value);

// The parameters of the reference run of QUEST.
QuestParameters reference_quest();

}  // namespace jnd
