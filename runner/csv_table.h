// Numbers that a user brings in a CSV file (RFC 4180; header required, columns in any order): every mistake is one
// message with file, line and column.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace jnd {

struct NumberRange {
  double min = -1e300, max = 1e300;  // inclusive; what is outside, or is not a finite number, is an error
};

class CsvTable {
 public:
  // file: a path, or "-" for standard input. columns: all that may occur; `required` of them must. Throws InputError
  // where the file cannot be read, is not UTF-8 text, has no header, an unknown, repeated or missing column, a row of
  // another length, or no row at all.
  static CsvTable read(const std::string& file, const std::vector<std::string>& required,
                       const std::vector<std::string>& optional = {});
  // The same from a text in memory; file is its name in messages.
  static CsvTable parse(std::string_view text, const std::string& file, const std::vector<std::string>& required,
                        const std::vector<std::string>& optional = {});

  std::size_t rows() const noexcept { return rows_.size(); }
  bool has(std::string_view column) const noexcept;  // an optional column that the file has

  // The cell as it stands. row < rows(); column: one that the file has.
  const std::string& text(std::size_t row, std::string_view column) const;
  // Throw InputError, located, where the cell is empty, is not such a number or lies outside the range.
  double number(std::size_t row, std::string_view column, NumberRange range = {}) const;
  int integer(std::size_t row, std::string_view column, int min, int max = 1'000'000'000) const;

  // Throws an InputError that names the place of a cell: "counts.csv:4:3: hits: message (suggestion)".
  [[noreturn]] void fail(std::size_t row, std::string_view column, const std::string& message,
                         const std::string& suggestion = {}) const;

 private:
  struct Row {
    int line = 0;  // where it begins
    std::vector<std::string> cells;
  };
  std::size_t place_of(std::string_view column) const;

  std::string file_;
  std::vector<std::string> header_;
  std::vector<Row> rows_;
};

}  // namespace jnd
