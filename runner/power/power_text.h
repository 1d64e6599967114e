// A power study for people and for programs: tables, JSON, a long CSV table, and the plan of the simulation study as
// simulation studies are reported (ADEMP).
//
// Source: Morris, White and Crowther 2019, Statistics in Medicine 38:2074 (aims, data-generating mechanisms, estimands,
// methods, performance measures; Monte-Carlo errors).
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "runner/power/power_result.h"

namespace jnd {

std::string power_text(const PowerResult& result);  // lines ended by a newline
nlohmann::ordered_json power_json(const PowerResult& result);
// A row for each number: design, analysis, what it is of, which number, its value, Monte-Carlo error and interval.
std::string power_csv(const PowerResult& result);
std::string ademp_text(const PowerResult& result);  // Markdown

}  // namespace jnd
