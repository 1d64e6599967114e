// Answers that are taken back: they stay in the log and count nowhere.
#include "data/log/replay.h"
#include "data/study/study_impl.h"
#include "data/verify/verify.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/data/pair_results.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

void take_back(SessionLog& log, const Trial& trial, int attempt, bool counts = true) {
  log.append(event_kind::kTrialVoided, voided_body(tutorial(), trial, attempt, "taken_back", counts), stamp_of(trial));
}

void answer(SessionLog& log, const Trial& trial, int attempt, int judgement) {
  TrialRecord record = record_of(tutorial(), trial, judgement);
  record.attempt = attempt;
  log.append(event_kind::kTrialCompleted, to_body(record), stamp_of(trial));
}

int wrong(const Trial& trial) {
  return usual_answer(trial) == kClassSame ? kClassDifferent : kClassSame;
}

TEST_CASE("a void of the answered attempt takes the answer back; attempts are counted apart from voids that count",
          "[data]") {
  MemoryLog log;
  const std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;
  log.append(event_kind::kTrialBegan, {{"index", 1}, {"attempt", 1}}, {1, 1});
  SessionState state = replay(log.events());
  REQUIRE(state.pending);
  CHECK(state.pending->index == 1);
  answer(log, trials[0], 1, kClassSame);
  answer(log, trials[1], 1, kClassSame);
  state = replay(log.events());
  CHECK_FALSE(state.pending);
  CHECK(state.completed.size() == 2);
  CHECK(state.attempts.at(1) == 1);
  take_back(log, trials[0], 1, false);
  log.append(event_kind::kTrialBegan, {{"index", 1}, {"attempt", 2}}, {1, 1});
  state = replay(log.events());
  REQUIRE(state.completed.size() == 1);
  CHECK(state.completed[0].trial.index == 2);
  CHECK(state.void_order == std::vector<int>{1});
  CHECK(state.voided.empty());
  CHECK(state.attempts.at(1) == 2);
  take_back(log, trials[0], 2);
  state = replay(log.events());
  CHECK_FALSE(state.pending);
  CHECK(state.voided.at(1) == 1);
  answer(log, trials[0], 3, kClassDifferent);
  state = replay(log.events());
  REQUIRE(state.completed.size() == 2);
  CHECK(state.completed[1].attempt == 3);
}

TEST_CASE("what the operator did is replayed: how it was left, blocks ended, practice again", "[data]") {
  MemoryLog log;
  log.append(event_kind::kSessionOpened, {{"boot_id", "one"}}, {1, 1});
  log.append(event_kind::kConsent, {{"language", "de"}, {"by", "participant"}}, {1, 1});
  log.append(event_kind::kChecklist, {{"question", "noise"}, {"text", "?"}, {"answer", "yes"}}, {1, 1});
  log.append(event_kind::kInstructed, {{"id", "hello"}, {"language", "de"}}, {1, 1});
  log.append(event_kind::kBlockEnded, {{"block", 0}, {"practice", true}, {"reason", "tired"}, {"trials", {5, 6}}},
             {1, 1});
  log.append(event_kind::kLeft, {{"cause", "operator"}}, {2, 2});
  SessionState state = replay(log.events());
  CHECK(state.boot_id == "one");
  CHECK(state.consented);
  CHECK(state.instructed == std::set<std::string>{"hello"});
  CHECK(state.abandoned == std::set<int>{5, 6});
  CHECK(state.practice_ended);
  CHECK(state.left);
  log.append(event_kind::kSessionResumed, {{"boot_id", "two"}, {"practice_again", true}}, {3, 3});
  state = replay(log.events());
  CHECK_FALSE(state.left);
  CHECK(state.boot_id == "two");
  CHECK_FALSE(state.practice_ended);
  log.append(event_kind::kExploration, {{"index", 1}, {"attempt", 1}}, {4, 4});
  log.append(event_kind::kExploration, {{"index", 2}, {"attempt", 1}}, {4, 4});
  log.append(event_kind::kExplorationVoided, {{"index", 2}, {"attempt", 1}}, {4, 4});
  log.append(event_kind::kConsent, {{"refused", true}}, {4, 4});
  state = replay(log.events());
  CHECK(state.explored == std::set<int>{1});
  CHECK_FALSE(state.consented);
}

TEST_CASE("a void says that it does not count, and only then", "[data]") {
  const Trial trial = make_plan(tutorial(), 1, kSeed).trials[0];
  CHECK_FALSE(voided_body(tutorial(), trial, 1, "no_answer").contains("counts"));
  CHECK(voided_body(trial, 1, "interrupted", false).at("counts") == false);
}

