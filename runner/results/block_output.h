// Blocks of results (data/fields/block.h) as tables for people, and as JSON.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/fields/block.h"

namespace jnd {

struct ResultTable {
  struct Column {
    std::string name;
    bool number = false;  // aligned to the right
  };
  std::string id;      // "estimates", "group", ...: for links and the names of files
  std::string title;   // "Participants"
  std::string note{};  // the convention behind the numbers; empty where there is nothing to say
  std::vector<Column> columns{};
  std::vector<std::vector<std::string>> rows{};
  std::vector<std::string> footnotes{};  // below the table
};

// Numbers with the digits that their size, or the interval beside them, deserves. Columns that are empty in every row are
// left out, and who is named in the row above is not named again. Without rows where the block has no table.
ResultTable table_of(const Block& block);
// What the block says in the answer that a study begins with.
ResultTable answer_of(const Block& block);

nlohmann::ordered_json json_value(const FieldValue& value);
// Sets out.a.b for the key "a.b".
void set_json(nlohmann::ordered_json& out, std::string_view key, nlohmann::ordered_json value);
// A list of objects, one for each row; of one row the object.
nlohmann::ordered_json json_rows(const Block& block);
nlohmann::ordered_json json_row(const Block& block, std::size_t row);

// Ends with an empty line. Tables are as wide as they are where standard output is no terminal, and fit a terminal's
// width; text between them has 80 columns, or the fewer that there are.
std::string text_of(const ResultTable& table);
// Its words in lines, each ended. style: of each line, such as bold; none where null.
std::string paragraph(const std::string& text, std::string_view indent = "",
                      std::string (*style)(std::string_view) = nullptr);

}  // namespace jnd
