#include "runner/csv_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>

#include "protocols/input_error.h"
#include "protocols/json_reader.h"

namespace jnd {

namespace {

[[noreturn]] void fail_at(const std::string& file, int line, int column, const std::string& path,
                          const std::string& message, const std::string& suggestion) {
  Diagnostic diagnostic;
  diagnostic.file = file;
  diagnostic.line = line;
  diagnostic.column = column;
  diagnostic.path = path;
  diagnostic.message = message;
  diagnostic.suggestion = suggestion;
  throw InputError({diagnostic});
}

std::string read_all(const std::string& file) {
  if (file == "-") return {std::istreambuf_iterator<char>(std::cin), {}};
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: cannot be read; name a CSV file, or - for standard input", file));
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) throw InputError(fmt::format("{}: cannot be read; is it a folder?", file));
  return text;
}

// One pass over the text: RFC 4180, with LF or CRLF.
class Scanner {
 public:
  Scanner(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  // The next row that is not an empty line; false at the end.
  bool next(int& line, std::vector<std::string>& cells) {
    while (at_ < text_.size() && (text_[at_] == '\n' || text_[at_] == '\r')) step();
    if (at_ >= text_.size()) return false;
    line = line_;
    cells.clear();
    do {
      cells.push_back(cell(static_cast<int>(cells.size()) + 1));
    } while (take(','));
    take('\r');
    if (at_ < text_.size() && !take('\n'))
      fail_at(file_, line_, static_cast<int>(cells.size()), "", "text after a quoted cell",
              "end the cell at its closing quote");
    return true;
  }

 private:
  void step() {
    if (text_[at_] == '\n') ++line_;
    ++at_;
  }
  bool take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    step();
    return true;
  }
  std::string cell(int column) {
    if (!take('"')) {
      const std::size_t begin = at_;
      while (at_ < text_.size() && text_[at_] != ',' && text_[at_] != '\n' && text_[at_] != '\r') ++at_;
      return std::string(text_.substr(begin, at_ - begin));
    }
    const int opened = line_;
    std::string value;
    for (;;) {
      if (at_ >= text_.size()) fail_at(file_, opened, column, "", "a quoted cell is never closed", "add the quote");
      if (take('"')) {
        if (!take('"')) return value;
        value += '"';
        continue;
      }
      value += text_[at_];
      step();
    }
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  int line_ = 1;
};

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t"), end = text.find_last_not_of(" \t");
  return begin == std::string::npos ? std::string() : text.substr(begin, end - begin + 1);
}

std::string listed(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

CsvTable CsvTable::read(const std::string& file, const std::vector<std::string>& required,
                        const std::vector<std::string>& optional) {
  return parse(read_all(file), file == "-" ? "standard input" : file, required, optional);
}

CsvTable CsvTable::parse(std::string_view text, const std::string& file, const std::vector<std::string>& required,
                         const std::vector<std::string>& optional) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);  // spreadsheets write a byte order mark
  if (text.find('\0') != std::string_view::npos)
    throw InputError(fmt::format("{}: holds zero bytes, so it is not a CSV text (save it as CSV, UTF-8)", file));
  CsvTable table;
  table.file_ = file;
  Scanner scanner(text, file);
  int line = 1;
  if (!scanner.next(line, table.header_))
    fail_at(file, 1, 0, "", "is empty", "the first line names the columns: " + listed(required));
  std::vector<std::string> known = required;
  known.insert(known.end(), optional.begin(), optional.end());
  const std::vector<std::string_view> words(known.begin(), known.end());
  for (std::size_t i = 0; i < table.header_.size(); ++i) {
    std::string& name = table.header_[i];
    name = trimmed(name);
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      const std::string near = nearest_word(name, words);
      fail_at(file, line, static_cast<int>(i) + 1, "", fmt::format("unknown column {}", in_quotes(name)),
              near.empty() ? "columns are " + listed(known) : fmt::format("did you mean {}?", in_quotes(near)));
    }
    if (std::find(table.header_.begin(), table.header_.begin() + static_cast<std::ptrdiff_t>(i), name) !=
        table.header_.begin() + static_cast<std::ptrdiff_t>(i))
      fail_at(file, line, static_cast<int>(i) + 1, "", fmt::format("column {} is there twice", in_quotes(name)),
              "remove one");
  }
  for (const std::string& name : required)
    if (!table.has(name))
      fail_at(file, line, 0, "", fmt::format("there is no column {}", in_quotes(name)),
              "columns are " + listed(required));
  for (Row row; scanner.next(row.line, row.cells);) {
    if (row.cells.size() != table.header_.size())
      fail_at(file, row.line, 0, "", fmt::format("has {} cells, the header {}", row.cells.size(), table.header_.size()),
              "give every column a cell");
    table.rows_.push_back(row);
  }
  if (table.rows_.empty()) fail_at(file, line, 0, "", "has a header and no row", "add the data");
  return table;
}

bool CsvTable::has(std::string_view column) const noexcept {
  return std::find(header_.begin(), header_.end(), column) != header_.end();
}

std::size_t CsvTable::place_of(std::string_view column) const {
  return static_cast<std::size_t>(std::find(header_.begin(), header_.end(), column) - header_.begin());
}

const std::string& CsvTable::text(std::size_t row, std::string_view column) const {
  return rows_.at(row).cells.at(place_of(column));
}

double CsvTable::number(std::size_t row, std::string_view column, NumberRange range) const {
  const std::string cell = trimmed(text(row, column));
  const char* begin = cell.data();
  const char* end = begin + cell.size();
  if (begin != end && *begin == '+') ++begin;
  double value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (begin == end || stop != end || error == std::errc::invalid_argument || !std::isfinite(value))
    fail(row, column, cell.empty() ? "is empty" : fmt::format("{} is not a finite number", in_quotes(cell)),
         "write a decimal such as 3.25, with a point");
  if (error == std::errc::result_out_of_range || value < range.min || value > range.max)
    fail(row, column, fmt::format("{} is out of range", cell),
         fmt::format("it must be {} to {}", plain(range.min), plain(range.max)));
  return value;
}

int CsvTable::integer(std::size_t row, std::string_view column, int min, int max) const {
  const double value = number(row, column);
  if (value != std::floor(value)) fail(row, column, fmt::format("{} is not a whole number", plain(value)));
  if (value < min || value > max)
    fail(row, column, fmt::format("{} is out of range", plain(value)), fmt::format("it must be {} to {}", min, max));
  return static_cast<int>(value);
}

void CsvTable::fail(std::size_t row, std::string_view column, const std::string& message,
                    const std::string& suggestion) const {
  fail_at(file_, rows_.at(row).line, static_cast<int>(place_of(column)) + 1, std::string(column), message, suggestion);
}

}  // namespace jnd
