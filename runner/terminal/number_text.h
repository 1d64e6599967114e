// Numbers as people read them in tables: undefined is "-", infinities are "inf".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace jnd {

std::string number_text(double value, int decimals);
std::string percent_text(double fraction);                            // "35.5 %"
std::string p_value_text(double p);                                   // "0.0312"; below 0.0001 "3.1e-07"
std::string range_text(double low, double high, int decimals);        // "12.3 to 15.6"; "-" where either is undefined
std::string range_text(std::string_view low, std::string_view high);  // of numbers that are texts already
std::string counted(std::int64_t count, std::string_view thing);      // "1 session", "2 sessions"

}  // namespace jnd
