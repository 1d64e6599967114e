#include "protocols/input/csv_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/json_syntax.h"
#include "protocols/input/look_alikes.h"
#include "protocols/input/read_file.h"
#include "protocols/input/utf8.h"

namespace jnd {

namespace {

constexpr const char* kSaveAs = "save it as CSV, UTF-8";

[[noreturn]] void fail(const std::string& file, const std::string& message) {
  throw InputError(std::vector<Diagnostic>{{file, 0, 0, "", message, kSaveAs}});
}

// Of bytes behind the mark.
std::string from_utf16(std::string_view bytes, bool high_byte_first, const std::string& file) {
  if (bytes.size() % 2 != 0) fail(file, "is UTF-16 text of which half a character is missing");
  std::u32string text;
  text.reserve(bytes.size() / 2);
  char32_t high = 0;  // the first half of a pair
  for (std::size_t at = 0; at < bytes.size(); at += 2) {
    const auto first = static_cast<unsigned char>(bytes[at]), second = static_cast<unsigned char>(bytes[at + 1]);
    const char32_t unit = high_byte_first ? first * 256U + second : second * 256U + first;
    const bool low_half = unit >= 0xDC00 && unit <= 0xDFFF, high_half = unit >= 0xD800 && unit <= 0xDBFF;
    if (low_half != (high != 0)) fail(file, "is UTF-16 text with half a character");
    if (low_half)
      text += static_cast<char32_t>(0x10000U + ((high - 0xD800U) << 10U) + (unit - 0xDC00U));
    else if (!high_half)
      text += unit;
    high = high_half ? unit : 0;
  }
  if (high != 0) fail(file, "is UTF-16 text with half a character");
  return to_utf8(text);
}

// UTF-8 without its byte order mark, from UTF-8 or from UTF-16 with one (what spreadsheets call "Unicode text"). Bytes
// that are not UTF-8 stay as they are: the reader of the table names their place. Throws InputError for spreadsheets,
// archives, UTF-16 that is damaged or has no mark, and other files with zero bytes. file: its name in messages.
std::string table_text(std::string bytes, const std::string& file) {
  const std::string_view begin = bytes;
  if (begin.starts_with("PK\x03\x04")) fail(file, "is a spreadsheet or an archive (xlsx, ods, zip), not a CSV text");
  if (begin.starts_with("\xD0\xCF\x11\xE0")) fail(file, "is a spreadsheet (xls), not a CSV text");
  if (begin.starts_with("\xFF\xFE") || begin.starts_with("\xFE\xFF"))
    bytes = from_utf16(begin.substr(2), begin.front() == '\xFE', file);
  else if (begin.starts_with("\xEF\xBB\xBF"))
    bytes.erase(0, 3);
  if (bytes.find('\0') != std::string::npos)
    fail(file, "holds zero bytes, so it is not a CSV text (or UTF-16 without its mark)");
  return bytes;
}

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

std::string listed(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

// Takes a first line "sep=;" off, which spreadsheets write and obey; in quotes too. 0 without one.
char named_separator(std::string_view& text) {
  for (const std::string_view quote : {"", "\""})
    for (const char separator : {',', ';', '\t'}) {
      const std::string line = fmt::format("{}sep={}{}", quote, separator, quote);
      if (!text.starts_with(line + '\n') && !text.starts_with(line + '\r')) continue;
      text.remove_prefix(line.size());  // the line end stays, and counts
      return separator;
    }
  return 0;
}

// The one of , ; and tab that the header has; a comma where it has none of them, or several.
char separator_of(std::string_view text) {
  const std::size_t begin = text.find_first_not_of("\r\n");
  if (begin == std::string_view::npos) return ',';
  const std::string_view header = text.substr(begin, text.find_first_of("\r\n", begin) - begin);
  if (header.find(',') != std::string_view::npos) return ',';
  const bool semicolon = header.find(';') != std::string_view::npos, tab = header.find('\t') != std::string_view::npos;
  return semicolon == tab ? ',' : semicolon ? ';' : '\t';
}

// 1,250 or 12,345,678: what could be thousands.
bool like_thousands(std::string_view cell) {
  const std::size_t comma = cell.find(',');
  const std::string_view whole = cell.substr(0, comma), rest = cell.substr(comma + 1);
  const std::size_t digits = whole.find_first_of("0123456789");
  return rest.size() == 3 && digits != std::string_view::npos && whole[digits] != '0' && whole.size() - digits <= 3;
}

}  // namespace

// One pass over the text. Views of cells without quotes lie in it.
class CsvTable::Scanner {
 public:
  Scanner(Text& text, std::string_view rest, char separator, int line, const std::string& file)
      : kept_(text), text_(rest), separator_(separator), file_(file), line_(line), invalid_(first_invalid_utf8(rest)) {}

