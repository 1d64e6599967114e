#include "protocols/input/look_alikes.h"

#include <map>

#include <fmt/format.h>

#include "protocols/input/json_reader.h"
#include "protocols/input/utf8.h"

namespace jnd {

namespace {

// Of the letters from U+00C0 on without their accents, and small; '.' of what has none.
constexpr std::string_view kPlainLetters =
    "aaaaaa.ceeeeiiii.nooooo..uuuuy.."
    "aaaaaa.ceeeeiiii.nooooo..uuuuy.y"
    "aaaaaaccccccccdd..eeeeeeeeeegggg"
    "gggghh..iiiiiiiii...jjkk.llllll."
    "...nnnnnn...oooooo..rrrrrrssssss"
    "sstttt..uuuuuuuuuuuuwwyyyzzzzzz.";
constexpr char32_t kFirstLetter = 0xC0, kFirstAccent = 0x300, kLastAccent = 0x36F;

char32_t plain(char32_t letter) {
  if (letter >= U'A' && letter <= U'Z') return letter - U'A' + U'a';
  if (letter < kFirstLetter || letter >= kFirstLetter + kPlainLetters.size()) return letter;
  const char known = kPlainLetters[letter - kFirstLetter];
  return known == '.' ? letter : static_cast<char32_t>(known);
}

bool is_digit(char32_t character) {
  return character >= U'0' && character <= U'9';
}

}  // namespace

std::string look_of(std::string_view code) {
  std::u32string look;
  for (const char32_t character : code_points(std::string(code))) {
    if (character >= kFirstAccent && character <= kLastAccent) continue;
    // A zero that a number begins with gives way to the next digit.
    const bool zero = !look.empty() && look.back() == U'0' && (look.size() == 1 || !is_digit(look[look.size() - 2]));
    if (zero && is_digit(character)) look.pop_back();
    look += plain(character);
  }
  return to_utf8(look);
}

std::string look_alikes(const std::vector<std::string>& codes) {
  std::map<std::string, std::string> first;  // by look
  std::string text;
  for (const std::string& code : codes) {
    const std::string& other = first.try_emplace(look_of(code), code).first->second;
    if (other == code) continue;
    text += fmt::format("{}{} and {}", text.empty() ? "" : ", ", in_quotes(other), in_quotes(code));
    const std::size_t one = count_characters(other), two = count_characters(code);
    if (other.size() > one || code.size() > two) text += fmt::format(" ({} and {} characters)", one, two);
  }
  return text;
}

}  // namespace jnd
