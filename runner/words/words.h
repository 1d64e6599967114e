// The program's own words on the operator's screen, in the language of the session: one table for each language
// (runner/words/languages), by the English words.
#pragma once

#include <string>
#include <string_view>

#include <fmt/format.h>

namespace jnd {

// From now on. language: as BCP 47 names it; of "de-AT" without a table of its own the table "de" serves. False, and
// English, where there is no table. Throws InputError where the file is no table.
// Thread rule: before other threads ask for words.
bool use_language(std::string_view language);

// Which has the words; the English ones where the table has none for them. Valid until use_language().
std::string_view translated(std::string_view english) noexcept;

// The English words, a format, are checked while the program is compiled; those of a table in its test.
template <typename... Values>
std::string tr(fmt::format_string<Values...> english, Values&&... values) {
  const fmt::string_view words = english;
  const std::string_view found = translated({words.data(), words.size()});
  return fmt::vformat({found.data(), found.size()}, fmt::make_format_args(values...));
}

// Marks words that stand in a table of the code and are translated where they are shown.
constexpr const char* word(const char* english) noexcept {
  return english;
}

}  // namespace jnd
