// Pictures of text: where the curves lie, what the axes say, and that nothing breaks on odd numbers.
#include "runner/terminal/plot.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "runner/terminal/text_table.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

const Canvas kAscii{.columns = 60, .unicode = false};
const Canvas kUnicode{.columns = 60, .unicode = true};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

PlotSeries straight_line(double from, double to) {
  PlotSeries series{.name = "line", .x = {}, .y = {}};
  for (int i = 0; i <= 100; ++i) {
    series.x.push_back(i);
    series.y.push_back(from + (to - from) * i / 100);
  }
  return series;
}

bool is_ascii(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c == '\n' || (c >= 0x20 && c < 0x7f); });
}

}  // namespace

TEST_CASE("an x axis can be wider than what is drawn") {
  const PlotSeries line = straight_line(0, 1);  // from 0 to 100
  PlotOptions options;
  options.rows = 4;
  const std::string own = line_plot({line}, options, kAscii);
  options.x_range = {-100, 100};
  const std::string wider = line_plot({line}, options, kAscii);
  CHECK(wider.find("-100") != std::string::npos);
  // The line has the right half.
  const std::size_t axis = lines_of(own)[1].find('|');
  for (int row = 1; row <= 3; ++row) CHECK(lines_of(wider)[row].find('*') > axis + 25);
  CHECK(lines_of(own)[4].find('*') < axis + 25);
  options.x_range = {40, 60};  // never narrower
  CHECK(line_plot({line}, options, kAscii) == own);
}

