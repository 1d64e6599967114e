#include "protocols/input/json_syntax.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include <fmt/format.h>

#include "protocols/input/json_reader.h"
#include "protocols/input/utf8.h"

namespace jnd {
namespace {

constexpr std::string_view kJsonBlanks = " \t\r\n";
constexpr std::string_view kNumberCharacters = "0123456789+-.eE";

std::size_t skip(std::string_view bytes, std::size_t at, std::string_view what) noexcept {
  return std::min(bytes.find_first_not_of(what, at), bytes.size());
}

// A run of characters that a person would take for one word.
std::string_view word_at(std::string_view bytes, std::size_t at) noexcept {
  const bool is_text = at < bytes.size() && bytes[at] == '"';
  if (is_text) return bytes.substr(at + 1, std::min(bytes.find('"', at + 1), bytes.size()) - at - 1);
  const std::size_t end = std::min(bytes.find_first_of(" \t\r\n,:{}[]\"", at), bytes.size());
  return bytes.substr(at, std::max<std::size_t>(end - at, 1));
}

SyntaxError explain_string(std::string_view bytes, std::size_t begin, std::size_t position, std::string_view what) {
  const auto has = [what](std::string_view part) { return what.find(part) != std::string_view::npos; };
  const std::size_t last_read = position > 0 ? std::min(position - 1, bytes.size()) : 0;
  if (has("missing closing quote") || has("U+000A") || has("U+000D"))
    return {begin, "the text that begins here has no closing quote on its line", "add the missing \""};
  if (has("control character"))
    return {last_read, "a control character inside a text", "write blanks for a tab, or leave it out"};
  if (has("\\u") || has("surrogate"))
    return {last_read, "an incomplete \\u escape", "write \\u and four hexadecimal digits, or the character itself"};
  if (has("backslash")) return {last_read, "a backslash that begins no known escape", "write \\\\ for a backslash"};
  return {begin, "this text cannot be read", "look at its quotes and backslashes"};
}

// Where the number begins that ends there.
std::size_t number_before(std::string_view bytes, std::size_t end) noexcept {
  while (end > 0 && kNumberCharacters.find(bytes[end - 1]) != std::string_view::npos) --end;
  return end;
}

// What word processors and web pages write where JSON has a quote or a blank.
struct LookAlike {
  std::string_view bytes, name, instead;
};
constexpr std::array kLookAlikes = {LookAlike{"\u201c", "a curly quote", "straight quotes: \""},
                                    LookAlike{"\u201d", "a curly quote", "straight quotes: \""},
                                    LookAlike{"\u201e", "a curly quote", "straight quotes: \""},
                                    LookAlike{"\u2018", "a curly quote", "straight quotes: \""},
                                    LookAlike{"\u2019", "a curly quote", "straight quotes: \""},
                                    LookAlike{"\u00ab", "an angled quote", "straight quotes: \""},
                                    LookAlike{"\u00bb", "an angled quote", "straight quotes: \""},
                                    LookAlike{"\u00a0", "a no-break space", "an ordinary blank"},
                                    LookAlike{"\u2009", "a thin space", "an ordinary blank"},
                                    LookAlike{"\u202f", "a narrow no-break space", "an ordinary blank"},
                                    LookAlike{"\u200b", "a zero-width space", "nothing"}};

const LookAlike* look_alike_at(std::string_view bytes, std::size_t at) noexcept {
  for (const LookAlike& one : kLookAlikes)
    if (bytes.substr(std::min(at, bytes.size())).starts_with(one.bytes)) return &one;
  return nullptr;
}

// "0900": JSON's own reading ends behind the 0. end: of the number.
std::optional<SyntaxError> leading_zero(std::string_view bytes, std::size_t end) {
  const std::size_t begin = number_before(bytes, end);
  const std::string_view number = bytes.substr(begin, end - begin);
  const std::size_t first = number.starts_with('-') ? 1 : 0;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (number.size() < first + 2 || number[first] != '0' || !is_digit(number[first + 1])) return std::nullopt;
  const std::size_t rest = std::min(number.find_first_not_of('0', first), number.size() - 1);
  if (!is_digit(number[rest])) return std::nullopt;
  return SyntaxError{begin, fmt::format("{} begins with a zero", number),
                     fmt::format("write {}{}", number.substr(0, first), number.substr(rest))};
}

// "900,5" in an object. begin: of the 5.
std::optional<SyntaxError> decimal_comma(std::string_view bytes, std::size_t begin) {
  const auto is_digit = [&](std::size_t at) { return at < bytes.size() && bytes[at] >= '0' && bytes[at] <= '9'; };
  if (begin < 2 || !is_digit(begin) || bytes[begin - 1] != ',' || !is_digit(begin - 2)) return std::nullopt;
  const std::size_t whole = number_before(bytes, begin - 1);
  const std::string_view before = bytes.substr(whole, begin - 1 - whole);
  const std::string_view after = bytes.substr(begin, skip(bytes, begin, kNumberCharacters) - begin);
  return SyntaxError{whole, fmt::format("{},{} is written with a comma", before, after),
                     fmt::format("numbers have a decimal point: {}.{}", before, after)};
}

// Columns before the first character of the line, or nothing where `at` is not it.
std::optional<std::size_t> indentation_at(std::string_view bytes, std::size_t at) noexcept {
  const std::size_t line = at == 0 ? 0 : bytes.find_last_of('\n', at - 1) + 1;
  if (bytes.substr(line, at - line).find_first_not_of(" \t") != std::string_view::npos) return std::nullopt;
  return at - line;
}

std::size_t indentation_of_line(std::string_view bytes, std::size_t at) noexcept {
  const std::size_t line = at == 0 ? 0 : bytes.find_last_of('\n', at - 1) + 1;
  return skip(bytes, line, " \t") - line;
}

// Brackets that are indented as people do give the one away that was forgotten: the first that is closed at a line that
// is indented less than the one that opens it.
std::optional<std::size_t> unclosed_by_indentation(std::string_view bytes) {
  std::vector<std::size_t> open;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    const char c = bytes[at];
    if (c == '"') {
      for (++at; at < bytes.size() && bytes[at] != '"'; ++at)
        if (bytes[at] == '\\') ++at;
    } else if (c == '{' || c == '[') {
      open.push_back(at);
    } else if ((c == '}' || c == ']') && !open.empty()) {
      const std::optional<std::size_t> closes = indentation_at(bytes, at);
      if (closes && *closes < indentation_of_line(bytes, open.back())) return open.back();
      open.pop_back();
    }
  }
  return std::nullopt;
}

SyntaxError explain_word(std::string_view bytes, std::size_t begin) {
  if (const LookAlike* const found = look_alike_at(bytes, begin))
    return {begin, fmt::format("{} stands here", found->name), fmt::format("write {}", found->instead)};
  const std::string_view word = word_at(bytes, begin);
  if (word.empty()) return {begin, "the file ends before its value is complete", ""};
  std::string lower;
  for (const char c : word) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const std::string bare =
      lower.substr(lower.find_first_not_of("+-") == std::string::npos ? 0 : lower.find_first_not_of("+-"));
  SyntaxError error{begin, in_quotes(word) + " is not a JSON value", ""};
  if (bare == "nan" || bare == "inf" || bare == "infinity") {
    error.message = in_quotes(word) + " is not a number that JSON knows";
    error.suggestion = "numbers must be finite; leave the member out where there is none";
  } else if (lower == "true" || lower == "false" || lower == "null") {
    error.suggestion = "write " + lower;
  } else if (lower == "none") {
    error.suggestion = "leave the member out where there is no value";
  } else if (word.front() == '\'') {
    error.suggestion = "texts stand in double quotes";
  } else if (word.front() == '/' || word.front() == '#') {
    error.message = "JSON has no comments";
    error.suggestion = "say it in \"notes\"";
  } else if (kNumberCharacters.find(word.front()) != std::string_view::npos) {
    error.message = in_quotes(word) + " is not a number that JSON knows";
    error.suggestion = "write it as in 0.5, -3 or 1e-3";
  } else {
    error.suggestion = "keys and texts stand in double quotes";
  }
  return error;
}

}  // namespace

