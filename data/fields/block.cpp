#include "data/fields/block.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/numerics/special_values.h"

namespace jnd {

const FieldCore& Block::field(std::string_view key) const {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const FieldCore& one) { return one.key == key; });
  if (found == fields.end()) throw std::logic_error("the block " + id + " has no field " + std::string(key));
  return *found;
}

bool Block::has(std::string_view key) const noexcept {
  return std::any_of(fields.begin(), fields.end(), [&](const FieldCore& one) { return one.key == key; });
}

double Block::number(std::size_t row, std::string_view key) const {
  const FieldValue found = value(row, field(key));
  if (const auto* real = std::get_if<double>(&found)) return *real;
  const auto* whole = std::get_if<std::int64_t>(&found);
  return whole == nullptr ? kNaN : static_cast<double>(*whole);
}

std::string Block::text(std::size_t row, std::string_view key) const {
  const FieldValue found = value(row, field(key));
  const auto* words = std::get_if<std::string>(&found);
  return words == nullptr ? csv_value(found) : *words;
}

bool Block::flag(std::size_t row, std::string_view key) const {
  const FieldValue found = value(row, field(key));
  const auto* set = std::get_if<bool>(&found);
  return set != nullptr && *set;
}

std::vector<double> Block::numbers(std::size_t row, std::string_view key) const {
  FieldValue found = value(row, field(key));
  auto* list = std::get_if<std::vector<double>>(&found);
  return list == nullptr ? std::vector<double>() : std::move(*list);
}

std::string Block::csv_header(const std::string& before) const {
  std::vector<std::string> cells;
  for (const FieldCore& one : fields)
    if (one.place == Place::everywhere) cells.push_back(one.column);
  return before + csv_line(cells);
}

std::string Block::csv_row(std::size_t row) const {
  std::vector<std::string> cells;
  for (const FieldCore& one : fields)
    if (one.place == Place::everywhere) cells.push_back(csv_value(value(row, one)));
  return csv_line(cells);
}

std::string Block::csv_rows(const std::string& before) const {
  std::string text;
  for (std::size_t row = 0; row < count_; ++row) text.append(before).append(csv_row(row));
  return text;
}

void Block::describe(std::vector<DictionaryRow>& dictionary) const {
  for (const FieldCore& one : fields)
    if (one.place == Place::everywhere)
      dictionary.push_back({file(), one.column, one.meaning, one.unit, one.levels, one.type, one.several});
}

const Block* block_named(const std::vector<Block>& blocks, std::string_view id) noexcept {
  const auto found = std::find_if(blocks.begin(), blocks.end(), [&](const Block& one) { return one.id == id; });
  return found == blocks.end() ? nullptr : &*found;
}

}  // namespace jnd
