// What the operator asks for in a session: pauses, repeats, answers taken back, notes, blocks given up, breaks, ends;
// and what an interruption leaves behind. Each is in the log with its reason, and a replay agrees with the session.
#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "data/storage_error.h"
#include "runner/session_engine.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"

namespace jnd {
namespace {

using nlohmann::json;
using test::Bench;
using test::small_protocol;

// An operator who follows a script: what to wish for before the n-th asking of ready(), from 1.
class Scripted final : public SessionView {
 public:
  OperatorWish ready(const TrialOutline& outline) override {
    outlines.push_back(outline);
    const auto found = before.find(static_cast<int>(outlines.size()));
    return found == before.end() ? OperatorWish{} : found->second;
  }
  OperatorWish meanwhile() override {
    const auto found = after_presentation.find(++presentations);
    return found == after_presentation.end() ? OperatorWish{} : found->second;
  }
  OperatorWish paused(const std::string& cause) override {
    pauses.push_back(cause);
    return in_pause;
  }
  bool storage_trouble(const std::string& message) override {
    troubles.push_back(message);
    return tries_again;
  }
  OperatorWish recover(const std::string&) override { return {Wish::go_on, "the strap had slipped"}; }
  void took_back(bool will_repeat) override { taken_back.push_back(will_repeat); }
  bool consent(const std::string&) override { return consents; }
  void progress(const std::vector<ConditionProgress>& conditions) override { last_progress = conditions; }

