// The session's console with keys from a pipe or a pseudo-terminal, and a display that keeps what it is told.
#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include <pty.h>
#include <unistd.h>

#include "runner/keyboard.h"
#include "runner/session_console.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// Standard input is a pipe with these keys, and then ends; or a pseudo-terminal, where keys are pressed later.
class Input {
 public:
  explicit Input(const std::string& piped) {
    std::array<int, 2> ends{};
    REQUIRE(pipe(ends.data()) == 0);
    keys_ = ends[1];
    press(piped);
    close(keys_);
    keys_ = -1;
    become(ends[0]);
  }
  Input() {
    int terminal = -1;
    REQUIRE(openpty(&keys_, &terminal, nullptr, nullptr, nullptr) == 0);
    become(terminal);
  }
  ~Input() {
    dup2(before_, STDIN_FILENO);
    close(before_);
    if (keys_ >= 0) close(keys_);
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  void press(const std::string& keys) const {
    REQUIRE(write(keys_, keys.data(), keys.size()) == static_cast<ssize_t>(keys.size()));
  }

 private:
  void become(int descriptor) const {
    dup2(descriptor, STDIN_FILENO);
    close(descriptor);
  }
  int before_ = dup(STDIN_FILENO), keys_ = -1;
};

// Every look at it costs time.
class ElapsingClock final : public Clock {
 public:
  std::int64_t now_ns() const noexcept override { return now_ns_ += step_ns; }
  std::int64_t utc_ns() const noexcept override { return now_ns_; }
  void sleep_until_ns(std::int64_t deadline) noexcept override { now_ns_ = std::max(now_ns_, deadline); }
  std::int64_t step_ns = 0;

 private:
  mutable std::int64_t now_ns_ = 0;
};

class KeptDisplay final : public Display {
 public:
  void begin(const SessionCard&) override {}
  void end(const std::string&) override {}
  void announce(const std::string&, bool) override {}
  void scene(const Scene& scene) override { told.push_back("scene " + scene.heading); }
  void keys_again() override {}
  void working_keys(const std::vector<KeyHint>& hints) override {
    keys.clear();
    for (const KeyHint& hint : hints) keys += hint.key;
  }
  void say(CuePlace, const std::string& words, bool aloud, bool beep) override {
    if (while_drawing) while_drawing();
    told.push_back((aloud ? "say " : "name ") + words + (beep ? " with a beep" : ""));
  }
  void feedback(const std::string&) override {}
  void tell(Tone, const std::string&) override {}
  void explain(Tone, const std::string& text) override {
    told.push_back("explain " + text);
    if (explained) explained();
  }
  void answer(const std::string&, const std::string&) override {}
  void countdown(const std::string&, double, double) override { counting = true; }
  void countdown_over() override { counting = false; }
  void field(const std::string&, const LineEditor&) override {}
  void field_done() override {}
  void ask(const std::string&, const std::vector<KeyHint>&) override {}
  void page(const QuestionnairePage& page) override {
    if (shown) shown(page);
  }
  bool scroll(KeyName name) override {
    if (name == KeyName::page_down) told.push_back("scroll down");
    return name == KeyName::page_down;
  }
  bool by_lines() const noexcept override { return false; }

  std::vector<std::string> told;
  std::string keys;
  bool counting = false;
  std::function<void()> while_drawing, explained;
  std::function<void(const QuestionnairePage&)> shown;
};

struct Bench {
  Bench() : Bench(std::make_unique<Input>()) {}
  explicit Bench(const std::string& piped) : Bench(std::make_unique<Input>(piped)) {}
  explicit Bench(std::unique_ptr<Input> keys)
      : input(std::move(keys)),
        made(new KeptDisplay),
        display(*made),
        console(ConsoleOptions(), protocol, &keyboard, clock, interrupted, std::unique_ptr<Display>(made)) {}

  void ask() {
    CueSignal cue;
    cue.kind = "sound";
    cue.say = "Same or different?";
    console.cue(CuePlace::question, cue);
  }
  std::optional<Answer> judge(double time_out_s) {
    const Trial trial;
    const std::array<Presentation, 2> presentations;
    return console.responder().judge({trial, 1, presentations, time_out_s});
  }