Token TokenCursor::next() noexcept {
  Token token;
  token.begin = skip(bytes_, at_, " \t\r\n,:");
  token.end = token.begin;
  if (token.begin < bytes_.size()) {
    const char first = bytes_[token.begin];
    if (first == '"') {
      std::size_t at = token.begin + 1;
      while (at < bytes_.size() && bytes_[at] != '"') at += bytes_[at] == '\\' ? 2 : 1;
      token.end = std::min(at + 1, bytes_.size());
    } else if (kNumberCharacters.find(first) != std::string_view::npos && first != 'e' && first != 'E') {
      token.end = skip(bytes_, token.begin, kNumberCharacters);
    } else if (first >= 'a' && first <= 'z') {  // true, false, null
      token.end = token.begin + 1;
      while (token.end < bytes_.size() && bytes_[token.end] >= 'a' && bytes_[token.end] <= 'z') ++token.end;
    } else {
      token.end = token.begin + 1;
    }
  }
  at_ = token.end;
  return token;
}

std::pair<int, int> TokenCursor::place(std::size_t offset) noexcept {
  if (offset < placed_) {
    placed_ = 0;
    line_ = column_ = 1;
  }
  for (; placed_ < std::min(offset, bytes_.size()); ++placed_) {
    if (bytes_[placed_] == '\n') {
      ++line_;
      column_ = 1;
    } else if (!is_continuation(bytes_[placed_])) {
      ++column_;
    }
  }
  return {line_, column_};
}

