#include "runner/calc/calc_output.h"

#include <string>

#include <fmt/format.h>

#include "runner/results/block_output.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

std::string tables_text(const std::vector<Block>& blocks) {
  std::string text;
  for (const Block& block : blocks)
    if (const ResultTable table = table_of(block); !table.rows.empty()) text += text_of(table);
  if (text.ends_with("\n\n")) text.pop_back();
  return text;
}

}  // namespace

void print_rows(const std::vector<Block>& blocks, bool json,
                const std::function<void(nlohmann::ordered_json& line, std::size_t row)>& more) {
  if (!json) return fmt::print("{}", tables_text(blocks));
  for (std::size_t row = 0; row < blocks.front().rows(); ++row) {
    nlohmann::ordered_json line = json_row(blocks.front(), row);
    if (more) more(line, row);
    print_json(line);
  }
}

void print_object(nlohmann::ordered_json object, const std::vector<Block>& blocks, bool json,
                  std::string_view heading) {
  if (json) {
    for (const Block& block : blocks) object[block.id] = json_rows(block);
    fmt::print("{}\n", json_line(object));
    return;
  }
  if (!heading.empty()) fmt::print("{}\n\n", bold(heading));
  fmt::print("{}", tables_text(blocks));
}

void explain(Block& block, std::string_view key,
             std::initializer_list<std::pair<std::string_view, std::string_view>> meanings) {
  for (const auto& [word, meaning] : meanings)
    for (std::size_t row = 0; row < block.rows(); ++row)
      if (block.text(row, key) == word) {
        block.footnotes.push_back(fmt::format("{}: {}.", word, meaning));
        break;
      }
}

}  // namespace jnd
