// Text on a terminal: what is safe, tables, pictures, and the words of outcomes.
#include "runner/terminal/text_table.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <rapidcheck.h>
#include <unistd.h>

#include "analysis/numerics/special_values.h"
#include "analysis/numerics/stop_request.h"
#include "data/log/storage_error.h"
#include "protocols/input/input_error.h"
#include "runner/terminal/command_outcome.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/plot.h"
#include "runner/terminal/terminal.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// Text that is safe on a terminal, and its width there.

// What a terminal would obey, by its bytes: C0 but line feed where that stays, DEL, C1 as UTF-8 and as single bytes.
bool has_controls(const std::string& text, bool line_feeds) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte < 0x20 && !(line_feeds && byte == '\n')) || byte == 0x7F) return true;
    if (byte == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0) return true;
    if (byte < 0xC2 && byte >= 0x80 && (i == 0 || static_cast<unsigned char>(text[i - 1]) < 0x80)) return true;
  }
  return false;
}

std::string any_bytes() {
  std::string text;
  for (const int byte : *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 256)))
    text += static_cast<char>(byte);
  return text;
}

TEST_CASE("a name is one word for a shell, and no option", "[terminal]") {
  CHECK(shell_word("data/my-study_1.sqlite") == "data/my-study_1.sqlite");
  CHECK(shell_word("my study.sqlite") == "'my study.sqlite'");
  CHECK(shell_word("-x.sqlite") == "./-x.sqlite");
  CHECK(shell_word("") == "''");
  CHECK(shell_word("Anna's") == "'Anna'\\''s'");
  CHECK(shell_word("a\x1b[2J b") == "$'a\\x1b\\x5b2J\\x20b'");
}

TEST_CASE("what a terminal would obey, reorder or hide is made visible", "[terminal]") {
  CHECK(printable("plain, \xC3\xA9, \xE5\x89\x9B, \xF0\x9F\x99\x82") ==
        "plain, \xC3\xA9, \xE5\x89\x9B, \xF0\x9F\x99\x82");
  CHECK(printable("a\x1b[31m\x7f\n") == "a\\x1b[31m\\x7f\\x0a");
  CHECK(printable("\xC2\x9B"
                  "31m") == "\\u{9b}31m");
  CHECK(printable("\x9B"
                  "31m") == "\\x9b31m");
  CHECK(printable("\xE2\x80\xAE"
                  "abc\xE2\x81\xA6") == "\\u{202e}abc\\u{2066}");
  CHECK(printable("\xE2\x80\x8B\xE2\x80\xA8\xEF\xBB\xBF\xF3\xA0\x80\x81") == "\\u{200b}\\u{2028}\\u{feff}\\u{e0001}");
  // Overlong, a surrogate, beyond Unicode, cut off.
  CHECK(printable("\xC0\x9B") == "\\xc0\\x9b");
  CHECK(printable("\xED\xA0\x80") == "\\xed\\xa0\\x80");
  CHECK(printable("\xF4\x90\x80\x80") == "\\xf4\\x90\\x80\\x80");
  CHECK(printable("\xE2\x80") == "\\xe2\\x80");
  CHECK(printable_lines("a\n\x1b\tb\n") == "a\n\\x1b\\x09b\n");
}

TEST_CASE("no bytes whatever come out as a command, and safe text is not changed again", "[terminal]") {
  rc::check([] {
    const std::string text = any_bytes();
    RC_ASSERT(!has_controls(printable(text), false));
    RC_ASSERT(!has_controls(printable_lines(text), true));
    RC_ASSERT(printable(printable(text)) == printable(text));
  });
}

TEST_CASE("a JSON document for the terminal says the same to its reader", "[terminal]") {
  const nlohmann::json document = {{"a\x7f", "\xC2\x9B\xE2\x80\xAE\xF3\xA0\x80\x81 \xC3\xA9 \x1b\n"}};
  const std::string safe = printable_json(document.dump());
  CHECK_FALSE(has_controls(safe, false));
  CHECK(nlohmann::json::parse(safe) == document);
  CHECK(safe.find("\\u202e\\udb40\\udc01 \xC3\xA9") != std::string::npos);
}

