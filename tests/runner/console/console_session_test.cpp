// The session's console with keys from a pipe or a pseudo-terminal, and a display that keeps what it is told.
#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <pty.h>
#include <unistd.h>

#include "protocols/tasks/task.h"
#include "runner/console/session_console.h"
#include "runner/keys/keyboard.h"
#include "tests/catch.h"
#include "tests/wait_until.h"

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
  void scene(const Scene& scene) override {
    told.push_back("scene " + scene.heading);
    if (hints) hints(scene);
    if (on_scene) on_scene();
  }
  void keys_again() override {}
  void working_keys(const std::vector<KeyHint>& hints) override {
    keys.clear();
    key_words.clear();
    for (const KeyHint& hint : hints) {
      if (!hint.works) continue;
      keys += hint.key;
      key_words += hint.what + "; ";
    }
  }
  void say(CuePlace, const std::string& words, bool aloud, bool beep) override {
    if (while_drawing) while_drawing();
    told.push_back((aloud ? "say " : "name ") + words + (beep ? " with a beep" : ""));
  }
  void feedback(const std::string&) override {}
  void queued(const std::vector<std::string>& what) override {
    for (const std::string& one : what) told.push_back("queued " + one);
  }
  void phase(const Phase& phase) override { phases.push_back(phase); }
  void stopped(const std::optional<StopShown>& stop) override { stops.push_back(stop ? stop->by : "cleared"); }
  void counts(const AnswerCounts& counts) override { counted = counts; }
  void alert() override { ++alerts; }
  bool help(bool on) override { return std::exchange(helping, on) != on; }
  void enlarge() override { told.emplace_back("enlarged"); }
  void tell(Tone, const std::string& text) override { messages.push_back(text); }
  void explain(Tone, const std::string& text) override {
    told.push_back("explain " + text);
    if (explained) explained();
  }
  void answer(const std::string& trial, const std::string& words, const std::string&) override {
    messages.push_back("saved " + trial + ", " + words);
  }
  void countdown(const std::string&, double, double) override { counting = true; }
  void countdown_over() override { counting = false; }
  void field(const std::string&, const LineEditor&) override {
    if (typing) typing();
  }
  void field_done() override {}
  void ask(const std::string&, const std::vector<KeyHint>&) override {
    if (asking) asking();
  }
  void page(const QuestionnairePage& page) override {
    if (shown) shown(page);
  }
  bool scroll(KeyName name) override {
    if (name == KeyName::page_down) told.push_back("scroll down");
    if (name == KeyName::page_down) --to_scroll;
    return name == KeyName::page_down;
  }
  std::string unread() override { return to_scroll > 0 ? "there is more" : ""; }
  bool by_lines() const noexcept override { return false; }

  std::vector<std::string> told, messages;
  std::string keys, key_words;
  std::vector<Phase> phases;
  std::vector<std::string> stops;
  AnswerCounts counted;
  int alerts = 0;
  bool helping = false;
  bool counting = false;
  int to_scroll = 0;  // how often until all of a text was seen
  std::function<void()> on_scene, while_drawing, explained, typing, asking;
  std::function<void(const QuestionnairePage&)> shown;
  std::function<void(const Scene&)> hints;
};

