// What is on the screen from one event to the next, and its large letters.
#include "runner/screen/screen_display.h"

#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "protocols/input/utf8.h"
#include "runner/keys/line_editor.h"
#include "runner/screen/large_letters.h"
#include "runner/screen/screen_colours.h"
#include "runner/screen/screen_text.h"
#include "tests/catch.h"
#include "tests/runner/screen/kept_frames.h"

namespace jnd {
namespace {

// What is on the screen from one event to the next.

constexpr std::int64_t kSecond_ns = 1'000'000'000;

struct Screen {
  Screen() {
    SessionCard card;
    card.participant = "P01";
    display->begin(card);
  }
  bool says(const std::string& words) const {
    for (const std::string& line : lines)
      if (line.find(words) != std::string::npos) return true;
    return false;
  }
  void wait(int seconds) {
    clock.sleep_until_ns(clock.now_ns() + seconds * kSecond_ns);
    display->refresh();
  }

  SimulatedClock clock{0};
  std::vector<std::string> lines;
  std::unique_ptr<Display> display = make_screen_display([this] { return std::make_unique<test::KeptFrames>(lines); },
                                                         std::make_unique<test::SharedClock>(clock));
};

TEST_CASE("The time left goes by while the session does, and stands still while a person or a stop holds it") {
  Screen shown;
  TrialOutline outline;
  outline.total = 16;
  shown.display->outline(outline);
  shown.display->phase({.word = "FIRST"});
  shown.display->time_left(20 * 60);
  shown.wait(60);
  CHECK(shown.says("about 19 min left"));
  shown.display->phase({.word = "READY?", .holds = true});
  shown.wait(0);
  CHECK(shown.says("about 19 min left"));  // what has gone is gone
  shown.wait(300);
  CHECK(shown.says("about 19 min left"));
  shown.display->phase({.word = "FIRST"});
  shown.wait(120);
  CHECK(shown.says("about 17 min left"));
  shown.display->stopped(StopShown{"key", shown.clock.now_ns()});
  shown.wait(600);
  CHECK(shown.says("about 17 min left"));
  shown.display->stopped(std::nullopt);
  shown.wait(60);
  CHECK(shown.says("about 16 min left"));
}

TEST_CASE("The page of keys gives way to whatever asks") {
  Screen shown;
  const Scene scene{.heading = "Trial 3 of 16", .keys = {{"space", "when the participant is ready"}}};
  shown.display->scene(scene);
  REQUIRE(shown.display->help(true));
  SECTION("a line to be typed") {
    shown.display->field("Note", LineEditor("the lamp flickers"));
    CHECK(shown.says("the lamp flickers"));
  }
  SECTION("a dialog") {
    shown.display->ask("End this session?", {{"n", "no, go on"}});
    CHECK(shown.says("End this session?"));
  }
  SECTION("words for the participant") {
    shown.display->say(CuePlace::first, "first sphere", false, false);
  }
  SECTION("a stop") {
    shown.display->stopped(StopShown{"key", 0});
  }
  CHECK_FALSE(shown.display->help(false));  // it has gone already
}

TEST_CASE("The log is read back at most to its first line that is kept") {
  Screen shown;
  shown.display->scene({.heading = "Trial 3 of 16"});
  for (int i = 0; i < 6000; ++i) {
    shown.display->log(fmt::format("line {}", i));
    if (i % 100 == 0) shown.display->scroll(KeyName::page_up);
  }
  for (int i = 0; i < 6000; ++i) shown.display->scroll(KeyName::page_up);
  CHECK(shown.says("line 1000"));
  CHECK_FALSE(shown.says("line 999"));
  shown.display->scroll(KeyName::page_down);
  CHECK_FALSE(shown.says("line 1000"));  // one key, and it moves
}

// Words that are read from two metres: what is drawn, and when it is not.

const std::string kLetters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789ÄÖÜäöüßçñ"
    "ËëÏïÁáÉéÍíÓóÚúÀàÈèÌìÒòÙùÂâÊêîÔôûÅåæø_*<>.,!?:;-'\"()/+=&%";

TEST_CASE("A letter is five rows high, in half blocks") {
  const auto drawn = large_text("Hi", 80, LetterSize::half, true);
  REQUIRE(drawn);
  CHECK(*drawn == std::vector<std::string>{"█   █ ▀", "█▄▄▄█ █", "█   █ █", "▀   ▀ ▀", "       "});
  CHECK(*large_text("i", 80, LetterSize::half, false) == std::vector<std::string>{"'", "#", "#", "'", " "});
  CHECK(*large_text("ä", 80, LetterSize::half, true) ==
        std::vector<std::string>{" ▀ ▀ ", " ▀▀▀▄", "▄▀▀▀█", " ▀▀▀▀", "     "});
  CHECK(large_text("i", 80, LetterSize::full, true)->front() == "██");
}

TEST_CASE("Every letter of the font looks different, in both sizes, and in ASCII") {
  for (const LetterSize size : {LetterSize::half, LetterSize::full})
    for (const bool unicode : {true, false}) {
      std::set<std::vector<std::string>> seen;
      for (const char32_t letter : code_points(kLetters)) {
        const std::string text = to_utf8(std::u32string(1, letter));
        const auto rows = large_text(text, 80, size, unicode);
        INFO(text);
        if (letter == U'ç' || letter == U'ñ') continue;  // not in it: plain text
        REQUIRE(rows);
        CHECK(seen.insert(*rows).second);
        for (const std::string& row : *rows)
          for (const char c : row) CHECK((unicode || static_cast<unsigned char>(c) < 0x80));
      }
    }
}

TEST_CASE("Large words are broken at spaces, fit their room, or are left to plain text") {
  for (int columns = 20; columns <= 200; columns += 7)
    for (int rows = 1; rows <= 30; ++rows) {
      const auto drawn = largest_text("Gleich oder verschieden?", columns, rows, true);
      if (!drawn) continue;
      CHECK(static_cast<int>(drawn->size()) <= rows);
      for (const std::string& row : *drawn) CHECK(columns_of(row) <= columns);
    }
  CHECK(largest_text("Same or different?", 78, 10, true)->size() == 10);  // two lines
  CHECK(largest_text("Same or different?", 120, 5, true)->size() == 5);   // one
  CHECK_FALSE(largest_text("Same or different?", 120, 4, true));          // no room
  CHECK_FALSE(largest_text("Same or different?", 30, 20, true));          // a word is too wide
  CHECK_FALSE(largest_text("同じですか", 120, 20, true));                 // no glyphs
  CHECK_FALSE(largest_text("", 120, 20, true));
}

// What stands at a place of xterm's palette, its relative luminance (WCAG 2.2) and the contrast of two.
double channel(int value) {
  const double share = value / 255.0;
  return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
}
double luminance(int colour) {
  std::array<int, 3> rgb{};
  if (colour >= 232) {
    rgb.fill(8 + 10 * (colour - 232));
  } else {
    const int cube = colour - 16;
    const auto level = [](int step) { return step == 0 ? 0 : 55 + 40 * step; };
    rgb = {level(cube / 36), level(cube / 6 % 6), level(cube % 6)};
  }
  return 0.2126 * channel(rgb[0]) + 0.7152 * channel(rgb[1]) + 0.0722 * channel(rgb[2]);
}
double contrast(int a, int b) {
  const double la = luminance(a), lb = luminance(b);
  return (std::max(la, lb) + 0.05) / (std::min(la, lb) + 0.05);
}

TEST_CASE("Every state has colours of its own, on dark and on light terminals, and a contrast of at least 4.5 to 1") {
  CHECK(contrast(16, 231) == Approx(21));
  std::set<int> backgrounds;
  for (const Shade shade : kShades) {
    const ColourPair pair = colours_of(shade, 256);
    REQUIRE(pair.foreground >= 16);  // those below are the terminal's, and whatever it makes of them
    REQUIRE(pair.background >= 16);
    INFO(static_cast<int>(shade));
    CHECK(contrast(pair.foreground, pair.background) >= 4.5);
    backgrounds.insert(pair.background);
    const ColourPair few = colours_of(shade, 8);
    CHECK((few.foreground >= 0 && few.foreground < 8 && few.background >= 0 && few.background < 8));
    CHECK(few.foreground != few.background);
  }
  CHECK(backgrounds.size() == kShades.size());
}

}  // namespace
}  // namespace jnd
