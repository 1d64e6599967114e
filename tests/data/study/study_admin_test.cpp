// Looking after a study: who is left out, notes, several sessions of a participant, and what results make of it.
#include "data/study/study_admin.h"

#include "data/export/export.h"
#include "data/results/study_results.h"
#include "data/study/study_impl.h"
#include "data/verify/verify.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

void run_session(Study& study, int participant, int number, SessionKind kind = SessionKind::simulated) {
  NewSession session = new_session(participant, kind);
  session.id += "-" + std::to_string(number);
  session.number = number;
  session.language = "de";
  const auto log = study.open_session(session);
  for (const Trial& trial : make_plan(tutorial(), participant, kSeed, number).trials)
    log->append(event_kind::kTrialCompleted, to_body(record_of(tutorial(), trial, usual_answer(trial))),
                stamp_of(trial));
  study.close_session(session.id, kNow);
}

std::string problems_of(const Study& study) {
  std::string all;
  for (const Problem& problem : verify(study).problems) all += problem.text + "\n";
  return all;
}

TEST_CASE("a participant is excluded with a reason, once, and only one that there is", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  run_whole_session(*study, tutorial(), 1);
  run_whole_session(*study, tutorial(), 2);
  CHECK_THROWS_WITH(exclude_participant(*study, "P07", SessionKind::simulated, "asleep", false, kNow),
                    Catch::Contains("nobody of code P07"));
  CHECK_THROWS_WITH(exclude_participant(*study, "P01", SessionKind::real, "asleep", false, kNow),
                    Catch::Contains("nobody of code P01"));
  CHECK_THROWS_WITH(exclude_participant(*study, "P01", SessionKind::simulated, "  ", false, kNow),
                    Catch::Contains("reason"));
  exclude_participant(*study, "P01", SessionKind::simulated, "asleep", false, kNow);
  CHECK_THROWS_WITH(exclude_participant(*study, "P01", SessionKind::simulated, "again", false, kNow),
                    Catch::Contains("excluded already") && Catch::Contains("asleep"));
  const std::vector<SessionInfo> sessions = study->sessions();
  CHECK(sessions[0].excluded);
  CHECK_FALSE(sessions[0].replaced);
  CHECK_FALSE(sessions[1].excluded);
  CHECK(next_participant_number(sessions, SessionKind::simulated) == 3);
  CHECK(next_participant_number(sessions, SessionKind::real) == 1);
  CHECK(problems_of(*study).empty());
  NewSession again = new_session(1);
  again.id = "again";
  again.number = 2;
  CHECK_THROWS_WITH(study->open_session(again), Catch::Contains("was excluded"));
}

TEST_CASE("the number of a replaced participant is free for somebody else", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  {
    const auto study = new_study(path);
    run_whole_session(*study, tutorial(), 1, SessionKind::real);
    run_whole_session(*study, tutorial(), 2, SessionKind::real);
    NewSession taken = new_session(1, SessionKind::real);
    taken.id = "x";
    taken.participant = "Q";
    CHECK_THROWS_WITH(study->open_session(taken), Catch::Contains("number 1"));
    exclude_participant(*study, "P01", SessionKind::real, "left early", true, kNow);
    CHECK(next_participant_number(study->sessions(), SessionKind::real) == 1);
  }
  const auto study = Study::open(path, Study::Access::read_write);
  NewSession other = new_session(1, SessionKind::real);
  other.id = "x";
  other.participant = "Q";
  study->open_session(other);
  CHECK(next_participant_number(study->sessions(), SessionKind::real) == 3);
  CHECK(problems_of(*study).empty());
}

TEST_CASE("notes and unblinding are events of the study", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  const auto study = new_study(path);
  run_whole_session(*study, tutorial(), 1);
  add_note(*study, "new gloves", kNow);
  add_note(*study, "left-handed after all", kNow, "P01");
  CHECK_THROWS_WITH(add_note(*study, "?", kNow, "P09"), Catch::Contains("nobody of code P09"));
  CHECK_THROWS_AS(add_note(*study, "", kNow), StorageError);
  CHECK_FALSE(is_unblinded(*study));
  unblind(*study, "interim look, agreed", kNow);
  CHECK(is_unblinded(*study));
  CHECK_THROWS_WITH(unblind(*study, "again", kNow), Catch::Contains("unblinded already"));
  CHECK(problems_of(*study).empty());
  CHECK(study->impl()
            .database()
            .execAndGet("SELECT group_concat(text, '; ') FROM notes WHERE session IS NULL")
            .getString() == "new gloves; left-handed after all");
  const auto reader = Study::open(path, Study::Access::read_only);
  CHECK_THROWS_WITH(add_note(*reader, "x", kNow), Catch::Contains("reading only"));
}

TEST_CASE("a participant has several sessions, each with its number, plan and log", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  run_session(*study, 1, 1);
  run_session(*study, 1, 2);
  run_session(*study, 2, 1);
  const std::vector<SessionInfo> sessions = study->sessions();
  REQUIRE(sessions.size() == 3);
  CHECK(sessions[1].participant == "P01");
  CHECK(sessions[1].number == 2);
  CHECK(sessions[1].language == "de");
  CHECK(problems_of(*study).empty());
  NewSession twice = new_session(1);
  twice.id = "twice";
  twice.number = 2;
  CHECK_THROWS_WITH(study->open_session(twice), Catch::Contains("session 2 of participant P01 exists already"));
  twice.number = 0;
  CHECK_THROWS_AS(study->open_session(twice), StorageError);

  const StudyResults results = results_of(*study, tutorial(), SessionKind::simulated);
  CHECK(results.attendance.participants == 2);
  int first = 0, second = 0;
  for (const CellResult& cell : results.task.cells)
    (cell.participant == "P01" ? first : second) += cell.counts.n_diff + cell.counts.n_same;
  CHECK(first == 32);
  CHECK(second == 16);
  CHECK(study->impl().database().execAndGet("SELECT max(sessions) FROM participants").getInt() == 2);
}

