// Numbers as people read them: undefined is "-", infinities are "inf". How many digits a number gets is said here alone.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace jnd {

// With so many decimals; with more where nothing but zeros would be left of a number that is not 0.
std::string number_text(double value, int decimals);
// So many decimals that an uncertainty of this size shows two digits that count: 12.3 -> 0, 0.123 -> 2; 0 to 6.
int decimals_of_spread(double spread) noexcept;
// So many that a number of this size shows three, where nothing is known of its uncertainty.
int decimals_of_size(double size) noexcept;

std::string percent_text(double fraction);                            // "35.5 %"
std::string p_value_text(double p);                                   // ".031"; "< .001", "> .999"
std::string p_text(double p);                                         // "p = .031", "p < .001", "no p"
std::string range_text(double low, double high, int decimals);        // "12.3 to 15.6"; "-" where either is undefined
std::string range_text(std::string_view low, std::string_view high);  // of numbers that are texts already
std::string counted(std::int64_t count, std::string_view thing);      // "1 session", "2 sessions"

}  // namespace jnd
