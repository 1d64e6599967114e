// Learning buttons from the reports of boxes of several makes, pressed by a person who does as told.
#include "devices/hid/buttons/button_learner.h"

#include <algorithm>
#include <functional>
#include <random>
#include <set>

#include "tests/catch.h"
#include "tests/units.h"

namespace jnd {
namespace {

using Report = std::vector<std::uint8_t>;
using Presses = std::vector<std::set<std::size_t>>;  // at each asking, which of the box's buttons

// How far one of the box's buttons is pressed, 0 to 1, for each.
using Travel = std::array<double, 4>;

// Answers the reports that a box sends at a time, 1 ms after the other.
using Box = std::function<std::vector<Report>(std::int64_t now_ms, const Travel& travel)>;

// Presses 400 ms after being told to, lets go 300 ms after that; a finger takes 40 ms for the way.
class Person {
 public:
  // The last ones are pressed from then on.
  explicit Person(Presses presses) : presses_(std::move(presses)) {}
  std::int64_t hold_ms = 100'000;  // lets go by itself after so long
  std::size_t patient_times = 0;   // but for the first so many

  void hear(const std::string& words, std::int64_t now_ms) {
    heard.push_back(words);
    if (words.find("hold it") != std::string::npos) {
      pressing_ = presses_[std::min(asked_++, presses_.size() - 1)];
      down_at_ms_ = now_ms + 400;
      up_at_ms_ = down_at_ms_ + (asked_ <= patient_times ? 100'000 : hold_ms);
    } else if (words == "Let go.") {
      up_at_ms_ = std::min(up_at_ms_, now_ms + 300);
    }
  }
  Travel travel(std::int64_t now_ms) const {
    Travel travel{};
    const double in = std::clamp(static_cast<double>(now_ms - down_at_ms_) / 40, 0.0, 1.0);
    const double out = std::clamp(static_cast<double>(now_ms - up_at_ms_) / 40, 0.0, 1.0);
    for (const std::size_t button : pressing_) travel[button] = in - out;
    return travel;
  }
  std::vector<std::string> heard;

 private:
  Presses presses_;
  std::set<std::size_t> pressing_;
  std::size_t asked_ = 0;
  std::int64_t down_at_ms_ = 1'000'000'000, up_at_ms_ = 1'000'000'000;
};

struct Lesson {
  bool done = false;
  std::optional<ButtonMapping> mapping;
  std::vector<std::string> heard;
};

Lesson learn(const LearnerSetup& setup, const Box& box, Person person) {
  ButtonLearner learner(setup, 0);
  for (std::int64_t now_ms = 0; now_ms < 200'000 && !learner.done() && !learner.refused(); ++now_ms) {
    for (const std::string& words : learner.take_words()) person.hear(words, now_ms);
    for (const Report& report : box(now_ms, person.travel(now_ms))) learner.report(report, now_ms * kMs);
    learner.look(now_ms * kMs);
  }
  for (const std::string& words : learner.take_words()) person.hear(words, 0);
  Lesson lesson{learner.done(), {}, person.heard};
  if (learner.done()) lesson.mapping = learner.mapping();
  return lesson;
}

// What a mapping of a lesson finds in a report.
bool finds(const Lesson& lesson, ButtonMeaning meaning, const Report& report) {
  const auto& buttons = lesson.mapping->buttons;
  const auto button =
      std::find_if(buttons.begin(), buttons.end(), [&](const MappedButton& one) { return one.meaning == meaning; });
  return button != buttons.end() && is_pressed(*button, report) == true;
}

std::size_t times(const Lesson& lesson, const std::string& part) {
  return static_cast<std::size_t>(std::count_if(lesson.heard.begin(), lesson.heard.end(), [&](const std::string& one) {
    return one.find(part) != std::string::npos;
  }));
}

LearnerSetup setup_of(std::uint16_t usage_page, std::uint16_t usage) {
  LearnerSetup setup;
  setup.info.vendor = 0x046d;
  setup.info.product = 0xc216;
  setup.info.usage_page = usage_page;
  setup.info.usage = usage;
  setup.info.product_name = "Box";
  return setup;
}

// A box that sends a report where it differs from the one before only.
Box on_change(const std::function<Report(std::int64_t, const Travel&)>& state) {
  return [state, before = state(0, {})](std::int64_t now_ms, const Travel& travel) mutable {
    const Report now = state(now_ms, travel);
    if (now == before) return std::vector<Report>{};
    before = now;
    return std::vector<Report>{now};
  };
}

// Every 8 ms: four axes that jitter, a hat, buttons, a trigger that has an axis too, a counter. Button 0: bit 5 of byte
// 4; 1: the trigger, bit 1 of byte 5 and the axis of byte 6; 2, 3: the hat to the left and to the right.
Box gamepad() {
  return [random = std::mt19937(7), counter = 0](std::int64_t now_ms, const Travel& travel) mutable {
    if (now_ms % 8 != 0) return std::vector<Report>{};
    std::uniform_int_distribution<int> jitter(-1, 1);
    Report report(8);
    for (std::size_t axis = 0; axis < 4; ++axis) report[axis] = static_cast<std::uint8_t>(128 + jitter(random));
    const int hat = travel[2] > 0.5 ? 6 : travel[3] > 0.5 ? 2 : 8;
    report[4] = static_cast<std::uint8_t>(hat | (travel[0] > 0.5 ? 0x20 : 0));
    report[5] = travel[1] > 0.5 ? 2 : 0;
    report[6] = static_cast<std::uint8_t>(255 * travel[1]);
    report[7] = static_cast<std::uint8_t>(++counter);
    return std::vector<Report>{report};
  };
}

TEST_CASE("A gamepad's button and trigger are learnt beside axes that jitter and a counter") {
  const Lesson lesson = learn(setup_of(1, 5), gamepad(), Person(Presses{{0}, {0}, {1}}));
  REQUIRE(lesson.done);
  CHECK(lesson.mapping->report_bytes == 8);
  CHECK_FALSE(lesson.mapping->report_id);
  REQUIRE(lesson.mapping->buttons.size() == 2);
  CHECK(described(lesson.mapping->buttons[0]) == "byte 4, bit 5");
  CHECK(described(lesson.mapping->buttons[1]) == "byte 5, bit 1");
  CHECK(lesson.heard.front() == "Take your hands and feet off the box for a moment.");
  CHECK(times(lesson, "hold it") == 4);  // each twice, no attempt in vain
  CHECK(times(lesson, "Let go.") == 4);
  // What is written can be read.
  CHECK(parse_button_mapping(to_json(*lesson.mapping), "box.json").buttons.size() == 2);
}

TEST_CASE("Two directions of a hat are two buttons that are not taken for each other") {
  const Lesson lesson = learn(setup_of(1, 5), gamepad(), Person(Presses{{2}, {2}, {3}}));
  REQUIRE(lesson.done);
  Report report = {128, 128, 128, 128, 0, 0, 0, 0};
  for (int hat = 0; hat <= 8; ++hat) {
    report[4] = static_cast<std::uint8_t>(hat);
    const bool same = finds(lesson, ButtonMeaning::same, report),
               other = finds(lesson, ButtonMeaning::different, report);
    CHECK_FALSE((same && other));
    if (hat % 2 == 0) {  // between two directions either will do
      CHECK(same == (hat == 6));
      CHECK(other == (hat == 2));
    }
  }
  CHECK(parse_button_mapping(to_json(*lesson.mapping), "box.json").buttons.size() == 2);
}

TEST_CASE("A button and a direction of the hat beside it in its byte are seen at once") {
  const Lesson lesson = learn(setup_of(1, 5), gamepad(), Person(Presses{{0}, {0}, {2}}));
  REQUIRE(lesson.done);
  Report report = {128, 128, 128, 128, 0x26, 0, 0, 0};
  CHECK(finds(lesson, ButtonMeaning::same, report));
  CHECK(finds(lesson, ButtonMeaning::different, report));
  report[4] = 0x28;
  CHECK(finds(lesson, ButtonMeaning::same, report));
  CHECK_FALSE(finds(lesson, ButtonMeaning::different, report));
}

TEST_CASE("Keys of a boot keyboard are learnt by their code, wherever it stands in the report") {
  // Presses of 'a' and of Enter.
  const Box keyboard = on_change([](std::int64_t, const Travel& travel) {
    Report report(8);
    std::size_t place = 2;
    if (travel[0] > 0.5) report[place++] = 4;
    if (travel[1] > 0.5) report[place++] = 40;
    if (travel[2] > 0.5) report[0] = 0x10;  // a modifier: right control
    return report;
  });
  LearnerSetup setup = setup_of(1, 6);
  setup.with_stop = true;
  const Lesson lesson = learn(setup, keyboard, Person(Presses{{0}, {0}, {1}, {1}, {2}}));
  REQUIRE(lesson.done);
  REQUIRE(lesson.mapping->buttons.size() == 3);
  CHECK(described(lesson.mapping->buttons[0]) == "key code 4");
  CHECK(described(lesson.mapping->buttons[1]) == "key code 40");
  CHECK(described(lesson.mapping->buttons[2]) == "byte 0, bit 4");
  CHECK(finds(lesson, ButtonMeaning::different, {0, 0, 4, 40, 0, 0, 0, 0}));
  CHECK(finds(lesson, ButtonMeaning::stop, {0x12, 0, 4, 40, 0, 0, 0, 0}));
}

TEST_CASE("A pedal of one byte whose contacts bounce is learnt, and pressed at 0 where it is wired so") {
  for (const bool active_low : {false, true}) {
    const Box pedal = on_change([&](std::int64_t now_ms, const Travel& travel) {
      int bits = 0;
      for (std::size_t i = 0; i < 2; ++i) {
        const bool bouncing = travel[i] > 0.4 && travel[i] < 0.6;
        if (travel[i] > 0.5 && !(bouncing && now_ms % 3 == 0)) bits |= 1 << i;
      }
      return Report{static_cast<std::uint8_t>(active_low ? ~bits : bits)};
    });
    const Lesson lesson = learn(setup_of(0x0c, 3), pedal, Person(Presses{{0}, {0}, {1}}));
    REQUIRE(lesson.done);
    CHECK(lesson.mapping->report_bytes == 1);
    const auto up = static_cast<std::uint8_t>(active_low ? 0xff : 0);
    CHECK_FALSE(finds(lesson, ButtonMeaning::same, {up}));
    CHECK(finds(lesson, ButtonMeaning::same, {static_cast<std::uint8_t>(up ^ 1)}));
    CHECK(finds(lesson, ButtonMeaning::different, {static_cast<std::uint8_t>(up ^ 3)}));
    CHECK_FALSE(finds(lesson, ButtonMeaning::different, {static_cast<std::uint8_t>(up ^ 1)}));
  }
}

// Report 1: buttons, on change; report 2: movement, streaming; report 3: two more buttons.
Box numbered() {
  return [before = Report{1, 0, 0}, before_3 = Report{3, 0}](std::int64_t now_ms, const Travel& travel) mutable {
    std::vector<Report> reports;
    Report buttons = {1, 0, static_cast<std::uint8_t>((travel[0] > 0.5 ? 0x40 : 0) | (travel[1] > 0.5 ? 0x80 : 0))};
    if (buttons != before) reports.push_back(before = buttons);
    Report more = {3, static_cast<std::uint8_t>(travel[2] > 0.5 ? 1 : 0)};
    if (more != before_3) reports.push_back(before_3 = more);
    if (now_ms % 10 == 0)
      reports.push_back({2, static_cast<std::uint8_t>(now_ms / 10), static_cast<std::uint8_t>(now_ms * 37), 9, 9, 9});
    return reports;
  };
}

TEST_CASE("Buttons of numbered reports are learnt with the report's number") {
  LearnerSetup setup = setup_of(1, 5);
  setup.numbered = true;
  setup.info.serial = "A7";
  const Lesson lesson = learn(setup, numbered(), Person(Presses{{0}, {0}, {1}}));
  REQUIRE(lesson.done);
  CHECK(lesson.mapping->report_id == 1);
  CHECK(lesson.mapping->report_bytes == 3);
  CHECK(lesson.mapping->serial == "A7");
  CHECK(described(lesson.mapping->buttons[0]) == "byte 2, bit 6");
  CHECK(described(lesson.mapping->buttons[1]) == "byte 2, bit 7");
}

TEST_CASE("Buttons of two different reports are no pair, with words") {
  LearnerSetup setup = setup_of(1, 5);
  setup.numbered = true;
  const Lesson refused = learn(setup, numbered(), Person(Presses{{0}, {0}, {2}}));
  CHECK_FALSE(refused.done);
  CHECK(times(refused, "DIFFERENT comes in report 3, SAME in report 1") == 4);
  CHECK(times(refused, "DIFFERENT could not be learnt in 4 attempts") == 1);
}

TEST_CASE("The same button twice is refused, and another one then accepted") {
  const Lesson lesson = learn(setup_of(1, 5), gamepad(), Person(Presses{{0}, {0}, {0}, {0}, {1}}));
  REQUIRE(lesson.done);
  CHECK(times(lesson, "That was SAME again: take another button for DIFFERENT.") == 1);
  CHECK(described(lesson.mapping->buttons[1]) == "byte 5, bit 1");
}

TEST_CASE("Two buttons together are ambiguous: which one is meant is not guessed") {
  const Lesson refused = learn(setup_of(1, 5), gamepad(), Person(Presses{{0, 1}}));
  CHECK_FALSE(refused.done);
  CHECK(times(refused, "More than one thing changed with SAME (byte 4, bit 5; byte 5, bit 1)") == 4);
  const Lesson second_thought = learn(setup_of(1, 5), gamepad(), Person(Presses{{0, 1}, {0, 1}, {0}, {0}, {1}}));
  CHECK(second_thought.done);
}

TEST_CASE("Something else pressed the second time is not learnt") {
  const Lesson lesson = learn(setup_of(1, 5), gamepad(), Person(Presses{{0}, {1}, {0}, {0}, {1}}));
  REQUIRE(lesson.done);
  CHECK(times(lesson, "Nothing in the reports was there exactly while SAME was held") == 1);
  CHECK(described(lesson.mapping->buttons[0]) == "byte 4, bit 5");
}

TEST_CASE("Bits that flicker only while a button is held are told from it, in the same byte") {
  const Box box = [](std::int64_t now_ms, const Travel& travel) {
    if (now_ms % 8 != 0) return std::vector<Report>{};
    const int flicker = travel[0] > 0 || travel[1] > 0 ? static_cast<int>(now_ms / 24 % 4) : 0;
    return std::vector<Report>{
        {static_cast<std::uint8_t>((travel[0] > 0.5 ? 0x80 : 0) | (travel[1] > 0.5 ? 0x40 : 0) | flicker)}};
  };
  const Lesson lesson = learn(setup_of(1, 5), box, Person(Presses{{0}, {0}, {1}}));
  REQUIRE(lesson.done);
  CHECK(described(lesson.mapping->buttons[0]) == "byte 0, bit 7");
  CHECK(described(lesson.mapping->buttons[1]) == "byte 0, bit 6");
}

TEST_CASE("A pedal that is an axis only is refused, with words") {
  const Box axis = on_change([](std::int64_t, const Travel& travel) {
    return Report{static_cast<std::uint8_t>(255 * travel[0]), 0};
  });
  const Lesson refused = learn(setup_of(1, 4), axis, Person(Presses{{0}}));
  CHECK_FALSE(refused.done);
  CHECK(times(refused, "An axis or a trigger that moves gradually does not do") == 4);
}

TEST_CASE("A button that is let go too soon is asked for again") {
  Person hasty(Presses{{0}});
  hasty.hold_ms = 200;
  const Lesson refused = learn(setup_of(1, 5), gamepad(), hasty);
  CHECK_FALSE(refused.done);
  CHECK(times(refused, "It was let go too soon") == 4);
  // A box that is silent without presses cannot know at once: it finds that nothing changes after "let go".
  const Box pedal =
      on_change([](std::int64_t, const Travel& travel) { return Report{static_cast<std::uint8_t>(travel[0] > 0.5)}; });
  const Lesson silent = learn(setup_of(0x0c, 3), pedal, hasty);
  CHECK_FALSE(silent.done);
  CHECK(times(silent, "Nothing changed when it was let go") == 4);
  // Once a button is learnt it is known what such a box says with all buttons up.
  const Box two = on_change([](std::int64_t, const Travel& travel) {
    return Report{static_cast<std::uint8_t>((travel[0] > 0.5 ? 1 : 0) | (travel[1] > 0.5 ? 2 : 0))};
  });
  Person tired(Presses{{0}, {0}, {1}});
  tired.hold_ms = 200;
  tired.patient_times = 2;
  const Lesson half = learn(setup_of(0x0c, 3), two, tired);
  CHECK_FALSE(half.done);
  CHECK(times(half, "SAME: byte 0, bit 0.") == 1);
  CHECK(times(half, "It was let go too soon") == 4);
}

TEST_CASE("Whether reports are numbered is in the report descriptor") {
  // A boot keyboard's begins so; then a report number, and data that look like one within a long item and a value.
  const Report keyboard = {0x05, 0x01, 0x09, 0x06, 0xa1, 0x01, 0x05, 0x07, 0x19, 0xe0, 0x29, 0xe7, 0xc0};
  CHECK_FALSE(numbers_reports(keyboard));
  CHECK(numbers_reports(Report{0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x85, 0x01, 0xc0}));
  CHECK_FALSE(numbers_reports(Report{0x09, 0x85, 0xfe, 0x02, 0x10, 0x85, 0x01, 0x27, 0x85, 0x85, 0x85, 0x85, 0xc0}));
  CHECK_FALSE(numbers_reports(Report{}));
  CHECK_FALSE(numbers_reports(Report{0xfe}));
}

}  // namespace
}  // namespace jnd