TEST_CASE("codes of participants are letters and digits", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  for (const std::string& code : {std::string("P-1"), std::string("P_1"), std::string("P.1"), std::string("\x1B[31m"),
                                  std::string("\xC3\xA9"), std::string(33, 'a')}) {
    NewSession session = new_session(1);
    session.participant = code;
    CHECK_THROWS_WITH(study->open_session(session), Catch::Contains("letters and digits"));
  }
  NewSession session = new_session(1);
  session.participant = std::string(32, 'a');
  CHECK_NOTHROW(study->open_session(session));
}

TEST_CASE("results leave excluded participants out, and name them", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd"), fewer = new_study(folder / "fewer.jnd");
  for (int number = 1; number <= 3; ++number) run_whole_session(*study, tutorial(), number);
  for (int number = 1; number <= 2; ++number) run_whole_session(*fewer, tutorial(), number);
  exclude_participant(*study, "P03", SessionKind::simulated, "pressed one key", false, kNow);
  add_note(*study, "=1+1", kNow);
  const StudyResults results = results_of(*study, tutorial(), SessionKind::simulated),
                     expected = results_of(*fewer, tutorial(), SessionKind::simulated);
  CHECK(results.attendance.participants == 2);
  REQUIRE(results.task.cells.size() == expected.task.cells.size());
  for (std::size_t i = 0; i < expected.task.cells.size(); ++i)
    CHECK(results.task.cells[i].counts == expected.task.cells[i].counts);
  REQUIRE(results.attendance.excluded.size() == 1);
  std::string deviations;
  for (const std::string& one : results.deviations) deviations += one;
  CHECK_THAT(deviations, Catch::Contains("excluded: P03 (pressed one key)"));
  CHECK(kinds_in(*study) == std::vector<SessionKind>{SessionKind::simulated});
  SQLite::Database& database = study->impl().database();
  CHECK(database.execAndGet("SELECT count(DISTINCT participant) FROM counts").getInt() == 2);
  CHECK(database.execAndGet("SELECT excluded_reason FROM participants WHERE excluded").getString() ==
        "pressed one key");
  CHECK(database.execAndGet("SELECT count(*) FROM trials WHERE excluded").getInt() == 24);

  export_csv(*study, tutorial(), results, folder / "out", false);
  CHECK(std::filesystem::exists(folder / "out" / "sub-P02"));
  CHECK_FALSE(std::filesystem::exists(folder / "out" / "sub-P03"));
  CHECK_THAT(bytes_of(folder / "out" / "sessions.csv"), Catch::Contains("P03"));
  const std::string log = bytes_of(folder / "out" / "log.csv");
  CHECK_THAT(log, Catch::Contains("excluded,,,,,pressed one key") && Catch::Contains("'=1+1"));
  CHECK_THAT(bytes_of(folder / "out" / "dictionary.csv"), Catch::Contains("log.csv,event,what happened"));
  export_csv(*fewer, tutorial(), expected, folder / "plain", false);
  CHECK_FALSE(std::filesystem::exists(folder / "plain" / "log.csv"));
}

TEST_CASE("log.csv holds what the operator did, in order", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  {
    const auto log = study->open_session(new_session(1));
    const Trial trial = make_plan(tutorial(), 1, kSeed).trials[0];
    log->append(event_kind::kTrialCompleted, to_body(record_of(tutorial(), trial, kClassSame)), {1, 1});
    log->append(event_kind::kTrialVoided, voided_body(tutorial(), trial, 1, "taken_back"), {2'000'000'001, 2});
    log->append(event_kind::kPaused, {{"cause", "key"}, {"reason", "a, \"b\""}}, {3, 3});
    log->append(event_kind::kContinued, {{"paused_s", 12.5}}, {4, 4});
    log->append(event_kind::kNote, {{"text", "coughed"}, {"by", "operator"}, {"after_trial", 0}}, {5, 5});
    log->append(event_kind::kSessionResumed, {{"cause", "killed"}, {"gap_s", 60}}, {6, 6});
  }
  SQLite::Database& database = study->impl().database();
  CHECK(database.execAndGet("SELECT paused_s FROM pauses").getDouble() == 12.5);
  CHECK(database.execAndGet("SELECT gap_s FROM resumes").getInt() == 60);
  CHECK(database.execAndGet("SELECT text FROM notes").getString() == "coughed");
  export_csv(*study, tutorial(), results_of(*study, tutorial(), SessionKind::simulated), folder / "out", false);
  const std::string log = bytes_of(folder / "out" / "log.csv");
  CHECK_THAT(log, Catch::Contains("answer_taken_back,1,1,same,taken_back,,participant,2"));
  CHECK_THAT(log, Catch::Contains("paused,,,,key,\"a, \"\"b\"\"\",,"));
  CHECK_THAT(log, Catch::Contains("continued,,,,,,,12.5"));
  CHECK_THAT(log, Catch::Contains("note,0,,,,coughed,operator,"));
  CHECK_THAT(log, Catch::Contains("resumed,,,,killed,,,60"));
  CHECK_THAT(bytes_of(folder / "out" / "trials.csv"), !Catch::Contains("P01-simulated,1,simulated"));
}

}  // namespace
}  // namespace jnd
