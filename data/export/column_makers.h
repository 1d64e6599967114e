// The parts from which files of results are made: columns of numbers and texts, and a file with its dictionary.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "data/export/export_tables.h"
#include "data/export/result_columns.h"
#include "protocols/protocol.h"

namespace jnd {

template <typename Row>
using Columns = std::vector<CsvColumn<Row>>;

inline constexpr const char* kMedianStatus =
    "what stands in the middle: a JND (ok), no sensitivity, or a JND below what was tested (ceiling)";
inline constexpr const char* kJndStatuses = "ok no_sensitivity ceiling no_information";

template <typename Row>
void add_file(std::vector<ResultFile>& files, const std::string& name, const Columns<Row>& columns,
              const std::vector<Row>& rows) {
  if (rows.empty()) return;
  ResultFile file{name, csv_table(columns, rows), {}};
  describe(name, columns, file.dictionary);
  files.push_back(std::move(file));
}

template <typename Row, typename Value>
CsvColumn<Row> number(std::string name, std::string meaning, Value value, std::string unit = "") {
  return {std::move(name), std::move(meaning), std::move(unit), "",
          [value](const Row& r) { return csv_number(value(r)); }};
}

template <typename Row, typename Value>
CsvColumn<Row> text(std::string name, std::string meaning, Value value, std::string levels = "") {
  return {std::move(name), std::move(meaning), "", std::move(levels),
          [value](const Row& r) { return csv_text(std::string(value(r))); }};
}

// Empty where the place is that of no condition, -1.
inline std::string condition_of(const Protocol& protocol, int place) {
  return place < 0 ? std::string() : protocol.conditions[static_cast<std::size_t>(place)].name;
}

}  // namespace jnd
