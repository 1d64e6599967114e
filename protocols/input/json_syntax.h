// Tokens of a JSON text and their places, and plain words for syntax errors. Used by json_document.cpp only.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace jnd {

struct Token {
  std::size_t begin = 0, end = 0;  // byte offsets, end exclusive
};

// Walks over the tokens of a text that a parser has found to be good so far.
class TokenCursor {
 public:
  explicit TokenCursor(std::string_view bytes) noexcept : bytes_(bytes) {}
  Token next() noexcept;  // skips blanks, commas and colons, then one token
  std::size_t end_of_last() const noexcept { return at_; }
  // Line and column (characters, not bytes) from 1. Fast for offsets that do not go back.
  std::pair<int, int> place(std::size_t offset) noexcept;

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::size_t placed_ = 0;  // line_ and column_ belong to this offset
  int line_ = 1, column_ = 1;
};

struct SyntaxError {
  std::size_t offset = 0;
  std::string message;
  std::string suggestion;
};

// end_of_last: where the last good token ends; position: bytes that the parser had read; what: its own words;
// open_brackets: offsets of the brackets that are not closed yet, outermost first.
SyntaxError explain_syntax_error(std::string_view bytes, std::size_t end_of_last, std::size_t position,
                                 std::string_view what, const std::vector<std::size_t>& open_brackets);

}  // namespace jnd
