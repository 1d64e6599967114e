// A block of results: rows of one kind with their fields, and how a person reads them. Terminal, page, JSON, CSV files and
// their dictionary are written by going through blocks; who looks for one number takes a block by its id and a field by
// its key.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "data/fields/csv_writer.h"
#include "data/fields/field.h"

namespace jnd {

// What of the results a block is about: `analyze` shows them by option.
enum class Section { participants, tests, models, behaviour, questions, cells };

// A column of a table for people: a field, or two of them in one cell, such as "5 of 9" and "1.2 to 3.4".
struct TableColumn {
  std::string key;
  std::string between{}, second{};  // empty: of one field
  std::string title{};              // empty: the field's own
};
inline TableColumn range(std::string low, std::string high, std::string title = "95 % CI") {
  return {std::move(low), " to ", std::move(high), std::move(title)};
}
inline TableColumn share(std::string part, std::string whole, std::string title, std::string between = " of ") {
  return {std::move(part), std::move(between), std::move(whole), std::move(title)};
}

// The same rows in few columns, for the few lines that an answer begins with.
struct AnswerView {
  std::string title{}, note{};
  std::vector<TableColumn> columns{};
  std::string only{};  // key of a flag: rows in which it is set; empty: all
};

class Block {
 public:
  std::string id;  // "group": of its file, of JSON, of the link to its table
  Section section = Section::tests;
  std::string title;                     // "Registered contrasts"
  std::string note{};                    // the convention behind the numbers; empty where there is nothing to say
  std::vector<std::string> footnotes{};  // below the table
  std::vector<TableColumn> columns{};    // of the table; none: it has none
  AnswerView answer{};                   // without columns: it is not part of the answer
  std::vector<FieldCore> fields{};       // in the order of the file's columns

  // rows must outlive the block.
  template <typename Row>
  Block& with(const Fields<Row>& of, const std::vector<Row>& rows) {
    fields.assign(of.begin(), of.end());
    first_ = rows.data();
    count_ = rows.size();
    stride_ = sizeof(Row);
    return *this;
  }
  // Keeps them.
  template <typename Row>
  Block& with(const Fields<Row>& of, std::vector<Row>&& rows) {
    auto kept = std::make_shared<const std::vector<Row>>(std::move(rows));
    kept_ = kept;
    return with(of, *kept);
  }

  std::size_t rows() const noexcept { return count_; }
  // Throws std::logic_error where there is no such field.
  const FieldCore& field(std::string_view key) const;
  bool has(std::string_view key) const noexcept;
  FieldValue value(std::size_t row, const FieldCore& field) const {
    return field.of(static_cast<const char*>(first_) + row * stride_);
  }
  // NaN, or empty, where the value is of another kind; the words of a flag are "0" and "1".
  double number(std::size_t row, std::string_view key) const;
  std::string text(std::size_t row, std::string_view key) const;
  bool flag(std::size_t row, std::string_view key) const;
  std::vector<double> numbers(std::size_t row, std::string_view key) const;

  // Of its file: fields that stand everywhere. before: cells with their commas that each line begins with.
  std::string csv_header(const std::string& before = {}) const;
  std::string csv_row(std::size_t row) const;
  std::string csv_rows(const std::string& before = {}) const;
  void describe(std::vector<DictionaryRow>& dictionary) const;
  std::string file() const { return id + ".csv"; }

 private:
  std::shared_ptr<const void> kept_{};
  const void* first_ = nullptr;
  std::size_t count_ = 0, stride_ = 0;
};

// Null where there is none.
const Block* block_named(const std::vector<Block>& blocks, std::string_view id) noexcept;

}  // namespace jnd
