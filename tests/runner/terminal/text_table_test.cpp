// Tables of text in as many columns as there are.
#include "runner/terminal/text_table.h"

#include <sstream>
#include <string>

#include <rapidcheck.h>

#include "tests/catch.h"

namespace jnd {
namespace {

using Align = TextTable::Align;

TextTable sample() {
  TextTable table({"participant", "condition", "d' per 100 N/m", "95 % CI", "cautions"},
                  {Align::left, Align::left, Align::right, Align::right, Align::left});
  table.add({"P01", "S", "0.419", "169.2 to 945.6", ""});
  table.add({"", "V", "0.260", "223.4 to inf", "extrapolated"});
  return table;
}

TEST_CASE("a table is as wide as it takes where there is no end") {
  CHECK(sample().text(0) ==
        "  participant   condition   d' per 100 N/m          95 % CI   cautions\n"
        "  P01           S                    0.419   169.2 to 945.6\n"
        "                V                    0.260     223.4 to inf   extrapolated\n");
  CHECK(sample().text(200) == sample().text(0));
}

TEST_CASE("headers are broken first, then words stand below their row, then columns below each other") {
  CHECK(sample().text(66) ==
        "                               d'\n"
        "                              per\n"
        "                              100\n"
        "  participant   condition     N/m          95 % CI   cautions\n"
        "  P01           S           0.419   169.2 to 945.6\n"
        "                V           0.260     223.4 to inf   extrapolated\n");
  CHECK(sample().text(50) ==
        "                             d'\n"
        "                            per\n"
        "                            100\n"
        "  participant  condition    N/m         95 % CI\n"
        "  P01          S          0.419  169.2 to 945.6\n"
        "               V          0.260    223.4 to inf\n"
        "      extrapolated\n");
  CHECK(sample().text(40) ==
        "                             d'\n"
        "                            per\n"
        "                            100\n"
        "  participant  condition    N/m\n"
        "  P01          S          0.419\n"
        "               V          0.260\n"
        "\n"
        "  participant         95 % CI\n"
        "  P01          169.2 to 945.6\n"
        "                 223.4 to inf\n"
        "      extrapolated\n");
}

TEST_CASE("no line is wider than the room, and no word is lost or broken") {
  REQUIRE(rc::check("whatever the table", [] {
    const int columns = *rc::gen::inRange(2, 9), rows = *rc::gen::inRange(1, 6);
    const auto width = static_cast<std::size_t>(*rc::gen::inRange(30, 120));
    std::vector<std::string> header;
    std::vector<Align> align;
    for (int i = 0; i < columns; ++i) {
      header.push_back("c" + std::to_string(i) + std::string(static_cast<std::size_t>(*rc::gen::inRange(0, 9)), 'x') +
                       " h");
      align.push_back(i == 0 || *rc::gen::inRange(0, 3) == 0 ? Align::left : Align::right);
    }
    TextTable table(header, align);
    std::vector<std::string> words;
    for (int row = 0; row < rows; ++row) {
      std::vector<std::string> cells;
      for (int i = 0; i < columns; ++i) {
        cells.push_back("r" + std::to_string(row) + "c" + std::to_string(i) +
                        std::string(static_cast<std::size_t>(*rc::gen::inRange(0, 8)), 'y'));
        words.push_back(cells.back());
      }
      table.add(cells);
    }
    const std::string text = table.text(width);
    for (const std::string& word : words) RC_ASSERT(text.find(word) != std::string::npos);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) RC_ASSERT(display_width(line) <= width);
  }));
}

TEST_CASE("words are broken between, never within") {
  CHECK(wrapped_words("a bb ccc", 4) == std::vector<std::string>{"a bb", "ccc"});
  CHECK(wrapped_words("unbreakable", 4) == std::vector<std::string>{"unbreakable"});
  CHECK(wrapped_words("", 4) == std::vector<std::string>{""});
}

}  // namespace
}  // namespace jnd
