// What interruptions leave behind: Ctrl-C, a killed program, a long gap, a disk that is full for a while.
#include <optional>

#include "data/log/storage_error.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/runner/session/scripted_operator.h"

namespace jnd {
namespace {

using nlohmann::json;
using test::Bench;
using test::bodies;
using test::order_of;
using test::Scripted;
using test::small_protocol;
using test::with_person;

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
    OperatorRequest paused(const std::string& cause) override {
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

TEST_CASE("Ctrl-C before a trial is one pause, and leaves no stop behind it") {
  Bench bench(small_protocol());
  class Pressing final : public SessionView {
   public:
    explicit Pressing(Bench& bench) : bench_(bench) {}
    OperatorRequest ready(const TrialOutline&) override {
      if (++asked != 3) return {};
      bench_.interrupts.pause = true;  // as the signal's handler does
      bench_.rig.stop.latch(StopSource::signal);
      return {Request::pause, {}};
    }
    OperatorRequest paused(const std::string& cause) override {
      causes.push_back(cause);
      bench_.interrupts.pause = false;
      return {};
    }
    int asked = 0;
    std::vector<std::string> causes;

   private:
    Bench& bench_;
  } view(bench);
  REQUIRE(with_person(bench).run(view) == SessionEnd::completed);
  CHECK(view.causes == std::vector<std::string>{"ctrl-c"});
  CHECK_FALSE(bench.rig.stop.latched());
  CHECK(bodies(bench, event_kind::kStopCleared).empty());
  CHECK(bodies(bench, event_kind::kTrialVoided).empty());
  CHECK(bench.completed().size() == 16);
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
  first.before[7] = {Request::end_for_now, {}};  // two trials of block 2 are done
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
    return std::optional((q.trial.target == kClassSame) ? kClassSame : kClassDifferent);
  };
  Scripted first;
  first.before[8] = {Request::end_for_now, {}};  // four of practice, three of the main part
  REQUIRE(with_person(bench).run(first) == SessionEnd::interrupted);
  bench.steps.practice_again = true;
  Scripted second;
  REQUIRE(bench.run(second) == SessionEnd::completed);
  REQUIRE(second.outlines.size() == 4 + 13);
  for (std::size_t i = 0; i < second.outlines.size(); ++i) CHECK(second.outlines[i].practice == (i < 4));
  CHECK(bodies(bench, event_kind::kPracticeEnded).size() == 2);
  CHECK(bench.completed().size() == 4 + 16);
}

TEST_CASE("The stop key outlives a Ctrl-C before it: a person clears it, and the log says so") {
  Bench bench(small_protocol());
  class Pressing final : public SessionView {
   public:
    explicit Pressing(Bench& bench) : bench_(bench) {}
    void voided(const TrialOutline&, const std::string&, bool) override { bench_.rig.stop.latch(StopSource::key); }
    OperatorRequest paused(const std::string&) override {
      bench_.interrupts.pause = false;
      return {};
    }
    OperatorRequest recover(const std::string& stopped_by) override {
      recovered.push_back(stopped_by);
      return {Request::go_on, "looked at it"};
    }
    std::vector<std::string> recovered;

   private:
    Bench& bench_;
  } view(bench);
  bench.rig.fault = [&](const PresentRequest& request) {
    if (request.id.trial != 2 || request.id.attempt != 1) return Fault::none;
    bench.interrupts.pause = true;  // Ctrl-C; the key comes right after it, while the trial is voided
    bench.rig.stop.latch(StopSource::signal);
    return Fault::emergency_stop;
  };
  bench.rig.stopped_by = "signal";
  REQUIRE(with_person(bench).run(view) == SessionEnd::completed);
  CHECK(view.recovered == std::vector<std::string>{"key"});
  CHECK(bodies(bench, event_kind::kStopCleared).size() == 1);
  CHECK(bench.completed().size() == 16);
}

TEST_CASE("Ctrl-C in a pause that a key began leaves no stop behind it") {
  Bench bench(small_protocol());
  class Pressing final : public SessionView {
   public:
    explicit Pressing(Bench& bench) : bench_(bench) {}
    OperatorRequest ready(const TrialOutline&) override {
      return ++asked_ == 3 ? OperatorRequest{Request::pause, {}} : OperatorRequest{};
    }
    OperatorRequest paused(const std::string&) override {
      bench_.rig.stop.latch(StopSource::signal);
      return {};
    }
    OperatorRequest recover(const std::string& stopped_by) override {
      recovered.push_back(stopped_by);
      return {};
    }
    std::vector<std::string> recovered;

   private:
    Bench& bench_;
    int asked_ = 0;
  } view(bench);
  REQUIRE(with_person(bench).run(view) == SessionEnd::completed);
  CHECK(view.recovered.empty());
  CHECK_FALSE(bench.rig.stop.latched());
}

TEST_CASE("The operator's end from the checklist is kept with its words, and closes the session where it is for good") {
  const json checklist = {{"checklist", {{{"id", "mask"}, {"text", "Masking noise on"}, {"kind", "confirm"}}}}};
  for (const Request request : {Request::end_for_now, Request::end_for_good}) {
    Bench bench(small_protocol(checklist));
    class Leaving final : public Responder {
     public:
      std::optional<Answer> judge(const TrialQuestion&) override { return std::nullopt; }
      std::optional<std::string> reply(const Question&, int) override { return std::nullopt; }
      std::optional<Replies> reply_all(const std::vector<AskedQuestion>&) override { return std::nullopt; }
    } leaving;
    Scripted view;
    view.after_presentation[1] = {request, "feels ill"};
    const SessionParts parts{bench.protocol,   bench.plan,           bench.rig, leaving, bench.log, bench.clock, view,
                             bench.interrupts, RecordPolicy::events, true};
    const bool for_good = request == Request::end_for_good;
    CHECK(SessionEngine(parts).run({}) == (for_good ? SessionEnd::closed_early : SessionEnd::interrupted));
    const std::vector<json> left = bodies(bench, event_kind::kLeft);
    REQUIRE(left.size() == 1);
    CHECK(left[0].at("reason") == "feels ill");
    CHECK(left[0].at("for_good") == for_good);
    // Killed before it could be closed: it is not begun again.
    Scripted next;
    CHECK((with_person(bench).run(next) == SessionEnd::closed_early) == for_good);
    CHECK(next.outlines.empty() == for_good);
  }
}

TEST_CASE("An answer is taken back once, also with an interruption in between") {
  Bench bench(small_protocol());
  Scripted first;
  first.before[4] = {Request::void_last, "a slip"};
  first.before[5] = {Request::end_for_now, {}};
  REQUIRE(with_person(bench).run(first) == SessionEnd::interrupted);
  Scripted second;
  REQUIRE(bench.run(second) == SessionEnd::completed);
  REQUIRE(second.outlines.size() == 14);
  CHECK_FALSE(second.outlines[0].can_void_last);
  CHECK(second.outlines[1].can_void_last);
}

TEST_CASE("Practice that a resume asked for is due until some of it was answered, however often it is interrupted") {
  const json practice = {{"practice", {{"trials", 4}, {"series", "1"}, {"criterion_correct", 0.5}, {"max_rounds", 2}}}};
  Bench bench(small_protocol(practice));
  bench.responder.rule = [](const TrialQuestion& q) {
    return std::optional((q.trial.target == kClassSame) ? kClassSame : kClassDifferent);
  };
  Scripted first;
  first.before[8] = {Request::end_for_now, {}};
  REQUIRE(with_person(bench).run(first) == SessionEnd::interrupted);
  // Killed when the resume was logged, and again right after the answers were taken back.
  bench.log.append(event_kind::kSessionResumed, {{"practice_again", true}}, {1, 1});
  Scripted second;
  second.before[1] = {Request::end_for_now, {}};
  REQUIRE(bench.run(second) == SessionEnd::interrupted);
  CHECK(bodies(bench, event_kind::kTrialVoided).size() == 4);
  bench.log.append(event_kind::kSessionResumed, {{"practice_again", true}}, {2, 2});
  Scripted third;
  REQUIRE(bench.run(third) == SessionEnd::completed);
  CHECK(bodies(bench, event_kind::kTrialVoided).size() == 4);
  REQUIRE(third.outlines.size() == 4 + 13);
  for (std::size_t i = 0; i < third.outlines.size(); ++i) CHECK(third.outlines[i].practice == (i < 4));
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

}  // namespace
}  // namespace jnd