  // Appends the cells of the next row that is not an empty line, or one of blanks; false at the end.
  bool next(int& line, std::vector<std::string_view>& cells) {
    skip_blanks();
    while (at_ < text_.size() && at_line_end()) {
      step();
      skip_blanks();
    }
    if (at_ >= text_.size()) return false;
    line = line_;
    int column = 0;
    do {
      cells.push_back(cell(++column));
    } while (take(separator_));
    if (at_ < text_.size() && !at_line_end())
      fail_at(file_, line_, column, "", "text after a quoted cell", "end the cell at its closing quote");
    return true;
  }

 private:
  bool at_line_end() const { return text_[at_] == '\n' || text_[at_] == '\r'; }
  void step() {
    const bool first_of_two = text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n';
    if (at_line_end() && !first_of_two) ++line_;
    ++at_;
  }
  bool take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    step();
    return true;
  }
  std::string_view cell(int column) {
    const std::size_t begin = at_;
    const int line = line_;
    const std::string_view found = without_blanks(quote_comes() ? quoted(line, column) : plain());
    if (invalid_ >= begin && invalid_ < at_)
      fail_at(file_, line, column, "",
              fmt::format("holds the byte {:#04x}, which is not UTF-8 text (Latin-1 or Windows-1252?)",
                          static_cast<unsigned char>(text_[invalid_])),
              "save it as CSV, UTF-8");
    return found;
  }
  // Where a quote opens the cell, goes behind it; blanks before it are none of the cell.
  bool quote_comes() {
    const std::size_t begin = at_;
    skip_blanks();
    if (take('"')) return true;
    at_ = begin;
    return false;
  }
  void skip_blanks() {
    while (at_ < text_.size() && !at_line_end() && text_[at_] != separator_) {
      const std::size_t blank = leading_blank(text_.substr(at_));
      if (blank == 0) return;
      at_ += blank;
    }
  }
  std::string_view plain() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != separator_ && !at_line_end()) ++at_;
    return text_.substr(begin, at_ - begin);
  }
  std::string_view quoted(int line, int column) {
    std::string value;
    for (;;) {
      if (at_ >= text_.size()) fail_at(file_, line, column, "", "a quoted cell is never closed", "add the quote");
      if (take('"')) {
        if (!take('"')) break;
        value += '"';
        continue;
      }
      value += text_[at_];
      step();
    }
    skip_blanks();
    return kept_.unquoted.emplace_back(std::move(value));
  }

  Text& kept_;
  std::string_view text_;
  char separator_;
  const std::string& file_;
  std::size_t at_ = 0;
  int line_;
  std::size_t invalid_;  // the first byte that is not UTF-8
};

CsvTable CsvTable::read(const std::string& file, const std::vector<std::string>& required,
                        const std::vector<std::string>& optional) {
  if (file == "-") return parse(read_standard_input(kMostBytes), "standard input", required, optional);
  return parse(read_input_file(file, kMostBytes), file, required, optional);
}

CsvTable CsvTable::parse(std::string text, const std::string& file, const std::vector<std::string>& required,
                         const std::vector<std::string>& optional) {
  return scan(std::move(text), file, required, optional, Others::refused);
}

CsvTable CsvTable::read_among(const std::string& file, const std::vector<std::string>& wanted) {
  if (file == "-") return parse_among(read_standard_input(kMostBytes), "standard input", wanted);
  return parse_among(read_input_file(file, kMostBytes), file, wanted);
}

CsvTable CsvTable::parse_among(std::string text, const std::string& file, const std::vector<std::string>& wanted) {
  return scan(std::move(text), file, wanted, {}, Others::passed_over);
}

CsvTable CsvTable::scan(std::string text, const std::string& file, const std::vector<std::string>& required,
                        const std::vector<std::string>& optional, Others others) {
  CsvTable table;
  table.file_ = file;
  table.text_ = std::make_shared<Text>();
  table.text_->whole = table_text(std::move(text), file);
  std::string_view rest = table.text_->whole;
  const char named = named_separator(rest);
  table.separator_ = named != 0 ? named : separator_of(rest);
  Scanner scanner(*table.text_, rest, table.separator_, 1, file);
  if (others == Others::refused)
    table.read_header(scanner, required, optional);
  else
    table.find_among(scanner, required);
  table.read_rows(scanner);
  return table;
}

void CsvTable::read_header(Scanner& scanner, const std::vector<std::string>& required,
                           const std::vector<std::string>& optional) {
  int line = 1;
  std::vector<std::string_view> names;
  if (!scanner.next(line, names))
    fail_at(file_, 1, 0, "", "is empty", "the first line names the columns: " + listed(required));
  std::vector<std::string> known = required;
  known.insert(known.end(), optional.begin(), optional.end());
  const std::vector<std::string_view> words(known.begin(), known.end());
  for (const std::string_view view : names) {
    const std::string name(view);
    const int column = static_cast<int>(header_.size()) + 1;
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      const std::string near = nearest_word(name, words);
      fail_at(file_, line, column, "", fmt::format("unknown column {}", in_quotes(name)),
              near.empty() ? "columns are " + listed(known) : fmt::format("did you mean {}?", in_quotes(near)));
    }
    if (has(name))
      fail_at(file_, line, column, "", fmt::format("column {} is there twice", in_quotes(name)), "remove one");
    header_.push_back(name);
  }
  for (const std::string& name : required)
    if (!has(name))
      fail_at(file_, line, 0, "", fmt::format("there is no column {}", in_quotes(name)),
              "columns are " + listed(required));
}

