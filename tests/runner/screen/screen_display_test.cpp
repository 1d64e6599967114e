// What is on the screen from one event to the next.
#include "runner/screen/screen_display.h"

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/catch.h"
#include "tests/runner/screen/kept_frames.h"

namespace jnd {
namespace {

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

}  // namespace
}  // namespace jnd