TEST_CASE("ticks are round numbers within the range") {
  CHECK(axis_ticks(0, 10, 5) == std::vector<double>{0, 2, 4, 6, 8, 10});
  CHECK(axis_ticks(-0.1, 1.3, 4) == std::vector<double>{0, 0.5, 1});
  CHECK(axis_ticks(1, 1, 4).empty());
  CHECK(axis_ticks(0, kInf, 4).empty());
  REQUIRE(rc::check("at most twice as many as wanted, ascending, inside", [] {
    const double low = *rc::gen::inRange(-1000, 1000), width = *rc::gen::inRange(1, 100'000) / 100.0;
    const int wanted = *rc::gen::inRange(2, 12);
    const std::vector<double> ticks = axis_ticks(low, low + width, wanted);
    RC_ASSERT(!ticks.empty() || wanted < 3);
    RC_ASSERT(static_cast<int>(ticks.size()) <= wanted + 1);
    RC_ASSERT(std::is_sorted(ticks.begin(), ticks.end()));
    for (const double tick : ticks) RC_ASSERT(tick >= low - 1e-6 && tick <= low + width + 1e-6);
  }));
}

TEST_CASE("a rising line goes from the lower left to the upper right") {
  const std::vector<std::string> lines =
      lines_of(line_plot({straight_line(0, 1)}, {.x_label = "time (s)", .y_label = "force (N)", .rows = 10}, kAscii));
  REQUIRE(lines.size() == 14);  // label, 10 rows, axis, ticks, label
  CHECK(lines[0] == "  force (N)");
  CHECK(lines[13].find("time (s)") != std::string::npos);
  std::size_t before = std::string::npos;
  for (std::size_t row = 1; row <= 10; ++row) {
    const std::size_t star = lines[row].find('*');
    REQUIRE(star != std::string::npos);
    CHECK(star < before);
    before = star;
  }
  CHECK(lines[12].find("100") != std::string::npos);
}

TEST_CASE("a label at the end of the axis stays inside the canvas") {
  const std::vector<std::string> lines = lines_of(
      line_plot({{.name = "", .x = {-110, -90}, .y = {0, 1}}}, {.x_label = "x", .y_label = "y", .rows = 8}, kAscii));
  CHECK(lines[10].find("-90") != std::string::npos);
  for (const std::string& line : lines) CHECK(display_width(line) <= static_cast<std::size_t>(kAscii.columns));
}

TEST_CASE("no line is wider than the canvas, and ASCII stays ASCII") {
  REQUIRE(rc::check("for any numbers", [] {
    const Canvas canvas{.columns = *rc::gen::inRange(10, 200), .unicode = *rc::gen::arbitrary<bool>()};
    PlotSeries first{.name = "one", .x = {}, .y = {}}, second{.name = "two", .x = {}, .y = {}};
    const int points = *rc::gen::inRange(0, 40);
    for (int i = 0; i < points; ++i) {
      const int kind = *rc::gen::inRange(0, 12);
      const double y = kind == 0 ? kNaN : kind == 1 ? kInf : *rc::gen::inRange(-100'000, 100'000) / 7.0;
      first.x.push_back(*rc::gen::inRange(-100, 100));
      first.y.push_back(y);
      second.x.push_back(i);
      second.y.push_back(-y);
    }
    const std::string text = line_plot({first, second},
                                       {.x_label = "x",
                                        .y_label = "y",
                                        .rows = *rc::gen::inRange(0, 20),
                                        .log_x = *rc::gen::arbitrary<bool>(),
                                        .from_zero = *rc::gen::arbitrary<bool>()},
                                       canvas);
    const auto widest = static_cast<std::size_t>(std::clamp(canvas.columns, 40, 100));
    for (const std::string& line : lines_of(text)) RC_ASSERT(display_width(line) <= widest);
    if (!canvas.unicode) RC_ASSERT(is_ascii(text));
  }));
}

TEST_CASE("series are told apart by their characters, and the legend says which is which") {
  PlotSeries flat{.name = "asked", .x = {0, 100}, .y = {0.5, 0.5}};
  const std::string ascii = line_plot({straight_line(0, 1), flat}, {.x_label = "x", .y_label = "y", .rows = 8}, kAscii);
  CHECK(ascii.find("** line") != std::string::npos);
  CHECK(ascii.find(".. asked") != std::string::npos);
  CHECK(std::count(ascii.begin(), ascii.end(), '.') > 40);
  const std::string unicode =
      line_plot({straight_line(0, 1), flat}, {.x_label = "x", .y_label = "y", .rows = 8}, kUnicode);
  CHECK(unicode.find("·· asked") != std::string::npos);
  CHECK(unicode.find("└") != std::string::npos);
}

TEST_CASE("what cannot be drawn is said or left out") {
  CHECK(line_plot({}, {}, kAscii) == "  nothing to plot\n");
  CHECK(line_plot({{.name = "", .x = {0, 1}, .y = {kNaN, kInf}}}, {}, kAscii) == "  nothing to plot\n");
  CHECK(line_plot({{.name = "", .x = {-1, 0}, .y = {1, 2}}}, {.x_label = "x", .y_label = "y", .log_x = true}, kAscii) ==
        "  nothing to plot\n");
  // A gap: no star between the two parts.
  const std::vector<std::string> lines =
      lines_of(line_plot({{.name = "", .x = {0, 1, 5, 9, 10}, .y = {1, 1, kNaN, 1, 1}}},
                         {.x_label = "x", .y_label = "y", .rows = 4}, kAscii));
  const auto row = std::find_if(lines.begin(), lines.end(),
                                [](const std::string& line) { return line.find('*') != std::string::npos; });
  REQUIRE(row != lines.end());
  CHECK(row->find("*    ") != std::string::npos);
  CHECK(std::count(row->begin(), row->end(), '*') < 20);
}

TEST_CASE("a curve that stays where it is has an axis too") {
  const std::string text =
      line_plot({{.name = "", .x = {0, 1}, .y = {5, 5}}}, {.x_label = "x", .y_label = "y", .rows = 6}, kAscii);
  CHECK(text.find('5') != std::string::npos);
  CHECK(std::count(text.begin(), text.end(), '*') > 40);
}

TEST_CASE("decades have their place on a logarithmic axis") {
  const std::vector<std::string> lines =
      lines_of(line_plot({{.name = "", .x = {1, 10, 100, 1000}, .y = {0, 1, 2, 3}}},
                         {.x_label = "x", .y_label = "y", .rows = 6, .log_x = true}, kAscii));
  const std::string& ticks = lines[lines.size() - 2];
  const auto at = [&](const char* label) { return static_cast<double>(ticks.find(label)); };
  CHECK(at(" 10 ") < at(" 100 "));
  CHECK(at("1000") > 50);
  CHECK(std::abs((at(" 100 ") - at(" 10 ")) - (at("1000") - at(" 100 "))) <= 3);
}

TEST_CASE("a map puts each value where it belongs, and says what the shades mean") {
  HeatMap map;
  map.x_label = "pitch (deg)";
  map.y_label = "roll (deg)";
  map.x = {-1, 0, 1};
  map.y = {-2, 2};
  map.values = {1, 2, 3, kInf, 2, 1};
  map.value_label = "condition";
  map.edges = {1.5, 2.5};
  map.none_label = "out of reach";
  const std::string ascii = heat_map(map, kAscii);
  const std::vector<std::string> lines = lines_of(ascii);
  REQUIRE(lines.size() >= 7);
  CHECK(lines[0] == "  roll (deg)");
  CHECK(lines[1].find("  oo..") != std::string::npos);  // y = 2: none, 2, 1
  CHECK(lines[2].find("..oo%%") != std::string::npos);  // y = -2
  CHECK(ascii.find("below 1.5") != std::string::npos);
  CHECK(ascii.find("2.5 or more") != std::string::npos);
  CHECK(ascii.find("blank: out of reach") != std::string::npos);
  CHECK(is_ascii(ascii));
  CHECK(heat_map(map, kUnicode).find("▒▒") != std::string::npos);
  CHECK(heat_map({}, kAscii) == "  nothing to plot\n");
}