void CsvTable::find_among(Scanner& scanner, const std::vector<std::string>& wanted) {
  int line = 1;
  std::vector<std::string_view> names;
  if (!scanner.next(line, names))
    fail_at(file_, 1, 0, "", "is empty",
            wanted.empty() ? "the first line names the columns"
                           : "the first line names the columns, among them " + listed(wanted));
  for (const std::string_view view : names) header_.emplace_back(view);
  for (const std::string& name : wanted) {
    const auto times = std::count(header_.begin(), header_.end(), name);
    if (times > 1)
      fail_at(file_, line, 0, "", fmt::format("column {} is there {} times", in_quotes(name), times),
              "give every column a name of its own");
    if (times == 1) continue;
    const std::string near = nearest_word(name, names);
    fail_at(file_, line, 0, "", fmt::format("there is no column {}", in_quotes(name)),
            near.empty() ? "its columns are " + listed(header_) : fmt::format("did you mean {}?", in_quotes(near)));
  }
}

void CsvTable::read_rows(Scanner& scanner) {
  const std::size_t columns = header_.size();
  int line = 1;
  while (scanner.next(line, cells_)) {
    const std::size_t begin = columns * lines_.size(), found = cells_.size() - begin;
    if (found != columns)
      fail_at(file_, line, 0, "", fmt::format("has {} cells, the header {}", found, columns),
              separator_ == ',' && found > columns
                  ? "give every column a cell; between commas, numbers have a decimal point"
                  : "give every column a cell");
    // Spreadsheets keep rows of which every cell was cleared.
    const auto first = cells_.begin() + static_cast<std::ptrdiff_t>(begin);
    if (std::all_of(first, cells_.end(), [](std::string_view cell) { return cell.empty(); }) && columns > 1)
      cells_.erase(first, cells_.end());
    else
      lines_.push_back(line);
  }
  if (lines_.empty()) fail_at(file_, line, 0, "", "has a header and no row", "add the data");
}

bool CsvTable::has(std::string_view column) const noexcept {
  return std::find(header_.begin(), header_.end(), column) != header_.end();
}

std::size_t CsvTable::place_of(std::string_view column) const {
  return static_cast<std::size_t>(std::find(header_.begin(), header_.end(), column) - header_.begin());
}

std::string_view CsvTable::text(std::size_t row, std::string_view column) const {
  return cells_.at(row * header_.size() + place_of(column));
}

// A number as it stands, with a point for its decimal comma where that can only be one.
std::string CsvTable::with_point(std::size_t row, std::string_view column, std::string_view cell) const {
  std::string number(cell);
  const std::size_t mark = number.find_first_of(".,");
  if (separator_ == ',' || mark == std::string::npos || number.find_first_of(".,", mark + 1) != std::string::npos)
    return number;
  if (number[mark] == ',' && separator_ == '\t' && like_thousands(number))
    fail(row, column,
         fmt::format("{} could be {} or {}", number, number.substr(0, mark) + "." + number.substr(mark + 1),
                     number.substr(0, mark) + number.substr(mark + 1)),
         "write decimals with a point, and thousands without a comma");
  if (decimal_mark_ == 0) {
    decimal_mark_ = number[mark];
    decimal_line_ = lines_.at(row);
  } else if (decimal_mark_ != number[mark]) {
    const auto name = [](char c) { return c == ',' ? "comma" : "point"; };
    fail(row, column,
         fmt::format("{} has a {}, and a number in line {} a {}", number, name(number[mark]), decimal_line_,
                     name(decimal_mark_)),
         "write all decimals alike, and thousands without a mark");
  }
  number[mark] = '.';
  return number;
}

double CsvTable::number(std::size_t row, std::string_view column, NumberRange range) const {
  const std::string_view written = text(row, column);
  const std::string cell = with_point(row, column, written);
  const char* begin = cell.data();
  const char* end = begin + cell.size();
  if (begin != end && *begin == '+') ++begin;
  double value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (begin == end || stop != end || error == std::errc::invalid_argument || !std::isfinite(value))
    fail(row, column, written.empty() ? "is empty" : fmt::format("{} is not a finite number", in_quotes(written)),
         "write a decimal such as 3.25, with a point");
  if (error == std::errc::result_out_of_range || value < range.min || value > range.max)
    fail(row, column, fmt::format("{} is out of range", written),
         fmt::format("it must be {} to {}", plain(range.min), plain(range.max)));
  return plain_decimal(value);
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
  fail_at(file_, lines_.at(row), static_cast<int>(place_of(column)) + 1, std::string(column), message, suggestion);
}

}  // namespace jnd
