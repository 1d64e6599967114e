// Numbers that a user brings in a table: CSV (RFC 4180; header required, columns in any order), or what spreadsheets
// make of it. Every mistake is one message with file, line and column.
//
// Read alike: UTF-8 and UTF-16 with its mark; commas, semicolons or tabs between the cells, as the header has them (or
// a first line sep=;); line ends LF, CRLF and CR; blanks around a cell, which do not count. Between semicolons or tabs
// a number may have a decimal comma. Refused, because it could mean two things: bytes that are not UTF-8; points and
// commas in the numbers of one file; a number such as 1,250 between tabs.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace jnd {

struct NumberRange {
  double min = -1e300, max = 1e300;  // inclusive; what is outside, or is not a finite number, is an error
};

// The cells lie in the text that was read: about 50 bytes a cell in all. Thread rule: one thread.
class CsvTable {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{256} << 20U;  // of a file

  // file: a path, or "-" for standard input. columns: all that may occur; `required` of them must. Throws InputError
  // where the file cannot be read (protocols/input/read_file.h), is not UTF-8 text, has no header, an unknown, repeated
  // or missing column, a row of another length, or no row at all.
  static CsvTable read(const std::string& file, const std::vector<std::string>& required,
                       const std::vector<std::string>& optional = {});
  // The same from a text in memory; file is its name in messages.
  static CsvTable parse(std::string text, const std::string& file, const std::vector<std::string>& required,
                        const std::vector<std::string>& optional = {});

  // The same of a table of another program: columns that are not asked for are passed over, whatever is
  // in them. wanted: each a different one; none where which they are follows from columns().
  static CsvTable read_among(const std::string& file, const std::vector<std::string>& wanted);
  static CsvTable parse_among(std::string text, const std::string& file, const std::vector<std::string>& wanted);

  std::size_t rows() const noexcept { return lines_.size(); }
  bool has(std::string_view column) const noexcept;  // an optional column that the file has
  const std::vector<std::string>& columns() const noexcept { return header_; }

  // The cell without the blanks around it; lives as long as the table. row < rows(); column: one that the file has.
  std::string_view text(std::size_t row, std::string_view column) const;
  // Throw InputError, located, where the cell is empty, is not such a number or lies outside the range.
  double number(std::size_t row, std::string_view column, NumberRange range = {}) const;
  int integer(std::size_t row, std::string_view column, int min, int max = 1'000'000'000) const;

  // Throws an InputError that names the place of a cell: "counts.csv:4:3: hits: message (suggestion)".
  [[noreturn]] void fail(std::size_t row, std::string_view column, const std::string& message,
                         const std::string& suggestion = {}) const;

 private:
  // Where cells lie. On the heap, so that views stay right when the table moves.
  struct Text {
    std::string whole;
    std::deque<std::string> unquoted;  // cells with quotes in them
  };
  class Scanner;

  enum class Others { refused, passed_over };
  static CsvTable scan(std::string text, const std::string& file, const std::vector<std::string>& required,
                       const std::vector<std::string>& optional, Others others);
  void read_header(Scanner& scanner, const std::vector<std::string>& required,
                   const std::vector<std::string>& optional);
  void find_among(Scanner& scanner, const std::vector<std::string>& wanted);
  void read_rows(Scanner& scanner);
  std::size_t place_of(std::string_view column) const;
  std::string with_point(std::size_t row, std::string_view column, std::string_view cell) const;

  std::string file_;
  std::shared_ptr<Text> text_;
  char separator_ = ',';
  std::vector<std::string> header_;
  std::vector<std::string_view> cells_;  // row by row, header_.size() a row
  std::vector<int> lines_;               // where each row begins
  mutable char decimal_mark_ = 0;        // of the numbers read so far; 0 while none had one
  mutable int decimal_line_ = 0;         // where it was first seen
};

}  // namespace jnd
