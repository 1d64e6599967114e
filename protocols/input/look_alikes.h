// Codes of people that are taken for one another: in other capitals, with other zeros before a number (P1, P001), or
// with a letter and its accent as one character or as two.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace jnd {

// The same for all codes that look alike. Of letters with accents those of Latin-1 and Latin Extended-A are known.
std::string look_of(std::string_view code);

// "\"1\" and \"01\", \"P2\" and \"p2\"": of different codes, each with the first that looks as it does; empty where
// none does. Of codes that print alike it says how many characters they have.
std::string look_alikes(const std::vector<std::string>& codes);

}  // namespace jnd