SyntaxError explain_syntax_error(std::string_view bytes, std::size_t end_of_last, std::size_t position,
                                 std::string_view what, const std::vector<std::size_t>& open_brackets) {
  const auto has = [what](std::string_view part) { return what.find(part) != std::string_view::npos; };
  const std::size_t begin = skip(bytes, end_of_last, " \t\r\n,:");
  const std::size_t previous = bytes.substr(0, std::min(begin, bytes.size())).find_last_not_of(kJsonBlanks);
  const bool after_comma = previous != std::string_view::npos && bytes[previous] == ',';

  if (skip(bytes, 0, kJsonBlanks) == bytes.size()) return {0, "the file is empty", "start from a shipped protocol"};
  if (has("out_of_range") || has("number overflow"))
    return {begin, in_quotes(word_at(bytes, begin)) + " is too large a number", ""};
  if (has("invalid string")) return explain_string(bytes, begin, position, what);
  if (has("unexpected end of input")) {
    if (open_brackets.empty()) return {bytes.size(), "the file ends before its value is complete", ""};
    if (const std::optional<std::size_t> likely = unclosed_by_indentation(bytes);
        likely && *likely != open_brackets.back())
      return {*likely,
              fmt::format("the '{}' that opens here is not closed, to judge by the indentation", bytes[*likely]),
              fmt::format("add the missing '{}'", bytes[*likely] == '{' ? '}' : ']')};
    const std::size_t bracket = open_brackets.back();
    return {bracket, fmt::format("the '{}' that opens here is never closed", bytes[bracket]),
            fmt::format("add the missing '{}'", bytes[bracket] == '{' ? '}' : ']')};
  }
  if (has("expected end of input")) {
    const std::size_t extra = skip(bytes, end_of_last, kJsonBlanks);
    return {extra, "something follows the end of the document: " + in_quotes(word_at(bytes, extra)), "remove it"};
  }
  if (position <= end_of_last + 1)
    if (const std::optional<SyntaxError> zero = leading_zero(bytes, end_of_last)) return *zero;
  // "00e" was taken for one number, and is a 0 with more behind it.
  if ((has("invalid literal") || has("invalid number")) && position <= end_of_last + 1)
    return explain_word(bytes, number_before(bytes, end_of_last));
  if (has("invalid literal") || has("invalid number")) return explain_word(bytes, begin);

  // From here on single tokens are fine and their order is not; one-character tokens end where the parser stands.
  const std::size_t last_read = position > 0 ? std::min(position - 1, bytes.size() - 1) : 0;
  if (has("unexpected ','")) return {last_read, "a comma without a value before it", "remove it"};
  if (has("unexpected ':'")) return {last_read, "a ':' that does not follow a key", "keys stand in double quotes"};
  if (has("unexpected '}'") || has("unexpected ']'")) {
    if (after_comma)
      return {previous, fmt::format("a comma before the closing '{}'", bytes[last_read]), "remove the comma"};
    if (has("object separator")) return {last_read, "a key without a value", "write \"key\": value"};
    return {last_read, fmt::format("'{}' closes nothing that is open here", bytes[last_read]),
            "are the brackets in order?"};
  }
  if (has("object separator")) return {begin, "a ':' is missing between the key and this value", "add it"};
  if (has("object key"))
    if (const std::optional<SyntaxError> comma = decimal_comma(bytes, begin)) return *comma;
  if (has("object key")) return {begin, "a key in double quotes should stand here", "keys stand in double quotes"};
  return {begin, "a comma is missing before " + in_quotes(word_at(bytes, begin)), "separate members with commas"};
}

}  // namespace jnd