TEST_CASE("the file takes a second answer only after the first was taken back", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  const auto study = new_study(path);
  const auto log = study->open_session(new_session(1));
  const std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;
  const Trial& trial = trials[10];
  REQUIRE_FALSE(trial.practice);
  answer(*log, trial, 1, wrong(trial));
  CHECK_THROWS_WITH(answer(*log, trial, 2, usual_answer(trial)), Catch::Contains("completed already"));
  take_back(*log, trials[11], 1);  // of another trial
  CHECK_THROWS_WITH(answer(*log, trial, 2, usual_answer(trial)), Catch::Contains("completed already"));
  take_back(*log, trial, 1);
  CHECK(study->sessions()[0].trials_done == 0);
  answer(*log, trial, 2, usual_answer(trial));
  CHECK_THROWS_WITH(answer(*log, trial, 3, usual_answer(trial)), Catch::Contains("completed already"));
  take_back(*log, trial, 2);
  answer(*log, trial, 3, usual_answer(trial));
  const SessionInfo info = study->sessions()[0];
  CHECK(info.trials_done == 1);
  CHECK(info.trials_voided == 3);
  CHECK(verify(*study).problems == std::vector<Problem>{});
  CHECK(verify(*study).trials == 1);
  SQLite::Database& database = study->impl().database();
  CHECK(database.execAndGet("SELECT group_concat(attempt) FROM trials").getString() == "3");
  CHECK(database.execAndGet("SELECT group_concat(attempt) FROM (SELECT * FROM taken_back ORDER BY seq)").getString() ==
        "1,2");
  CHECK(database.execAndGet("SELECT reason FROM taken_back LIMIT 1").getString() == "taken_back");
  CHECK(database.execAndGet("SELECT trials_done FROM sessions").getInt() == 1);
  CHECK(database.execAndGet("SELECT sum(n_diff + n_same) FROM counts").getInt() == 1);
}

TEST_CASE("results are those of the answers that hold", "[data]") {
  const TemporaryFolder folder;
  const auto plain = new_study(folder / "plain.jnd");
  run_whole_session(*plain, tutorial(), 1);
  const auto study = new_study(folder / "study.jnd");
  {
    const auto log = study->open_session(new_session(1));
    for (const Trial& trial : make_plan(tutorial(), 1, kSeed).trials) {
      if (trial.index % 3 == 0) {
        answer(*log, trial, 1, wrong(trial));
        take_back(*log, trial, 1);
      }
      answer(*log, trial, trial.index % 3 == 0 ? 2 : 1, usual_answer(trial));
    }
    study->close_session("P01-simulated", {9, 9});
  }
  CHECK(verify(*study).problems == std::vector<Problem>{});
  const TaskResults with = estimates_in(*study, tutorial()), without = estimates_in(*plain, tutorial());
  REQUIRE(with.cells.size() == without.cells.size());
  for (std::size_t i = 0; i < with.cells.size(); ++i) {
    CHECK(with.cells[i].counts == without.cells[i].counts);
    CHECK(with.cells[i].missing == 0);
  }
  const auto closed = nlohmann::json::parse(study->events("P01-simulated").back().body);
  CHECK(closed.at("trials_completed") == 16);
}

TEST_CASE("what contradicts itself about begun, voided and given-up trials is found", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  const std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;
  log->mark(event_kind::kTrialBegan, {{"index", 1}, {"attempt", 1}}, {1, 1});
  answer(*log, trials[0], 1, usual_answer(trials[0]));
  CHECK(verify(*study).problems == std::vector<Problem>{});
  log->mark(event_kind::kTrialBegan, {{"index", 1}, {"attempt", 2}}, {1, 1});
  log->mark(event_kind::kTrialBegan, {{"index", 2}, {"attempt", 1}}, {1, 1});
  answer(*log, trials[2], 1, usual_answer(trials[2]));
  take_back(*log, trials[2], 4);
  log->append(event_kind::kBlockEnded, {{"block", 1}, {"practice", false}, {"reason", "late"}, {"trials", {20, 999}}},
              {1, 1});
  answer(*log, trials[19], 1, usual_answer(trials[19]));
  log->append(event_kind::kExploration, {{"index", 1}, {"attempt", 1}}, {1, 1});
  std::string all;
  for (const Problem& problem : verify(*study).problems) all += problem.text + "\n";
  CHECK_THAT(all, Catch::Contains("trial 1 began although it was answered"));
  CHECK_THAT(all, Catch::Contains("trial 2 began while trial 1"));
  CHECK_THAT(all, Catch::Contains("trial 3, attempt 1, was completed while trial 2, attempt 1, was presented"));
  CHECK_THAT(all, Catch::Contains("trial 3: attempt 4 is voided, but attempt 1 was answered"));
  CHECK_THAT(all, Catch::Contains("trial 999 is not in the plan"));
  CHECK_THAT(all, Catch::Contains("free interaction 1 is not in the plan"));
  const bool same_block = trials[19].block == 1;
  CHECK_THAT(all, Catch::Contains(same_block ? "trial 20 was completed after its block had been ended"
                                             : "trial 20 is given up with block 1"));
}

}  // namespace
}  // namespace jnd
