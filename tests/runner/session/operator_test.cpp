// The operator in a session: what can be asked for, and what is told of cues and time.
#include <array>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "protocols/course/duration.h"
#include "runner/console/session_summary.h"
#include "runner/session/session_engine.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"
#include "tests/runner/session/scripted_operator.h"

namespace jnd {
namespace {

// What the operator asks for in a session: pauses, repeats, answers taken back, notes, blocks given up, breaks, ends.
// Each is in the log with its reason, and a replay agrees with the session.

using nlohmann::json;
using test::Bench;
using test::bodies;
using test::order_of;
using test::Scripted;
using test::small_protocol;
using test::with_person;

TEST_CASE("A pause stands still until the operator goes on, and is logged with its reason and length") {
  Bench bench(small_protocol());
  Scripted person;
  person.before[3] = {Request::pause, "the participant coughs"};
  REQUIRE(with_person(bench).run(person) == SessionEnd::completed);
  CHECK(person.pauses == std::vector<std::string>{"key"});
  REQUIRE(bodies(bench, event_kind::kPaused).size() == 1);
  CHECK(bodies(bench, event_kind::kPaused)[0].at("reason") == "the participant coughs");
  CHECK(bodies(bench, event_kind::kContinued).size() == 1);
  CHECK(bench.completed().size() == 16);
  CHECK(person.outlines.size() == 17);  // asked again after the pause
}

TEST_CASE("A note is an event of its own, whatever is going on") {
  Bench bench(small_protocol());
  Scripted person;
  person.before[2] = {Request::note, "door slammed"};
  person.after_presentation[5] = {Request::note, "device creaks"};
  REQUIRE(with_person(bench).run(person) == SessionEnd::completed);
  const std::vector<json> notes = bodies(bench, event_kind::kNote);
  REQUIRE(notes.size() == 2);
  CHECK(notes[0].at("text") == "door slammed");
  CHECK(notes[0].at("after_trial") == 1);
  CHECK(notes[1].at("text") == "device creaks");
  CHECK(bench.completed().size() == 16);
}

TEST_CASE("A trial that the operator repeats is voided with the reason, and comes again at the end of its block") {
  Bench bench(small_protocol());
  Scripted person;
  person.after_presentation[3] = {Request::repeat_trial, "she looked"};  // the second trial's first interval
  REQUIRE(with_person(bench).run(person) == SessionEnd::completed);
  const std::vector<json> voids = bodies(bench, event_kind::kTrialVoided);
  REQUIRE(voids.size() == 1);
  CHECK(voids[0].at("reason") == "repeated");
  CHECK(voids[0].at("words") == "she looked");
  CHECK(voids[0].at("index") == 2);
  const std::vector<int> order = order_of(bench);
  CHECK(std::vector<int>(order.begin(), order.begin() + 5) == std::vector<int>{1, 3, 4, 2, 5});
  CHECK(bench.completed()[3].attempt == 2);
}

TEST_CASE("The last answer can be taken back once: its trial comes again, and the answer stays in the log") {
  Bench bench(small_protocol());
  Scripted person;
  person.before[3] = {Request::void_last, "mistyped"};
  person.before[4] = {Request::void_last, "again"};  // only the last answer, not the one before
  REQUIRE(with_person(bench).run(person) == SessionEnd::completed);
  CHECK(person.taken_back == std::vector<bool>{true});
  const std::vector<int> order = order_of(bench);
  CHECK(std::vector<int>(order.begin(), order.begin() + 5) == std::vector<int>{1, 3, 4, 2, 5});
  CHECK(bodies(bench, event_kind::kTrialCompleted).size() == 17);
  const std::vector<json> voids = bodies(bench, event_kind::kTrialVoided);
  REQUIRE(voids.size() == 1);
  CHECK(voids[0].at("reason") == "taken_back");
  CHECK(voids[0].at("words") == "mistyped");
  CHECK(voids[0].at("attempt") == 1);
  CHECK(person.outlines[2].can_void_last);
  CHECK_FALSE(person.outlines[3].can_void_last);
  CHECK(bench.completed().size() == 16);
}

TEST_CASE("The last answer of a block can still be taken back in the next one") {
  Bench bench(small_protocol());
  Scripted person;
  person.before[5] = {Request::void_last, "mistyped"};  // before the first trial of block 2
  REQUIRE(with_person(bench).run(person) == SessionEnd::completed);
  const std::vector<int> order = order_of(bench);
  CHECK(std::vector<int>(order.begin(), order.begin() + 5) == std::vector<int>{1, 2, 3, 4, 5});
  CHECK(bench.completed()[3].attempt == 2);
  CHECK(order.size() == 16);
}

TEST_CASE("A session ended at any point after answers were taken back goes on as an undisturbed one") {
  const auto script = [](Scripted& person, int shift) {
    for (const int place : {3, 8, 9})
      if (place > shift) person.before[place - shift] = {Request::void_last, "mistyped"};
  };
  Bench undisturbed(small_protocol());
  Scripted one;
  script(one, 0);
  REQUIRE(with_person(undisturbed).run(one) == SessionEnd::completed);
  for (int k = 1; k <= 19; ++k) {
    Bench bench(small_protocol());
    Scripted first;
    script(first, 0);
    first.before[k] = {Request::end_for_now, {}};
    REQUIRE(with_person(bench).run(first) == SessionEnd::interrupted);
    Scripted second;
    script(second, k);
    REQUIRE(bench.run(second) == SessionEnd::completed);
    CHECK(bench.completed().size() == 16);
    std::set<int> trials;
    for (const int index : order_of(bench)) trials.insert(index);
    CHECK(trials.size() == 16);
  }
}

TEST_CASE("A block that is given up leaves its trials, in one event, and nothing of it comes again") {
  Bench bench(small_protocol());
  Scripted person;
  person.before[7] = {Request::end_block, "strap broken"};  // two trials of block 2 are done
  REQUIRE(with_person(bench).run(person) == SessionEnd::completed);
  const std::vector<json> ended = bodies(bench, event_kind::kBlockEnded);
  REQUIRE(ended.size() == 1);
  CHECK(ended[0].at("block") == 2);
  CHECK(ended[0].at("reason") == "strap broken");
  CHECK(ended[0].at("trials") == json::array({7, 8}));
  CHECK(bench.completed().size() == 14);
  CHECK(replay(bench.log.events()).abandoned == std::set<int>{7, 8});
  CHECK(bench.run() == SessionEnd::completed);
  CHECK(bench.completed().size() == 14);
}

TEST_CASE("A session that is ended for good says why, and is not the same as one that is left") {
  Bench bench(small_protocol());
  Scripted person;
  person.before[4] = {Request::end_for_good, "withdrew"};
  REQUIRE(with_person(bench).run(person) == SessionEnd::closed_early);
  const std::vector<json> left = bodies(bench, event_kind::kLeft);
  REQUIRE(left.size() == 1);
  CHECK(left[0].at("reason") == "withdrew");
  CHECK(left[0].at("for_good") == true);
}

TEST_CASE("Without consent there is no session") {
  Bench bench(small_protocol({{"consent", "I agree to take part."}}));
  Scripted person;
  person.consents = false;
  REQUIRE(with_person(bench).run(person) == SessionEnd::closed_early);
  CHECK(bench.completed().empty());
  REQUIRE(bodies(bench, event_kind::kConsent).size() == 1);
  CHECK(bodies(bench, event_kind::kConsent)[0].at("refused") == true);
}

TEST_CASE("A break on request is logged as one, and a break that was due at the same place is not taken twice") {
  Bench bench(small_protocol({{"breaks", {{{"after", "trials"}, {"trials", 4}, {"duration_s", 5}}}}}));
  Scripted person;
  person.before[2] = {Request::take_break, "tired"};
  REQUIRE(with_person(bench).run(person) == SessionEnd::completed);
  const std::vector<json> breaks = bodies(bench, event_kind::kBreakTaken);
  REQUIRE(breaks.size() == 4);  // after 1 on request; after 4, 8 and 12
  CHECK(breaks[0].at("on_request") == true);
  CHECK(breaks[0].at("reason") == "tired");
  CHECK_FALSE(breaks[1].contains("on_request"));
}

TEST_CASE("Progress is told by coded condition, and adds up") {
  Bench bench(small_protocol());
  Scripted person;
  with_person(bench).run(person);
  REQUIRE(person.last_progress.size() == 2);
  CHECK(person.last_progress[0].code == "A");
  for (const ConditionProgress& condition : person.last_progress) {
    CHECK(condition.done == 8);
    CHECK(condition.total == 8);
  }
}

// Cues to the participant: which come from the devices, and that they are the same whatever is presented.

Protocol with_taps() {
  return small_protocol(
      {{"trial",
        {{"cues", {{"first", {{"kind", "tap"}}}, {"second", {{"kind", "tap"}}}, {"question", {{"kind", "none"}}}}}}}});
}

TEST_CASE("A tap is presented by the devices before each interval, the same for every stimulus and condition") {
  Bench bench(with_taps());
  std::vector<PresentRequest> asked;
  bench.rig.fault = [&](const PresentRequest& request) {
    asked.push_back(request);
    return Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  REQUIRE(asked.size() == 16 * 4);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const bool tap = i % 2 == 0;
    CHECK((asked[i].tap_g > 0) == tap);
    if (!tap) continue;
    CHECK(asked[i].tap_g == asked[0].tap_g);
    CHECK(asked[i].explore_s == asked[0].explore_s);
    CHECK(asked[i].stimulus == Stimulus{});
    CHECK(asked[i].object.empty());
  }
}

TEST_CASE("A device that fails in a tap voids the attempt, and nothing is presented after it") {
  Bench bench(with_taps());
  int after_failure = 0;
  bench.rig.fault = [&](const PresentRequest& request) {
    const bool fails = request.id.trial == 2 && request.id.attempt == 1;
    if (fails && request.tap_g == 0) ++after_failure;
    return fails && request.tap_g > 0 ? Fault::device_lost : Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  CHECK(after_failure == 0);
  CHECK(replay(bench.log.events()).voided.at(2) == 1);
  CHECK(bench.completed().size() == 16);
}

// When what happened.
class TimedView final : public SessionView {
 public:
  explicit TimedView(Clock& clock) : clock_(clock) {}
  OperatorRequest ready(const TrialOutline&) override {
    ready_ns = clock_.now_ns();
    clock_.sleep_until_ns(ready_ns + 3'000'000'000);
    return {};
  }
  void cue(CuePlace place, const CueSignal&) override { cues_ns[static_cast<std::size_t>(place)] = clock_.now_ns(); }
  std::int64_t ready_ns = 0;
  std::array<std::int64_t, 4> cues_ns{};

 private:
  Clock& clock_;
};

TEST_CASE("A rig gets ready before READY and at the beginning of the gap, and the cue waits for it, whatever comes") {
  Bench bench(small_protocol());
  bench.person = true;
  TimedView view(bench.clock);
  constexpr std::int64_t kReady_ns = 800'000'000;  // longer than gap_s and between_trials_s
  std::optional<IntervalId> held;
  std::int64_t due_ns = 0, ended_ns = 0;
  int presented = 0;
  bench.rig.ready = [&](const PresentRequest& request) {
    if (held == request.id) return due_ns;  // it is ready, and stays so
    CHECK_FALSE(held);
    held = request.id;
    if (request.id.interval == 1) CHECK(bench.clock.now_ns() == ended_ns);
    due_ns = bench.clock.now_ns() + kReady_ns;
    return due_ns;
  };
  bench.rig.fault = [&](const PresentRequest& request) {
    const std::int64_t began_ns = bench.clock.now_ns() - 1'000'000'000;  // explore_s
    REQUIRE(held == request.id);
    held.reset();
    ++presented;
    if (request.id.interval == 0) {
      CHECK(view.ready_ns >= due_ns);
      CHECK(view.cues_ns[0] == began_ns);
    } else {
      CHECK(view.cues_ns[1] == due_ns);
      CHECK(began_ns == due_ns);
    }
    ended_ns = bench.clock.now_ns();
    return Fault::none;
  };
  REQUIRE(bench.run(view) == SessionEnd::completed);
  CHECK(presented == 16 * 2);
}

// When the session will be over, as the operator is told before each step: with its breaks and questions, and the same
// whatever the coming trials present.

class TimesLeft final : public SessionView {
 public:
  void time_left(double left_s) override { left.push_back(left_s); }
  std::vector<double> left;
};

Protocol protocol_of_study() {
  return test::small_protocol({{"breaks", {{{"after", "block"}, {"duration_s", 60}}}},
                               {"questions",
                                {{{"id", "ease"},
                                  {"when", "after-session"},
                                  {"kind", "rating"},
                                  {"text", "How easy was it?"},
                                  {"min", 1},
                                  {"max", 9},
                                  {"low", "hard"},
                                  {"high", "easy"}}}},
                               {"design", {{"order", {{"series", "permuted"}, {"conditions", "permuted"}}}}}});
}

std::vector<double> times_left(const Protocol& protocol, int participant) {
  test::Bench bench(protocol, participant);
  bench.person = true;
  TimesLeft view;
  CHECK(bench.run(view) == SessionEnd::completed);
  return view.left;
}

TEST_CASE("What is left of a session holds its trials, breaks and questions, and runs out with it") {
  const Protocol protocol = protocol_of_study();
  const std::vector<double> left = times_left(protocol, 1);
  REQUIRE(left.size() == 16 + 3 + 1);  // trials, breaks, a page of questions
  CHECK(left.front() == Approx(expected_duration_s(protocol)));
  CHECK(left.front() == Approx(16 * expected_trial_s(protocol) + 3 * 60 + 10));
  // At the participant's own pace: 2 x 1 s, a gap of 0.5 s, an answer after 1 s, 0.5 s between trials.
  // Four trials as the protocol has them stand beside those that were.
  const auto pace = [&](int trials) { return (trials * 4 + 4 * expected_trial_s(protocol)) / (trials + 4); };
  CHECK(left[1] == Approx(15 * pace(1) + 3 * 60 + 10));
  CHECK(left[4] == Approx(12 * pace(4) + 3 * 60 + 10));  // the break is due
  CHECK(left[5] == Approx(12 * pace(4) + 2 * 60 + 10));
  CHECK(left.back() == Approx(10));
}

TEST_CASE("What is left of a session does not depend on the conditions and stimuli that are to come") {
  const Protocol protocol = protocol_of_study();
  const std::vector<double> first = times_left(protocol, 1);
  for (const int participant : {2, 3, 4}) CHECK(times_left(protocol, participant) == first);
}

TEST_CASE("A round of practice that comes again is in what is left from its first trial on") {
  Protocol protocol = test::small_protocol(
      {{"practice", {{"trials", 4}, {"series", "1"}, {"criterion_correct", 1}, {"max_rounds", 2}}}});
  test::Bench bench(protocol);
  bench.person = true;
  bench.responder.rule = [](const TrialQuestion&) { return std::optional(kClassSame); };
  TimesLeft view;
  CHECK(bench.run(view) == SessionEnd::completed);
  REQUIRE(view.left.size() == 4 + 4 + 1 + 16);  // rounds, the end of practice, trials
  CHECK(view.left.front() == Approx(20 * expected_trial_s(protocol)));
  // At the pace of the first round, beside four trials as the protocol has them.
  CHECK(view.left[4] == Approx(20 * (4 * 4 + 4 * expected_trial_s(protocol)) / 8));
  CHECK(view.left[7] < view.left[4]);
}

TEST_CASE("The last words of a session say what was done, where it is and what comes next") {
  SessionSummary summary{
      .study = "my study.sqlite", .trials_done = 12, .trials_total = 16, .trials_voided = 3, .run_s = 61};
  CHECK(summary_text(summary) ==
        "  trials    12 of 16, 3 voided\n"
        "  this run  61 s\n"
        "  saved in  my study.sqlite\n"
        "  next      jnd status 'my study.sqlite'\n"
        "            jnd verify 'my study.sqlite'\n"
        "            jnd backup 'my study.sqlite' --to 'my study-copy.sqlite'");
  summary.slowest_presenting_ms = 12.4;
  summary.slowest_waiting_ms = 340.6;
  CHECK(summary_text(summary).find(
            "\n  rig       slowest answer 12 of 100 ms while it presented, 341 of 2000 ms while it waited\n") !=
        std::string::npos);
  summary.study = "Anna's.sqlite";
  CHECK(summary_text(summary).find("jnd verify 'Anna'\\''s.sqlite'\n") != std::string::npos);
  summary.resumable = true;
  CHECK(summary_text(summary).find("next      the same command goes on with it\n            jnd status") !=
        std::string::npos);
  summary.moved = true;
  CHECK(summary_text(summary).find("next      the same command with --study 'Anna'\\''s.sqlite' goes on with it\n") !=
        std::string::npos);
}

}  // namespace
}  // namespace jnd
