// Tables that a user brings: every cell can be read or is refused with its place, and what is written reads back.
#include <string>
#include <vector>

#include "data/fields/csv_writer.h"
#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "runner/terminal/terminal.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

const std::vector<std::string> kColumns = {"a", "b"};
const std::vector<std::string> kMore = {"c", "participant"};

void read_numbers(const jnd::CsvTable& table) {
  for (std::size_t row = 0; row < table.rows(); ++row) {
    try {
      const double number = table.number(row, "a");
      jnd::fuzz::require(number == number, "a number is not NaN");
    } catch (const jnd::InputError& error) {
      jnd::fuzz::require_printable(jnd::printable_lines(error.what()), "a message");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace jnd;
  try {
    const CsvTable table = CsvTable::parse(std::string(fuzz::text_of(data, size)), "fuzz.csv", kColumns, kMore);
    read_numbers(table);
    std::vector<std::string> columns = kColumns;
    for (const std::string& name : kMore)
      if (table.has(name)) columns.push_back(name);
    std::string again = csv_line(columns);
    for (std::size_t row = 0; row < table.rows(); ++row) {
      std::vector<std::string> cells;
      for (const std::string& name : columns) cells.emplace_back(table.text(row, name));
      again += csv_line(cells);
    }
    const CsvTable second = CsvTable::parse(again, "again.csv", kColumns, kMore);
    fuzz::require(second.rows() == table.rows(), "as many rows");
    for (std::size_t row = 0; row < table.rows(); ++row)
      fuzz::require(second.text(row, "b") == table.text(row, "b"), "a cell reads back as it was");
  } catch (const InputError& error) {
    fuzz::require_printable(printable_lines(error.what()), "a message");
  }
  return 0;
}
