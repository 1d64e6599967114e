// The session engine: order, voids, attempts, practice, interruption and storage failure.
#include "runner/session/session_engine.h"

#include <algorithm>

#include "data/log/storage_error.h"
#include "protocols/condition_words.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"

namespace jnd {
namespace {

using test::Bench;
using test::small_protocol;

std::vector<int> indices(const std::vector<TrialRecord>& records) {
  std::vector<int> order;
  for (const TrialRecord& record : records) order.push_back(record.trial.index);
  return order;
}

TEST_CASE("A session runs every planned trial once, in the planned order") {
  Bench bench(small_protocol());
  REQUIRE(bench.run() == SessionEnd::completed);
  const std::vector<TrialRecord> records = bench.completed();
  REQUIRE(records.size() == bench.plan.trials.size());
  REQUIRE(records.size() == 16);
  for (std::size_t i = 0; i < records.size(); ++i) {
    CHECK(records[i].trial == bench.plan.trials[i]);
    CHECK(records[i].attempt == 1);
    const double asked = bench.plan.trials[i].stimuli[0];
    const FingerPresentation& felt = records[i].presentations[0].fingers[0];
    const bool force = bench.protocol.conditions[static_cast<std::size_t>(bench.plan.trials[i].condition)].cues.force;
    CHECK(felt.stiffness.has_value() == force);
    if (force) CHECK(*felt.stiffness == asked);
  }
  CHECK(bench.rig.neutral_calls > 0);
}

TEST_CASE("A session that is interrupted after any answer ends with the same trials as an undisturbed one") {
  Bench undisturbed(small_protocol());
  REQUIRE(undisturbed.run() == SessionEnd::completed);
  // The view presses "end" before the k-th trial.
  class EndBefore final : public SessionView {
   public:
    explicit EndBefore(int trials) : left_(trials) {}
    OperatorRequest ready(const TrialOutline&) override {
      return {left_-- > 0 ? Request::go_on : Request::end_for_now, {}};
    }

   private:
    int left_;
  };
  for (int k = 0; k < 16; ++k) {
    Bench bench(small_protocol());
    EndBefore view(k);
    REQUIRE(bench.run(view) == SessionEnd::interrupted);
    CHECK(bench.completed().size() == static_cast<std::size_t>(k));
    REQUIRE(bench.run() == SessionEnd::completed);
    const std::vector<TrialRecord> records = bench.completed();
    REQUIRE(indices(records) == indices(undisturbed.completed()));
    for (std::size_t i = 0; i < records.size(); ++i)
      CHECK(records[i].answer.said == undisturbed.completed()[i].answer.said);
  }
}

TEST_CASE("A stop in the middle of a presentation keeps no half trial") {
  Bench bench(small_protocol());
  bench.rig.fault = [&](const PresentRequest& request) {
    if (request.id.trial == 6 && request.id.interval == 1) bench.stop = true;
    return bench.stop ? Fault::emergency_stop : Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::interrupted);
  CHECK(bench.completed().size() == 5);
  CHECK(replay(bench.log.events()).voided.empty());
}

TEST_CASE("An answer that came together with a stop is kept") {
  Bench bench(small_protocol());
  bench.responder.rule = [&](const TrialQuestion& question) {
    if (question.trial.index == 4) bench.stop = true;
    return std::optional(kClassDifferent);
  };
  REQUIRE(bench.run() == SessionEnd::interrupted);
  CHECK(indices(bench.completed()) == std::vector<int>{1, 2, 3, 4});
}

TEST_CASE("A faulted trial comes again at the end of its own block, with the same stimuli") {
  Bench bench(small_protocol());
  bench.rig.fault = [](const PresentRequest& request) {
    return request.id.trial == 2 && request.id.attempt < 3 ? Fault::stale_pose : Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  // Blocks have four trials: 1 3 4 2, then 5 ...
  const std::vector<TrialRecord> records = bench.completed();
  REQUIRE(records.size() == 16);
  CHECK(std::vector<int>{records[0].trial.index, records[1].trial.index, records[2].trial.index,
                         records[3].trial.index} == std::vector<int>{1, 3, 4, 2});
  CHECK(records[4].trial.index == 5);
  CHECK(records[3].attempt == 3);
  CHECK(records[3].trial == bench.plan.trials[1]);
}

TEST_CASE("After the last attempt a trial is given up, and the log says so") {
  Bench bench(small_protocol());
  bench.rig.fault = [](const PresentRequest& request) {
    return request.id.trial == 5 ? Fault::device_lost : Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  CHECK(bench.completed().size() == 15);
  const SessionState state = replay(bench.log.events());
  CHECK(state.voided.at(5) == 3);
  CHECK(state.abandoned == std::set<int>{5});
}

TEST_CASE("Voids survive an interruption: the order of the block stays the same") {
  const auto fault = [](const PresentRequest& request) {
    return (request.id.trial == 1 || request.id.trial == 3) && request.id.attempt == 1 ? Fault::non_finite
                                                                                       : Fault::none;
  };
  Bench undisturbed(small_protocol());
  undisturbed.rig.fault = fault;
  undisturbed.run();
  for (int stop_at = 1; stop_at <= 4; ++stop_at) {
    Bench bench(small_protocol());
    bench.rig.fault = [&](const PresentRequest& request) {
      if (request.id.trial == stop_at && request.id.interval == 0 && !bench.stop) bench.stop = true;
      return fault(request);
    };
    REQUIRE(bench.run() == SessionEnd::interrupted);
    bench.stop = false;
    bench.rig.fault = fault;
    REQUIRE(bench.run() == SessionEnd::completed);
    CHECK(indices(bench.completed()) == indices(undisturbed.completed()));
  }
}

TEST_CASE("No answer in time voids the trial") {
  Bench bench(small_protocol());
  bench.responder.rule = [](const TrialQuestion& question) -> std::optional<int> {
    if (question.trial.index == 4 && question.attempt == 1) return std::nullopt;
    return kClassSame;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  CHECK(bench.completed().size() == 16);
  CHECK(replay(bench.log.events()).voided.at(4) == 1);
}

TEST_CASE("Saturation is data by default, and repeats a trial where the protocol says so") {
  const auto saturate = [](const PresentRequest& request) {
    return request.id.trial == 2 && request.id.attempt == 1 ? 0.3 : 0.0;
  };
  Bench flagged(small_protocol());
  flagged.rig.saturated_share = saturate;
  flagged.run();
  CHECK(replay(flagged.log.events()).voided.empty());
  CHECK(flagged.completed()[1].presentations[0].fingers[0].saturated_share == 0.3);

  Bench repeated(small_protocol({{"stimulus", {{"on_saturation", "repeat"}}}}));
  repeated.rig.saturated_share = saturate;
  repeated.run();
  CHECK(replay(repeated.log.events()).voided.at(2) == 1);
  CHECK(repeated.completed().size() == 16);
}

TEST_CASE("A trial outside what was prescribed is marked, or comes again where the protocol says so") {
  const auto prescribing = [](const char* on_breach) {
    return small_protocol(
        {{"trial",
          {{"prescription", {{"limits", {{{"measure", "contacts"}, {"high", 2}}}}, {"on_breach", on_breach}}}}}});
  };
  const auto presses = [](const PresentRequest& request) {
    return request.id.trial == 2 && request.id.attempt == 1 && request.id.interval == 1 ? 3 : 1;
  };
  class Told final : public SessionView {
   public:
    void off_prescription(const TrialOutline& outline) override { told.push_back(outline.plan_number); }
    std::vector<int> told;
  };
  Bench flagged(prescribing("flag"));
  flagged.rig.contacts = presses;
  Told view;
  flagged.run(view);
  CHECK(replay(flagged.log.events()).voided.empty());
  CHECK(flagged.completed()[1].breach == "second interval: contacts 3, above 2");
  CHECK(flagged.completed()[0].breach.empty());
  CHECK(view.told == std::vector<int>{2});

  Bench repeated(prescribing("repeat"));
  repeated.rig.contacts = presses;
  Told nobody;
  repeated.run(nobody);
  CHECK(replay(repeated.log.events()).voided.at(2) == 1);
  CHECK(repeated.completed().size() == 16);
  CHECK(nobody.told.empty());
  for (const TrialRecord& record : repeated.completed()) CHECK(record.breach.empty());
}

TEST_CASE("Nobody is told that an answer is saved before it is") {
  class Watcher final : public SessionView {
   public:
    explicit Watcher(const MemoryLog& log) : log_(log) {}
    void saved(const TrialOutline&, const Answer&) override {
      ++told;
      CHECK(log_.events().back().kind == event_kind::kTrialCompleted);
      CHECK(replay(log_.events()).completed.size() == static_cast<std::size_t>(told));
    }
    int told = 0;

   private:
    const MemoryLog& log_;
  };
  Bench bench(small_protocol());
  Watcher watcher(bench.log);
  bench.run(watcher);
  CHECK(watcher.told == 16);
}

TEST_CASE("A log that fails stops the session; the unsaved answer is asked again") {
  // Fails at each append in turn, once.
  for (int fail_at = 0; fail_at < 16; ++fail_at) {
    Bench bench(small_protocol());
    class FailingLog final : public SessionLog {
     public:
      FailingLog(MemoryLog& kept, int fail_at) : kept_(kept), left_(fail_at) {}
      void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) override {
        if (left_-- == 0) throw StorageError("the disk is full");
        kept_.append(kind, body, stamp);
      }
      std::vector<Event> events() const override { return kept_.events(); }

     private:
      MemoryLog& kept_;
      int left_;
    } failing(bench.log, fail_at);
    SessionView quiet;
    const SessionParts parts = bench.parts_for(quiet, failing);
    SessionEngine engine(parts);
    REQUIRE_THROWS_AS(engine.run(replay(failing.events())), StorageError);
    REQUIRE(bench.run() == SessionEnd::completed);
    CHECK(bench.completed().size() == 16);
  }
}

TEST_CASE("Practice goes on until the criterion, and its trials are marked") {
  const nlohmann::json practice = {
      {"practice", {{"trials", 4}, {"series", "1"}, {"criterion_correct", 0.75}, {"max_rounds", 3}}}};
  SECTION("passed in the first round") {
    Bench bench(small_protocol(practice));
    bench.responder.rule = [](const TrialQuestion& q) {
      return std::optional((q.trial.target == kClassSame) ? kClassSame : kClassDifferent);
    };
    bench.run();
    const std::vector<TrialRecord> records = bench.completed();
    CHECK(records.size() == 4 + 16);
    CHECK(std::count_if(records.begin(), records.end(), [](const TrialRecord& r) { return r.trial.practice; }) == 4);
  }
  SECTION("never passed: three rounds, then the main part") {
    Bench bench(small_protocol(practice));
    bench.responder.rule = [](const TrialQuestion& q) {
      return std::optional((q.trial.target == kClassSame) ? kClassDifferent : kClassSame);
    };
    bench.run();
    CHECK(bench.completed().size() == 12 + 16);
    const std::vector<std::string> kinds = bench.kinds();
    CHECK(std::count(kinds.begin(), kinds.end(), std::string(event_kind::kPracticeEnded)) == 1);
  }
}

TEST_CASE("Questions and breaks come at their places, once, also after an interruption") {
  const nlohmann::json extras = {
      {"questions",
       {{{"id", "age"}, {"when", "before-session"}, {"kind", "number"}, {"text", "Age?"}, {"min", 18}, {"max", 99}},
        {{"id", "effort"},
         {"when", "after-condition"},
         {"kind", "rating"},
         {"text", "Effort?"},
         {"min", 1},
         {"max", 9},
         {"low", "none"},
         {"high", "much"}},
        {{"id", "tired"},
         {"when", "after-series"},
         {"kind", "rating"},
         {"text", "Tired?"},
         {"min", 1},
         {"max", 9},
         {"low", "no"},
         {"high", "very"}},
        {{"id", "useful"},
         {"when", "after-session"},
         {"kind", "rating"},
         {"text", "Useful?"},
         {"min", 1},
         {"max", 9},
         {"low", "no"},
         {"high", "very"},
         {"per_condition", true}}}},
      {"breaks", {{{"after", "series"}, {"duration_s", 30}}}}};
  const std::vector<std::string> expected = {"age/-1",   "effort/0", "effort/1", "tired/-1", "effort/0",
                                             "effort/1", "tired/-1", "useful/0", "useful/1"};
  Bench bench(small_protocol(extras));
  bench.run();
  CHECK(bench.responder.asked == expected);
  const std::vector<std::string> kinds = bench.kinds();
  CHECK(std::count(kinds.begin(), kinds.end(), std::string(event_kind::kBreakTaken)) ==
        1);  // not after the last series
  // Once more with everything in the log: nothing is asked again.
  bench.responder.asked.clear();
  CHECK(bench.run() == SessionEnd::completed);
  CHECK(bench.responder.asked.empty());
}

TEST_CASE("Condition codes are a permutation of letters that depends on the study's seed only") {
  const Protocol protocol = small_protocol();
  std::set<std::vector<std::string>> seen;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    std::vector<std::string> codes = condition_codes(protocol, seed);
    seen.insert(codes);
    CHECK(codes == condition_codes(protocol, seed));
    std::sort(codes.begin(), codes.end());
    CHECK(codes == std::vector<std::string>{"A", "B"});
  }
  CHECK(seen.size() == 2);
}

}  // namespace
}  // namespace jnd
