// Codes of participants and names of sessions: they become folders and cells of tables.
#pragma once

#include <algorithm>
#include <string_view>

namespace jnd {

inline bool letter_or_digit(char c) noexcept {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

// The code of a new participant.
inline bool plain_code(std::string_view code) noexcept {
  return !code.empty() && code.size() <= 32 && std::all_of(code.begin(), code.end(), letter_or_digit);
}

// The name of a session; and every code that a study can hold, because earlier programs allowed these in codes too.
inline bool plain_name(std::string_view name) noexcept {
  return !name.empty() && name.size() <= 64 && name.front() != '.' && std::all_of(name.begin(), name.end(), [](char c) {
    return letter_or_digit(c) || c == '-' || c == '_' || c == '.';
  });
}

}  // namespace jnd
