// Fields of results (data/fields/field.h) as JSON and as tables for people.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/fields/field.h"
#include "runner/results/result_tables.h"
#include "runner/terminal/number_text.h"

namespace jnd {

nlohmann::ordered_json json_value(const FieldValue& value);
// Numbers with `digits`, "-" where undefined; texts as they are; flags 0 and 1; nothing is empty.
std::string value_text(const FieldValue& value, Shown shown, int digits, double factor);
// Sets out.a.b for the key "a.b".
void set_json(nlohmann::ordered_json& out, std::string_view key, nlohmann::ordered_json value);

// Adds what these keys name, in their order; "jnd.*" names every field whose key begins with "jnd.".
template <typename Row>
void add_json(nlohmann::ordered_json& out, const Fields<Row>& fields, const Row& row,
              const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    if (!key.ends_with('*')) {
      set_json(out, key, json_value(field_of(fields, key).of(row)));
      continue;
    }
    for (const Field<Row>& field : fields)
      if (field.key.starts_with(std::string_view(key).substr(0, key.size() - 1)))
        set_json(out, field.key, json_value(field.of(row)));
  }
}
template <typename Row>
nlohmann::ordered_json json_of(const Fields<Row>& fields, const Row& row, const std::vector<std::string>& keys) {
  nlohmann::ordered_json out = nlohmann::ordered_json::object();
  add_json(out, fields, row, keys);
  return out;
}

// A column of a table: of one field, of several, or words of the table's own.
template <typename Row>
struct TableColumn {
  ResultTable::Column head;
  std::function<std::string(const Row&)> text;
};

// Makes the columns of tables from the fields of a block.
template <typename Row>
class TableMaker {
 public:
  explicit TableMaker(Fields<Row> fields) : fields_(std::move(fields)) {}

  std::string text(std::string_view key, const Row& row) const { return text(field_of(fields_, key), row); }

  TableColumn<Row> operator()(std::string_view key) const { return (*this)(key, field_of(fields_, key).title); }
  TableColumn<Row> operator()(std::string_view key, std::string title) const {
    const Field<Row>& field = field_of(fields_, key);
    return {{std::move(title), field.number}, [&field](const Row& row) { return text(field, row); }};
  }
  // "low to high", "-" where either is undefined.
  TableColumn<Row> range(std::string_view low, std::string_view high, std::string title = "95 % CI") const {
    const Field<Row>&a = field_of(fields_, low), &b = field_of(fields_, high);
    return {{std::move(title), true}, [&a, &b](const Row& row) { return range_text(text(a, row), text(b, row)); }};
  }
  // "5 of 9".
  TableColumn<Row> share(std::string_view part, std::string_view whole, std::string title,
                         const std::string& between = " of ") const {
    const Field<Row>&a = field_of(fields_, part), &b = field_of(fields_, whole);
    return {{std::move(title), true}, [&a, &b, between](const Row& row) {
              const std::string shown = text(a, row);
              return (shown.empty() ? "-" : shown) + between + text(b, row);
            }};
  }
  TableColumn<Row> words(std::string title, std::function<std::string(const Row&)> text, bool number = false) const {
    return {{std::move(title), number}, std::move(text)};
  }

  // table: with everything but columns and rows.
  ResultTable operator()(ResultTable table, const std::vector<TableColumn<Row>>& columns,
                         const std::vector<Row>& rows) const {
    for (const TableColumn<Row>& column : columns) table.columns.push_back(column.head);
    for (const Row& row : rows) {
      std::vector<std::string> cells;
      for (const TableColumn<Row>& column : columns) cells.push_back(column.text(row));
      table.rows.push_back(std::move(cells));
    }
    return table;
  }

 private:
  static std::string text(const Field<Row>& field, const Row& row) {
    return value_text(field.of(row), field.shown, field.digits, field.factor);
  }

  Fields<Row> fields_;
};

}  // namespace jnd
