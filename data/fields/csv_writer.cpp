#include "data/fields/csv_writer.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <system_error>

#include "analysis/numerics/words.h"
#include "protocols/input/look_alikes.h"

namespace jnd {

std::string csv_number(double value) {
  if (std::isnan(value)) return "";
  if (std::isinf(value)) return value > 0 ? "Inf" : "-Inf";
  std::array<char, 32> text{};
  auto* const end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return std::string(text.data(), end);
}

std::string_view to_string(CellType type) noexcept {
  constexpr auto kWords = words<CellType>({{"string", CellType::text},
                                           {"integer", CellType::integer},
                                           {"number", CellType::number},
                                           {"boolean", CellType::flag},
                                           {"datetime", CellType::time}});
  return word_of(kWords, type);
}

std::string csv_number(std::int64_t value) {
  return std::to_string(value);
}

namespace {

// What begins a formula, or moves it to where it is one; some take the full-width forms too.
constexpr std::array<std::string_view, 11> kBegins = {"=",  "+",      "-",      "@",      "\t",    "\r",
                                                      "\n", "\uff1d", "\uff0b", "\uff0d", "\uff20"};

bool plain_number(std::string_view text) noexcept {
  if (text.find_first_not_of("+-.0123456789eE") != std::string_view::npos || text.ends_with('.')) return false;
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

bool would_run(std::string_view text) noexcept {
  if (plain_number(text)) return false;
  const auto begins_with = [&](std::string_view what) { return text.starts_with(what); };
  for (;;) {
    if (std::any_of(kBegins.begin(), kBegins.end(), begins_with)) return true;
    // Spreadsheets skip blanks and quotes before they look whether a cell is a formula.
    const std::size_t skipped = text.starts_with('"') || text.starts_with('\'') ? 1 : leading_blank(text);
    if (skipped == 0) return false;
    text.remove_prefix(skipped);
  }
}

}  // namespace

std::string csv_text(std::string_view text) {
  return would_run(text) ? "'" + std::string(text) : std::string(text);
}

std::string csv_cell(std::string_view cell) {
  if (cell.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(cell);
  std::string quoted = "\"";
  for (const char character : cell) {
    if (character == '"') quoted += '"';
    quoted += character;
  }
  return quoted + '"';
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) line += ',';
    line += csv_cell(cells[i]);
  }
  return line + '\n';
}

}  // namespace jnd
