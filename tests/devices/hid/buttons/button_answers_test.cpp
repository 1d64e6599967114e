// Which presses answer a question, and which do not: early ones, held ones, two at once.
#include <algorithm>

#include <rapidcheck.h>

#include "devices/hid/buttons/button_presses.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/units.h"

namespace jnd {
namespace {

ButtonChange down(ButtonMeaning meaning, std::int64_t at_ms) {
  return {meaning, true, false, at_ms * kMs};
}

ButtonChange up(ButtonMeaning meaning, std::int64_t at_ms) {
  return {meaning, false, false, at_ms * kMs};
}

constexpr ButtonMeaning kSame = ButtonMeaning::same, kDifferent = ButtonMeaning::different;

TEST_CASE("A press after the question answers it once it has stayed alone for 30 ms") {
  ButtonAnswers answers;
  answers.ask(1000 * kMs);
  answers.change(down(kSame, 1500));
  CHECK(answers.pending());
  CHECK_FALSE(answers.take(1530 * kMs));
  const std::optional<ButtonAnswer> answer = answers.take(1531 * kMs);
  REQUIRE(answer);
  CHECK(answer->said == kClassSame);
  CHECK(answer->time_ns == 1500 * kMs);
  CHECK_FALSE(answers.take(1600 * kMs));
  // The question is answered: nothing more is heard until the next.
  answers.change(up(kSame, 1610));
  answers.change(down(kDifferent, 1700));
  CHECK_FALSE(answers.take(1800 * kMs));
  CHECK(answers.trouble() == AnswerTrouble::none);
}

TEST_CASE("A button that is down since before the question is no answer until it is pressed anew") {
  ButtonAnswers answers;
  answers.change(down(kDifferent, 900));
  answers.ask(1000 * kMs);
  CHECK(answers.trouble() == AnswerTrouble::held);
  CHECK_FALSE(answers.take(5000 * kMs));
  answers.change(up(kDifferent, 5100));
  answers.change(down(kDifferent, 5200));
  CHECK(answers.take(5300 * kMs)->time_ns == 5200 * kMs);
  CHECK(answers.trouble() == AnswerTrouble::none);
}

TEST_CASE("A press before the question that is heard of after it is early") {
  ButtonAnswers answers;
  answers.ask(1000 * kMs);
  answers.change(down(kSame, 999));
  CHECK_FALSE(answers.take(2000 * kMs));
  answers.change(down(kDifferent, 2100));  // with the other still held
  CHECK_FALSE(answers.take(3000 * kMs));
  CHECK(answers.trouble() == AnswerTrouble::two_at_once);
}

TEST_CASE("Two buttons at once are no answer, in whichever way they come together") {
  for (const std::int64_t gap_ms : {0, 1, 30, 500}) {  // the first still held, its answer not taken
    ButtonAnswers answers;
    answers.ask(0);
    answers.change(down(kSame, 1000));
    answers.change(down(kDifferent, 1000 + gap_ms));
    CHECK_FALSE(answers.take(9000 * kMs));
    CHECK(answers.trouble() == AnswerTrouble::two_at_once);
    CHECK(answers.trouble() == AnswerTrouble::none);  // told once
    // The question goes on: with one let go the other is still no answer, with both it is open again.
    answers.change(up(kSame, 9100));
    CHECK_FALSE(answers.take(9500 * kMs));
    answers.change(up(kDifferent, 9600));
    answers.change(down(kSame, 9700));
    CHECK(answers.take(9800 * kMs)->said == kClassSame);
  }
  ButtonAnswers quick;  // the first let go already, but not 30 ms ago
  quick.ask(0);
  quick.change(down(kSame, 1000));
  quick.change(up(kSame, 1012));
  quick.change(down(kDifferent, 1030));
  CHECK_FALSE(quick.take(9000 * kMs));
  CHECK(quick.trouble() == AnswerTrouble::two_at_once);
  ButtonAnswers after;  // the first let go in time: it is the answer
  after.ask(0);
  after.change(down(kSame, 1000));
  after.change(up(kSame, 1012));
  after.change(down(kDifferent, 1031));
  CHECK(after.take(9000 * kMs)->said == kClassSame);
}

TEST_CASE("A press that stands when the box goes stays an answer, and nothing is held afterwards") {
  ButtonAnswers answers;
  answers.ask(0);
  answers.change(down(kSame, 100));
  answers.forget();
  CHECK(answers.take(200 * kMs)->said == kClassSame);
  answers.ask(300 * kMs);
  CHECK(answers.trouble() == AnswerTrouble::none);
  answers.change(down(kDifferent, 400));
  CHECK(answers.take(500 * kMs)->said == kClassDifferent);
  // Plugged in again with a button down: that is no press.
  answers.forget();
  answers.ask(600 * kMs);
  answers.change({kSame, true, true, 700 * kMs});
  CHECK_FALSE(answers.take(900 * kMs));
  CHECK(answers.trouble() == AnswerTrouble::held);
}

struct Held {
  ButtonMeaning meaning = kSame;
  std::int64_t from_ms = 0, to_ms = 0;
};

// Presses of both buttons, of any lengths and in any order of the two.
std::vector<Held> any_presses() {
  std::vector<Held> presses;
  for (const ButtonMeaning meaning : {kSame, kDifferent}) {
    std::int64_t at_ms = 0;
    for (const auto& [gap_ms, length_ms] : *rc::gen::container<std::vector<std::pair<int, int>>>(
             rc::gen::pair(rc::gen::inRange(11, 120), rc::gen::inRange(11, 120)))) {
      at_ms += gap_ms;
      presses.push_back({meaning, at_ms, at_ms + length_ms});
      at_ms += length_ms;
    }
  }
  return presses;
}

std::vector<ButtonChange> changes_of(const std::vector<Held>& presses) {
  std::vector<ButtonChange> changes;
  for (const Held& press : presses) {
    changes.push_back(down(press.meaning, press.from_ms));
    changes.push_back(up(press.meaning, press.to_ms));
  }
  // Of the same time, what is let go comes first.
  std::sort(changes.begin(), changes.end(), [](const ButtonChange& a, const ButtonChange& b) {
    return std::pair(a.time_ns, a.pressed) < std::pair(b.time_ns, b.pressed);
  });
  return changes;
}

TEST_CASE("Whatever is pressed, an answer is the press of one button alone, after the question") {
  REQUIRE(rc::check("an answer stands alone; a press that stands alone is an answer", [] {
    const std::vector<Held> presses = any_presses();
    const std::int64_t asked_ms = *rc::gen::inRange(0, 200), looks_ms = *rc::gen::inRange(1, 60);
    ButtonAnswers answers;
    std::optional<ButtonAnswer> answer;
    bool asked = false;
    std::int64_t taken_ms = 0;
    auto changes = changes_of(presses);
    auto next = changes.begin();
    for (std::int64_t now_ms = 0; now_ms < 40'000 && !answer; ++now_ms) {
      if (now_ms == asked_ms) {
        answers.ask(now_ms * kMs);
        asked = true;
      }
      for (; next != changes.end() && next->time_ns <= now_ms * kMs; ++next) answers.change(*next);
      if (asked && now_ms % looks_ms == 0) answer = answers.take(now_ms * kMs);
      taken_ms = now_ms;
      if (next == changes.end() && now_ms > asked_ms + 400 && !answers.pending()) break;
    }
    // Alone: after the question, no other button down when it came, none pressed within 30 ms, none while it was held.
    const auto alone = [&](const Held& press) {
      if (press.from_ms < asked_ms) return false;
      return std::none_of(presses.begin(), presses.end(), [&](const Held& other) {
        if (other.meaning == press.meaning) return false;
        if (other.from_ms <= press.from_ms && press.from_ms < other.to_ms) return true;
        const std::int64_t apart_ms = std::abs(other.from_ms - press.from_ms);
        return apart_ms <= 30;
      });
    };
    if (answer) {
      const auto press = std::find_if(presses.begin(), presses.end(), [&](const Held& one) {
        return one.from_ms * kMs == answer->time_ns && (one.meaning == kSame) == (answer->said == kClassSame);
      });
      RC_ASSERT(press != presses.end());
      RC_ASSERT(alone(*press));
      // Nothing was pressed while it was held before it was taken.
      RC_ASSERT(std::none_of(presses.begin(), presses.end(), [&](const Held& other) {
        return other.meaning != press->meaning && other.from_ms >= press->from_ms && other.from_ms < press->to_ms &&
               other.from_ms < taken_ms;
      }));
    } else {
      // Without an answer, every press was early, or not alone, or joined while it was held.
      for (const Held& press : presses) {
        const bool joined = std::any_of(presses.begin(), presses.end(), [&](const Held& other) {
          return other.meaning != press.meaning && other.from_ms >= press.from_ms && other.from_ms < press.to_ms;
        });
        RC_ASSERT(!alone(press) || joined);
      }
    }
  }));
}

}  // namespace
}  // namespace jnd
