// A table of words in another language, as its file has them (runner/words/README.md).
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace jnd {

struct WordTable {
  std::string language;                                   // as BCP 47 names it
  std::map<std::string, std::string, std::less<>> words;  // by the English ones
};

// Throws InputError that names every entry whose places for values are not those of the English words, so that nothing
// can go wrong when they are filled in.
WordTable read_word_table(const std::filesystem::path& file);

// Why a translation cannot take the English words' place; empty where it can. Places are "{}" in the order of the English
// ones, or all numbered, "{1} of {0}"; each with the same format.
std::string misfit_of(std::string_view english, std::string_view translation);

}  // namespace jnd
