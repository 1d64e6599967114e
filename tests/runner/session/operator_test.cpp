// What the operator asks for in a session: pauses, repeats, answers taken back, notes, blocks given up, breaks, ends.
// Each is in the log with its reason, and a replay agrees with the session.
#include <set>

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

}  // namespace
}  // namespace jnd