TEST_CASE("wide characters take two columns, combining marks none", "[terminal]") {
  CHECK(display_width("abc") == 3);
  CHECK(display_width("\xC3\xA9") == 1);
  CHECK(display_width("e\xCC\x81") == 1);
  CHECK(display_width("\xE5\x89\x9B\xE6\x80\xA7") == 4);
  CHECK(display_width("\xEA\xB0\x95") == 2);
  CHECK(display_width("\xF0\x9F\x99\x82") == 2);
  CHECK(display_width("\xFF") == 1);
}

// Tables of text in as many columns as there are.

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

// Pictures of text: where the curves lie, what the axes say, and that nothing breaks on odd numbers.

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

// What a command throws, as words and exit codes; output that cannot be written.

// A standard stream that goes to another file for as long as this lives.
class Redirected {
 public:
  Redirected(std::FILE* stream, int descriptor) : stream_(stream), saved_(dup(fileno(stream))) {
    std::fflush(stream_);
    dup2(descriptor, fileno(stream_));
  }
  ~Redirected() {
    std::fflush(stream_);
    std::clearerr(stream_);
    dup2(saved_, fileno(stream_));
    close(saved_);
  }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;

 private:
  std::FILE* stream_;
  int saved_;
};

struct Outcome {
  int code = 0;
  std::string said;  // on standard error
};

Outcome outcome(const std::function<int()>& command) {
  std::FILE* said = std::tmpfile();
  REQUIRE(said != nullptr);
  Outcome result;
  {
    const Redirected to_file(stderr, fileno(said));
    result.code = outcome_of(command);
  }
  std::rewind(said);
  for (int byte = std::fgetc(said); byte != EOF; byte = std::fgetc(said)) result.said += static_cast<char>(byte);
  std::fclose(said);
  return result;
}

// As if a signal had come, for as long as this lives.
class StopRequested {
 public:
  StopRequested() { stop_requested() = true; }
  ~StopRequested() { stop_requested() = false; }
  StopRequested(const StopRequested&) = delete;
  StopRequested& operator=(const StopRequested&) = delete;
};

template <typename Error>
Outcome of(const Error& error) {
  return outcome([&]() -> int { throw error; });
}

TEST_CASE("what a command throws becomes its exit code, and words with what to do") {
  CHECK(outcome([] { return 3; }).code == 3);
  CHECK(of(UsageError("two\nlines")).said == "jnd: two\njnd: lines\n");
  CHECK(of(UsageError("x")).code == exit_code::kUsage);
  CHECK(of(InputError("x")).code == exit_code::kInvalidInput);
  CHECK(of(StorageError("x")).code == exit_code::kStorage);
  const Outcome memory = of(std::bad_alloc());
  CHECK(memory.code == exit_code::kStorage);
  CHECK_THAT(memory.said, Catch::Contains("the memory is not enough") && !Catch::Contains("bad_alloc"));
  CHECK_THAT(of(std::runtime_error("no such thing")).said, Catch::Contains("no such thing (an error that"));
  const Outcome stopped = of(Stopped());
  CHECK(stopped.code == exit_code::kInterrupted);
  CHECK_THAT(stopped.said, Catch::Contains("interrupted"));
}

TEST_CASE("a signal that came too late to stop a command is said") {
  const StopRequested requested;
  const Outcome late = outcome([] { return 0; });
  CHECK(late.code == exit_code::kInterrupted);
  CHECK_THAT(late.said, Catch::Contains("already done"));
}

TEST_CASE("results that cannot be printed are not done, and messages that cannot be are lost and no more") {
  const int full = open("/dev/full", O_WRONLY | O_CLOEXEC);
  REQUIRE(full >= 0);
  Outcome lost;
  {
    const Redirected to_full(stdout, full);
    lost = outcome([] {
      std::fputs("the result\n", stdout);
      return 0;
    });
  }
  CHECK(lost.code == exit_code::kStorage);
  CHECK_THAT(lost.said, Catch::Contains("could not be written in full: No space left on device"));
  {
    const Redirected to_full(stderr, full);
    CHECK(outcome_of([]() -> int { throw InputError("nobody reads this"); }) == exit_code::kInvalidInput);
  }
  close(full);
}

}  // namespace
}  // namespace jnd