  std::map<int, OperatorWish> before, after_presentation;
  OperatorWish in_pause{Wish::go_on, {}};
  bool tries_again = true, consents = true;
  std::vector<TrialOutline> outlines;
  int presentations = 0;
  std::vector<std::string> pauses, troubles;
  std::vector<bool> taken_back;
  std::vector<ConditionProgress> last_progress;
};

Bench& with_person(Bench& bench) {
  bench.person = true;
  return bench;
}

std::vector<json> bodies(const Bench& bench, std::string_view kind) {
  std::vector<json> found;
  for (const Event& event : bench.log.events())
    if (event.kind == kind) found.push_back(json::parse(event.body));
  return found;
}

std::vector<int> order_of(const Bench& bench) {
  std::vector<int> order;
  for (const TrialRecord& record : bench.completed()) order.push_back(record.trial.index);
  return order;
}

TEST_CASE("A pause stands still until the operator goes on, and is logged with its reason and length") {
  Bench bench(small_protocol());
  Scripted person;
  person.before[3] = {Wish::pause, "the participant coughs"};
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
  person.before[2] = {Wish::note, "door slammed"};
  person.after_presentation[5] = {Wish::note, "device creaks"};
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
  person.after_presentation[3] = {Wish::repeat_trial, "she looked"};  // the second trial's first interval
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
  person.before[3] = {Wish::void_last, "mistyped"};
  person.before[4] = {Wish::void_last, "again"};  // only the last answer, not the one before
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
  person.before[5] = {Wish::void_last, "mistyped"};  // before the first trial of block 2
  REQUIRE(with_person(bench).run(person) == SessionEnd::completed);
  const std::vector<int> order = order_of(bench);
  CHECK(std::vector<int>(order.begin(), order.begin() + 5) == std::vector<int>{1, 2, 3, 4, 5});
  CHECK(bench.completed()[3].attempt == 2);
  CHECK(order.size() == 16);
}

TEST_CASE("A session ended at any point after answers were taken back goes on as an undisturbed one") {
  const auto script = [](Scripted& person, int shift) {
    for (const int place : {3, 8, 9})
      if (place > shift) person.before[place - shift] = {Wish::void_last, "mistyped"};
  };
  Bench undisturbed(small_protocol());
  Scripted one;
  script(one, 0);
  REQUIRE(with_person(undisturbed).run(one) == SessionEnd::completed);
  for (int k = 1; k <= 19; ++k) {
    Bench bench(small_protocol());
    Scripted first;
    script(first, 0);
    first.before[k] = {Wish::end_for_now, {}};
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
  person.before[7] = {Wish::end_block, "strap broken"};  // two trials of block 2 are done
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
  person.before[4] = {Wish::end_for_good, "withdrew"};
  REQUIRE(with_person(bench).run(person) == SessionEnd::closed_early);
  const std::vector<json> left = bodies(bench, event_kind::kLeft);
  REQUIRE(left.size() == 1);
  CHECK(left[0].at("reason") == "withdrew");
  CHECK(left[0].at("for_good") == true);
}

TEST_CASE("Ctrl-C in a presentation pauses: the stimulus that was felt comes again, without using up an attempt") {
  Bench bench(small_protocol());
  Scripted person;
  bench.rig.fault = [&](const PresentRequest& request) {
    if (request.id.trial != 2 || request.id.attempt != 1) return Fault::none;
    bench.interrupts.pause = true;  // as the signal's handler does
    bench.rig.stop.latch(StopSource::signal);
    return Fault::emergency_stop;
  };
  bench.rig.stopped_by = "signal";
  // The process's own latch is cleared by the pause; this one is the test's.
  class Clearing final : public SessionView {
   public:
    Clearing(Scripted& inner, Interrupts& interrupts) : inner_(inner), interrupts_(interrupts) {}
    OperatorWish paused(const std::string& cause) override {
      interrupts_.pause = false;
      return inner_.paused(cause);
    }

   private:
    Scripted& inner_;
    Interrupts& interrupts_;
  } view(person, bench.interrupts);
  REQUIRE(with_person(bench).run(view) == SessionEnd::completed);
  CHECK(person.pauses == std::vector<std::string>{"ctrl-c"});
  CHECK_FALSE(bench.rig.stop.latched());
  const SessionState state = replay(bench.log.events());
  CHECK(state.voided.empty());
  CHECK(state.completed.size() == 16);
  CHECK(bodies(bench, event_kind::kDeviceFault).empty());
  REQUIRE(bodies(bench, event_kind::kTrialVoided).size() == 1);
  CHECK(bodies(bench, event_kind::kTrialVoided)[0].at("reason") == "paused");
}

TEST_CASE("A stimulus that was felt before the program was killed is presented again, as a new attempt") {
  for (int killed_after = 1; killed_after < 40; ++killed_after) {
    Bench bench(small_protocol());
    with_person(bench);
    // Keeps so many events and then dies, as a program does that is killed.
    struct Killed {};
    class Dying final : public SessionLog {
     public:
      Dying(MemoryLog& kept, int left) : kept_(kept), left_(left) {}
      void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) override {
        if (left_-- == 0) throw Killed{};
        kept_.append(kind, body, stamp);
      }
      std::vector<Event> events() const override { return kept_.events(); }

     private:
      MemoryLog& kept_;
      int left_;
    } dying(bench.log, killed_after);
    Scripted person;
    const SessionParts parts = bench.parts_for(person, dying);
    bool killed = false;
    try {
      SessionEngine(parts).run(replay(dying.events()));
    } catch (const Killed&) {
      killed = true;
    }
    const std::optional<PendingTrial> felt = replay(bench.log.events()).pending;
    const std::size_t answered = bench.completed().size();
    REQUIRE(bench.run(person) == SessionEnd::completed);
    CHECK(bench.completed().size() == 16);
    if (!killed) break;
    const std::vector<json> voids = bodies(bench, event_kind::kTrialVoided);
    CHECK(voids.size() == (felt ? 1 : 0));
    CHECK(felt.has_value() == (killed_after % 2 == 1));  // a mark and an answer a trial
    if (!felt) continue;
    CHECK(felt->index == static_cast<int>(answered) + 1);
    CHECK(voids[0].at("reason") == "interrupted");
    for (const TrialRecord& record : bench.completed())
      CHECK(record.attempt == (record.trial.index == felt->index ? 2 : 1));
    CHECK(replay(bench.log.events()).voided.empty());
  }
}

TEST_CASE("Interruptions never use up a trial's attempts") {
  Bench bench(small_protocol());
  with_person(bench);
  for (int start = 0; start < 6; ++start) {
    bench.rig.fault = [&](const PresentRequest& request) {
      if (request.id.trial == 3) bench.stop = true;
      return bench.stop ? Fault::interrupted : Fault::none;
    };
    Scripted person;
    REQUIRE(bench.run(person) == SessionEnd::interrupted);
    bench.stop = false;
  }
  bench.rig.fault = [](const PresentRequest&) { return Fault::none; };
  Scripted person;
  REQUIRE(bench.run(person) == SessionEnd::completed);
  CHECK(bench.completed().size() == 16);
  CHECK(replay(bench.log.events()).abandoned.empty());
}

TEST_CASE("Where the protocol says so an interrupted block begins anew, in its planned order") {
  Bench bench(small_protocol());
  Scripted first;
  first.before[7] = {Wish::end_for_now, {}};  // two trials of block 2 are done
  REQUIRE(with_person(bench).run(first) == SessionEnd::interrupted);
  bench.steps.redo_block = true;
  Scripted second;
  REQUIRE(bench.run(second) == SessionEnd::completed);
  std::vector<int> expected(16);
  for (int i = 0; i < 16; ++i) expected[static_cast<std::size_t>(i)] = i + 1;
  CHECK(order_of(bench) == expected);
  CHECK(second.outlines.size() == 12);
  const std::vector<json> voids = bodies(bench, event_kind::kTrialVoided);
  REQUIRE(voids.size() == 2);
  CHECK(voids[0].at("reason") == "block_redone");
  CHECK(replay(bench.log.events()).voided.empty());
}

TEST_CASE("After a long gap the last practice round comes again, before the main part goes on") {
  const json practice = {{"practice", {{"trials", 4}, {"series", "1"}, {"criterion_correct", 0.5}, {"max_rounds", 2}}}};
  Bench bench(small_protocol(practice));
  bench.responder.rule = [](const TrialQuestion& q) {
    return std::optional(q.trial.same ? Judgement::same : Judgement::different);
  };
  Scripted first;
  first.before[8] = {Wish::end_for_now, {}};  // four of practice, three of the main part
  REQUIRE(with_person(bench).run(first) == SessionEnd::interrupted);
  bench.steps.practice_again = true;
  Scripted second;
  REQUIRE(bench.run(second) == SessionEnd::completed);
  REQUIRE(second.outlines.size() == 4 + 13);
  for (std::size_t i = 0; i < second.outlines.size(); ++i) CHECK(second.outlines[i].practice == (i < 4));
  CHECK(bodies(bench, event_kind::kPracticeEnded).size() == 2);
  CHECK(bench.completed().size() == 4 + 16);
}

TEST_CASE("A disk that is full for a while pauses the session; it goes on where it stood and loses nothing") {
  Bench undisturbed(small_protocol());
  Scripted quiet;
  with_person(undisturbed).run(quiet);
  const std::size_t events = undisturbed.log.events().size();
  for (std::size_t fail_at = 0; fail_at < events; ++fail_at) {
    Bench bench(small_protocol());
    with_person(bench);
    class FullForAWhile final : public SessionLog {
     public:
      FullForAWhile(MemoryLog& kept, std::size_t fail_at) : kept_(kept), fail_at_(fail_at) {}
      void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) override {
        if (kept_.events().size() == fail_at_ && failures_++ < 2) throw StorageTrouble("the disk is full");
        kept_.append(kind, body, stamp);
      }
      std::vector<Event> events() const override { return kept_.events(); }

     private:
      MemoryLog& kept_;
      std::size_t fail_at_;
      int failures_ = 0;
    } log(bench.log, fail_at);
    Scripted person;
    const SessionParts parts = bench.parts_for(person, log);
    REQUIRE(SessionEngine(parts).run(replay(log.events())) == SessionEnd::completed);
    CHECK(person.troubles.size() == 2);
    CHECK(order_of(bench) == order_of(undisturbed));

    // Where the operator gives up, the session ends as it is, and goes on later.
    Bench given_up(small_protocol());
    with_person(given_up);
    FullForAWhile other(given_up.log, fail_at);
    Scripted tired;
    tired.tries_again = false;
    const SessionParts other_parts = given_up.parts_for(tired, other);
    REQUIRE_THROWS_AS(SessionEngine(other_parts).run(replay(other.events())), StorageTrouble);
    Scripted later;
    REQUIRE(given_up.run(later) == SessionEnd::completed);
    CHECK(given_up.completed().size() == 16);
  }
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
  person.before[2] = {Wish::take_break, "tired"};
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

}  // namespace
}  // namespace jnd