struct Bench {
  Bench() : Bench(std::make_unique<Input>()) {}
  explicit Bench(const std::string& piped) : Bench(std::make_unique<Input>(piped)) {}
  explicit Bench(std::unique_ptr<Input> keys)
      : input(std::move(keys)),
        made(new KeptDisplay),
        display(*made),
        console(ConsoleOptions{.stop = &stop}, protocol, &keyboard, clock, interrupted,
                std::unique_ptr<Display>(made)) {}

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
  EmergencyStop stop;
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
    CHECK(bench.display.keys == "xpnq?");  // what still means something
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

TEST_CASE("The keys of a screen are shown over it, and the key that takes them away is no answer") {
  Bench bench;
  bench.ask();
  bench.display.on_scene = [&] { bench.input->press("?sd"); };
  const std::optional<Answer> answer = bench.judge(30);
  REQUIRE(answer);
  CHECK(answer->said == kClassDifferent);
  CHECK_FALSE(bench.display.helping);
  bench.console.cue(CuePlace::first, CueSignal());
  bench.input->press("?");
  const DeviceHealth at_work{.presenting = true};
  for (int i = 0; i < 100 && !bench.display.helping; ++i) bench.console.health(at_work);
  CHECK(bench.display.helping);
}

TEST_CASE("Large text is turned on and off with Ctrl-L, also on a page of questions") {
  Question question;
  question.kind = Question::Kind::text;
  Bench bench;
  bench.display.shown = [&](const QuestionnairePage& page) {
    if (page.editor().empty())
      bench.input->press(
          "\x0c"
          "ab\r");
  };
  const std::optional<Replies> replies = bench.console.responder().reply_all({{question, -1}});
  REQUIRE(replies);
  CHECK(replies->front() == "ab");
  CHECK(bench.display.told == std::vector<std::string>{"enlarged"});
}

TEST_CASE("During a presentation no key is shown as one that works and does nothing") {
  Bench bench("");
  bench.console.cue(CuePlace::first, CueSignal());
  CHECK(bench.display.keys == "xprnq?");
}

TEST_CASE("Keys that act later say when") {
  Bench bench("s");
  bench.console.cue(CuePlace::first, CueSignal());
  CHECK(
      bench.display.key_words ==
      "STOP the devices; pause after this trial; repeat it, after this interval; note after this trial; end after this "
      "trial; all keys; ");
  bench.ask();
  CHECK(bench.judge(30));
  CHECK(bench.display.key_words == "STOP the devices; pause; note; end; all keys; ");
}

TEST_CASE("A key that acts later is acknowledged while the presentation goes on") {
  Bench bench;
  DeviceHealth health;
  health.presenting = true;
  bench.input->press("q");
  for (int i = 0; i < 100 && bench.display.told.empty(); ++i) bench.console.health(health);
  CHECK(bench.display.told == std::vector<std::string>{"queued end after this trial"});
}

TEST_CASE("Messages about a trial carry its number, and the plan's where two trials have the same one") {
  Bench bench("");
  TrialOutline trial;
  trial.number = 5;
  trial.plan_number = 13;
  TrialOutline practice;
  practice.number = 2;
  practice.plan_number = 2;
  practice.practice = true;
  bench.console.saved(trial, {.said = kClassSame, .entered_by = EnteredBy::operator_, .response_time_s = 1.224});
  bench.console.took_back(true);
  bench.console.took_back(true);  // one that an earlier run saved
  bench.console.voided(practice, "no_answer", true);
  bench.console.voided(trial, "repeated", false);
  CHECK(bench.display.messages ==
        std::vector<std::string>{
            "saved trial 5, same, 1.22 s",
            "answer to trial 5 (plan no. 13) taken back; its trial comes again at the end of its block",
            "last answer taken back; its trial comes again at the end of its block",
            "practice 2 (plan no. 2) not counted (no answer in time); it comes again at the end of this block",
            "trial 5 (plan no. 13) not counted (repeated at your wish); its attempts are used up"});
}

TEST_CASE("What a limit did to a trial is not told: it would say how stiff an object was") {
  Bench bench("");
  bench.console.voided(TrialOutline(), "saturated", true);
  REQUIRE(bench.display.messages.size() == 1);
  CHECK(bench.display.messages[0].find("limit") == std::string::npos);
}

TEST_CASE("The stop key latches from a pipe too, and ends the wait") {
  for (const std::string key : {"x", "X"}) {
    Bench bench(key + " ");
    const StopOnKey stopping(&bench.keyboard, bench.stop);
    CHECK(bench.console.paused("operator").kind == Request::stopped);
    CHECK(bench.stop.source() == StopSource::key);
  }
  Bench bench("\x1b[x ");
  const StopOnKey stopping(&bench.keyboard, bench.stop);
  CHECK(bench.console.paused("operator").kind == Request::go_on);
  CHECK_FALSE(bench.stop.latched());  // within a sequence
}

TEST_CASE(
    "A stop ends whatever the operator is asked, also what is being typed or confirmed; the stop itself is asked") {
  const std::vector<std::function<Request(SessionConsole&)>> waits = {
      [](SessionConsole& console) { return console.ready(TrialOutline()).kind; },
      [](SessionConsole& console) { return console.paused("key").kind; },
      [](SessionConsole& console) { return console.instruct(Instruction()).kind; },
      [](SessionConsole& console) { return console.ready_to_explore(ExplorationOutline()).kind; },
      [](SessionConsole& console) { return console.missing("a device", [] { return false; }).kind; },
      [](SessionConsole& console) {
        Break pause;
        pause.duration_s = 60;
        console.break_begins(pause, false);
        return console.break_over(pause).kind;
      },
      [](SessionConsole& console) { return console.consent("I agree.") ? Request::go_on : Request::stopped; }};
  for (const auto& wait : waits) {
    Bench bench;
    bench.stop.latch(StopSource::button);
    CHECK(wait(bench.console) == Request::stopped);
  }
  for (const char* const key : {"n", "u"}) {  // a note; a dialog
    Bench bench;
    bench.display.typing = bench.display.asking = [&] { bench.stop.latch(StopSource::button); };
    bench.display.on_scene = [&] { bench.input->press(key); };
    TrialOutline outline;
    outline.can_void_last = true;
    CHECK(bench.console.ready(outline).kind == Request::stopped);
  }
  Bench bench("c\n");
  bench.stop.latch(StopSource::key);
  CHECK(bench.console.recover("key").kind == Request::go_on);
}

TEST_CASE("Ctrl-C at the consent is neither consent nor refusal") {
  Bench bench;
  bench.interrupted.pause = true;
  CHECK_FALSE(bench.console.consent("I agree."));
  CHECK_FALSE(bench.interrupted.end);
}

TEST_CASE("A text takes no answer before all of it was seen") {
  Bench agrees("yy\x1b[6~y");  // y, y, Page Down, y
  agrees.display.to_scroll = 1;
  CHECK(agrees.console.consent("A long text.") == true);
  CHECK(agrees.display.told ==
        std::vector<std::string>{"scene Consent", "explain there is more", "explain there is more", "scroll down"});
  Bench refuses;
  refuses.display.to_scroll = 1;
  refuses.display.on_scene = [&] { refuses.input->press("n"); };  // at once
  refuses.display.asking = [&] {
    refuses.display.to_scroll = 0;  // the question is seen whole
    refuses.input->press("y");
  };
  CHECK(refuses.console.consent("A long text.") == false);
  CHECK(std::find(refuses.display.told.begin(), refuses.display.told.end(), "explain there is more") ==
        refuses.display.told.end());

  Bench reads("   ");  // the space bar turns the page until there is no more
  reads.display.to_scroll = 2;
  CHECK(reads.console.instruct(Instruction()).kind == Request::go_on);
  CHECK(reads.display.told == std::vector<std::string>{"scene Instructions", "scroll down", "scroll down"});

  Question question;
  question.kind = Question::Kind::confirm;
  Bench confirms("y\t\t\x1b[6~\t");
  confirms.display.to_scroll = 1;
  confirms.display.shown = [&](const QuestionnairePage&) { confirms.display.told.emplace_back("page"); };
  CHECK(confirms.console.responder().reply_all({{question, -1}}));
  // What is told stays until something changes.
  CHECK(confirms.display.told == std::vector<std::string>{"page", "page", "explain there is more",
                                                          "explain there is more", "scroll down", "page"});
}

TEST_CASE("After a stop a full disk can still be tried again, and the session given up") {
  for (const StopSource source : {StopSource::key, StopSource::button}) {
    Bench tries("qn ");
    tries.stop.latch(source);
    CHECK(tries.console.storage_trouble("the disk is full"));
    Bench gives_up("qy  ");
    gives_up.stop.latch(source);
    CHECK_FALSE(gives_up.console.storage_trouble("the disk is full"));
    CHECK(gives_up.console.paused("key").kind == Request::stopped);  // the stop is still to be seen to
  }
}

TEST_CASE("The stop is among the keys of what is to be read first, and does not take it for read") {
  Bench bench("x ");
  std::string keys;
  bench.display.hints = [&](const Scene& scene) {
    for (const KeyHint& hint : scene.keys) keys += hint.key + " ";
  };
  bench.console.announce("The loop is not real-time.", true);
  CHECK(keys == "space x ");
  CHECK(bench.display.told == std::vector<std::string>{"scene Please note", "explain STOP: the devices give nothing"});
}

TEST_CASE("While the rest of the time between trials passes, its keys and a countdown are shown") {
  Bench bench(" ");
  CHECK(bench.console.ready(TrialOutline()).kind == Request::go_on);
  CHECK(bench.console.waiting(118, 118));
  CHECK(bench.display.keys == "xpnq?");
  CHECK(bench.display.counting);
}

TEST_CASE("A countdown is over where another page comes") {
  const std::vector<std::function<void(SessionConsole&)>> pages = {
      [](SessionConsole& console) { (void)console.recover("key"); },
      [](SessionConsole& console) { (void)console.instruct(Instruction()); },
      [](SessionConsole& console) { (void)console.storage_trouble("the disk is full"); }};
  for (const auto& page : pages) {
    Bench bench;
    CHECK(bench.console.exploring(10));
    CHECK(bench.display.counting);
    bench.interrupted.end = true;
    page(bench.console);
    CHECK_FALSE(bench.display.counting);
  }
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

TEST_CASE("A y and Enter that are held down confirm one question of a page") {
  Question first;
  first.id = "first";
  first.kind = Question::Kind::confirm;
  Question second = first;
  second.id = "second";
  Bench bench;
  bench.display.shown = [&](const QuestionnairePage& page) {
    if (page.at() == 0 && page.editor().empty()) bench.input->press("yy\r");
    if (page.at() == 1) bench.input->press("\r");
  };
  bench.display.explained = [&] { bench.interrupted.end = true; };
  CHECK_FALSE(bench.console.responder().reply_all({{first, -1}, {second, -1}}));
  CHECK(bench.display.told ==
        std::vector<std::string>{"explain Enter was down already: let go of it, then press it again"});
}

TEST_CASE("A stop is on the screen before anything else is done about it, and goes when it is cleared") {
  Bench bench;
  const StopOnKey stopping(&bench.keyboard, bench.stop);
  bench.ask();
  bench.display.on_scene = [&] { bench.input->press("x"); };
  CHECK_FALSE(bench.judge(30));
  CHECK(bench.display.stops == std::vector<std::string>{"key"});
  bench.display.on_scene = [&] { bench.input->press("c"); };
  bench.display.typing = [&] { bench.input->press("\r"); };
  CHECK(bench.console.recover("key").kind == Request::go_on);
  CHECK(bench.display.stops == std::vector<std::string>{"key", "cleared"});
}

TEST_CASE("During a presentation and in a gap a stop is shown at the next look") {
  for (const bool gap : {false, true}) {
    Bench bench("");
    bench.console.cue(CuePlace::first, CueSignal());
    bench.stop.latch(StopSource::button);
    const DeviceHealth at_work{.presenting = true};
    if (gap)
      bench.console.gap(0.5, 1);
    else
      bench.console.health(at_work);
    CHECK(bench.display.stops == std::vector<std::string>{"button"});
  }
  Bench pauses("");
  pauses.stop.latch(StopSource::signal);  // Ctrl-C: a pause, and no stop
  pauses.console.gap(0.5, 1);
  CHECK(pauses.display.stops.empty());
}

TEST_CASE("A repetition that is asked for in a gap ends it at once, what comes later does not") {
  for (const std::string key : {"r", "p"}) {
    Bench bench;
    bench.console.cue(CuePlace::first, CueSignal());
    bench.input->press(key);
    bool goes_on = true;
    CHECK(wait_until([&] {
      goes_on = bench.console.gap(0.5, 1);
      return !goes_on || bench.display.told.size() >= 2;
    }));
    CHECK(goes_on == (key == "p"));
    CHECK(bench.display.told.back() ==
          (key == "p" ? "queued pause after this trial" : "queued repeat this trial after this interval"));
  }
}

TEST_CASE("An interval is counted down from its first contact, in the protocol's time") {
  Bench bench("");
  bench.protocol.timeline.explore_s = 3;
  bench.protocol.timeline.no_contact_time_out_s = 10;
  bench.protocol.timeline.interval_end = IntervalEnd::time;
  bench.console.cue(CuePlace::second, CueSignal());
  DeviceHealth at_work{.presenting = true, .elapsed_s = 2};
  bench.console.health(at_work);
  CHECK(bench.display.phases.back().word == "SECOND");
  CHECK(bench.display.phases.back().left_s == 8);
  CHECK(bench.display.phases.back().more == "for the first contact");
  at_work.contact = true;
  at_work.elapsed_s = 2.5;
  bench.console.health(at_work);
  at_work.elapsed_s = 3;
  bench.console.health(at_work);
  at_work.contact = false;  // lifted again
  at_work.elapsed_s = 4;
  bench.console.health(at_work);
  CHECK(bench.display.phases.back().left_s == 1.5);
  CHECK(bench.display.phases.back().total_s == 3);
}

TEST_CASE("Voids are counted, and trials without contact in a row") {
  Bench bench("");
  bench.console.voided(TrialOutline(), "no_contact", true);
  bench.console.voided(TrialOutline(), "no_contact", true);
  CHECK(bench.display.counted.voids == 2);
  CHECK(bench.display.counted.no_contact == 2);
  bench.console.saved(TrialOutline(), {.said = kClassSame});
  CHECK(bench.display.counted.voids == 2);
  CHECK(bench.display.counted.no_contact == 0);
}

TEST_CASE("The bell rings where the operator is to look up, unless it is turned off") {
  for (const bool alerts : {true, false}) {
    auto* const made = new KeptDisplay;
    const Input input("");
    const Protocol protocol;
    Keyboard keyboard;
    ElapsingClock clock;
    const Interrupts interrupted;
    SessionConsole console(ConsoleOptions{.alerts = alerts}, protocol, &keyboard, clock, interrupted,
                           std::unique_ptr<Display>(made));
    console.cue(CuePlace::first, CueSignal());
    CHECK(made->alerts == 0);
    console.cue(CuePlace::question, CueSignal());
    console.health({.fault = "device_lost"});
    Break pause;
    pause.duration_s = 1;
    console.break_begins(pause, false);
    clock.step_ns = 400'000'000;
    (void)console.break_over(pause);
    CHECK(made->alerts == (alerts ? 3 : 0));
  }
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
  const OperatorRequest request = bench.console.missing("device RRS3-0001 is not there", [&] { return ++asked == 4; });
  CHECK(request.kind == Request::go_on);
  CHECK(asked == 4);
  CHECK(bench.display.told == std::vector<std::string>{"scene Something is missing."});
}

TEST_CASE("While something is missing the space bar does not go on, and the session can be left") {
  Bench bench(" qqlunch\n");
  const OperatorRequest request = bench.console.missing("device RRS3-0001 is not there", [] { return false; });
  CHECK(request.kind == Request::end_for_now);
  CHECK(request.text == "lunch");
}

}  // namespace
}  // namespace jnd