  std::unique_ptr<Input> input;
  Protocol protocol;
  Keyboard keyboard;
  ElapsingClock clock;
  Interrupts interrupted;
  KeptDisplay* made;
  KeptDisplay& display;
  SessionConsole console;
};

TEST_CASE("An answer that comes after the time-out does not count, though the look before it was in time") {
  for (const bool late : {false, true}) {
    Bench bench("s");
    bench.ask();
    bench.clock.step_ns = late ? 700'000'000 : 400'000'000;
    // Looked at 0.7 s after the cue, and answered 1.4 s after it; 0.4 and 0.8 s where in time.
    const std::optional<Answer> answer = bench.judge(1);
    CHECK(answer.has_value() != late);
    CHECK(bench.display.keys == "pnqx");  // what still means something
  }
}

TEST_CASE("A key that comes while the cue is drawn is early, and no answer") {
  for (const bool early : {true, false}) {
    Bench bench;
    if (early) bench.display.while_drawing = [&] { bench.input->press("s"); };
    bench.ask();
    if (!early) bench.input->press("s");
    bench.clock.step_ns = 50'000'000;
    CHECK(bench.judge(1).has_value() != early);
  }
}

TEST_CASE("Page Down scrolls a page of questions, and types nothing") {
  Question question;
  question.kind = Question::Kind::text;
  Bench bench("\x1b[6~a\t");
  const std::optional<Replies> replies = bench.console.responder().reply_all({{question, -1}});
  REQUIRE(replies);
  CHECK(replies->front() == "a");
  CHECK(bench.display.told == std::vector<std::string>{"scroll down"});
}

TEST_CASE("After the keys were looked at, the words to say are there again, without another beep") {
  Bench bench("?zs");
  bench.ask();
  CHECK(bench.judge(30));
  CHECK(bench.display.told == std::vector<std::string>{"say Same or different? with a beep", "scene ", "scene Keys",
                                                       "say Same or different?", "scene "});
}

TEST_CASE("During a presentation no key is shown that does nothing") {
  Bench bench("");
  bench.console.cue(CuePlace::first, CueSignal());
  CHECK(bench.display.keys == "rpnqx");
}

TEST_CASE("The stop key latches from a pipe too, and says so where it is no key of the scene") {
  for (const std::string key : {"x", "X"}) {
    Bench bench(key + " ");
    EmergencyStop stop;
    const StopOnKey stopping(&bench.keyboard, stop);
    CHECK(bench.console.paused("operator").wish == Wish::go_on);
    CHECK(stop.source() == StopSource::key);
    CHECK(bench.display.told.back() == "explain STOP: the devices give nothing");
  }
  Bench bench("\x1b[x ");
  EmergencyStop stop;
  const StopOnKey stopping(&bench.keyboard, stop);
  (void)bench.console.paused("operator");
  CHECK_FALSE(stop.latched());  // within a sequence
}

TEST_CASE("The countdown of free interaction is over where something else begins") {
  Bench bench("  ");
  CHECK(bench.console.exploring(10));
  CHECK(bench.display.counting);
  (void)bench.console.paused("operator");
  CHECK_FALSE(bench.display.counting);
  CHECK(bench.console.exploring(10));
  (void)bench.console.ready_to_explore(ExplorationOutline());
  CHECK_FALSE(bench.display.counting);
}

TEST_CASE("A y that is held down confirms one question of a page") {
  Question first;
  first.id = "first";
  first.kind = Question::Kind::confirm;
  Question second = first;
  second.id = "second";
  Bench bench;
  bench.display.shown = [&](const QuestionnairePage& page) {
    if (page.reviewing())
      bench.interrupted.end = true;
    else
      bench.input->press("y");
  };
  bench.display.explained = [&] { bench.interrupted.end = true; };
  CHECK_FALSE(bench.console.responder().reply_all({{first, -1}, {second, -1}}));
  CHECK(bench.display.told ==
        std::vector<std::string>{"explain y was down already: let go of it, then press it again"});
}

TEST_CASE("A line of a pipe holds no control characters and has an end") {
  Bench bench("a\x1b[\xc2\x9b" + std::string("b") + std::string(2000, 'c') + "\nnext\n");
  const std::string line = bench.console.ask_text("Note");
  CHECK(line.size() == LineEditor::kLongest);
  CHECK(line.substr(0, 4) == "a[bc");
  CHECK(bench.console.ask_text("Note") == "next");
}

TEST_CASE("While something of the rig is missing it is told, and goes on by itself when it is back") {
  Bench bench;
  int asked = 0;
  const OperatorWish wish = bench.console.missing("device RRS3-0001 is not there", [&] { return ++asked == 4; });
  CHECK(wish.wish == Wish::go_on);
  CHECK(asked == 4);
  CHECK(bench.display.told == std::vector<std::string>{"scene Something is missing."});
}

TEST_CASE("While something is missing the space bar does not go on, and the session can be left") {
  Bench bench(" qqlunch\n");
  const OperatorWish wish = bench.console.missing("device RRS3-0001 is not there", [] { return false; });
  CHECK(wish.wish == Wish::end_for_now);
  CHECK(wish.text == "lunch");
}

}  // namespace
}  // namespace jnd
