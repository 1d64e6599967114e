// What is done with the sqlite3 shell without computing a hash anew is found, by verify and before results are
// computed.
#include "data/verify/chain_check.h"

#include "data/copies/recover.h"
#include "data/results/study_results.h"
#include "data/study/schema.h"
#include "data/study/study_admin.h"
#include "data/study/trial_rows.h"
#include "data/verify/verify.h"
#include "data/verify/verify_deep.h"
#include "protocols/input/sha256.h"
#include "protocols/tasks/task.h"
#include "tests/data/damage_fixture.h"

namespace jnd {
namespace {

using Access = Study::Access;

std::string refusal_of(const std::filesystem::path& path) {
  const auto study = Study::open(path, Access::read_only);
  try {
    results_of(*study, tutorial(), SessionKind::simulated);
  } catch (const BrokenChain& error) {
    return error.what();
  }
  return "";
}

// The last session of two, and an exclusion behind it.
std::filesystem::path study_with_exclusion(const TemporaryFolder& folder) {
  const auto path = folder / "study.jnd";
  std::filesystem::remove(path);
  const auto study = new_study(path);
  run_whole_session(*study, tutorial(), 1);
  run_whole_session(*study, tutorial(), 2);
  exclude_participant(*study, "P02", SessionKind::simulated, "asleep", false, kLater);
  return path;
}

TEST_CASE("a whole study says how many hashes agree, and where its own chain ends", "[data]") {
  const TemporaryFolder folder;
  const auto study = Study::open(study_with_exclusion(folder), Access::read_only);
  const ChainReport chains = require_whole_chains(*study);
  CHECK(chains.events == 1 + 2 * 26 + 2 + 1);
  CHECK(chains.study_head == study->study_events().back().hash);
  CHECK(study->head() == chains.study_head);
  CHECK(verify(*study).study_head == chains.study_head);
  CHECK_THAT(chain_line(chains), Catch::Contains("56 events") && Catch::Contains(chains.study_head));
  CHECK(results_of(*study, tutorial(), SessionKind::simulated).chains.study_head == chains.study_head);
}

TEST_CASE("the end of a chain that was cut off is missed", "[data]") {
  const TemporaryFolder folder;
  for (const std::string& sql :
       {std::string("DELETE FROM event WHERE kind = 'participant.excluded'"),
        std::string("DELETE FROM event WHERE (session = 'study' AND seq >= 3) OR session = 'P02-simulated'"),
        std::string("DELETE FROM event WHERE (session = 'study' AND seq >= 3) OR (session = 'P02-simulated' AND seq > "
                    "10)")}) {
    CAPTURE(sql);
    const auto path = study_with_exclusion(folder);
    hidden_sql(path, sql);
    CHECK_THAT(problems_of(path), Catch::Contains("events were added to it"));
    CHECK_THAT(refusal_of(path), Catch::Contains("is not what was recorded") && Catch::Contains("jnd verify"));
  }
}

TEST_CASE("no results come from a study of which an index leaves out a person", "[data]") {
  const TemporaryFolder folder;
  const auto path = study_with_exclusion(folder);
  const auto root = SQLite::Database(path.string(), SQLite::OPEN_READONLY)
                        .execAndGet("SELECT rootpage FROM sqlite_schema WHERE name = 'event_opened'")
                        .getInt64();
  std::string bytes = bytes_of(path);
  const std::size_t at = bytes.find("P01-simulated", static_cast<std::size_t>(root - 1) * 4096);
  REQUIRE(at < static_cast<std::size_t>(root) * 4096);
  bytes[at + 2] ^= 2;  // P03-simulated, of which there is no event
  write_bytes(path, bytes);
  CHECK(problems_of(path) != "");
  CHECK_THAT(refusal_of(path), Catch::Contains("is not what was recorded") && Catch::Contains("index event_opened"));
}

TEST_CASE("a session knows what the study's own chain was when it began and ended", "[data]") {
  const TemporaryFolder folder;
  const auto path = study_with_exclusion(folder);
  {
    const auto study = Study::open(path, Access::read_write);
    study->open_session(new_session(3, SessionKind::real));
    const auto body = nlohmann::ordered_json::parse(study->events("P03-real")[0].body);
    CHECK(body.at("study_head") == study->head());
    const auto closed = nlohmann::ordered_json::parse(study->events("P02-simulated").back().body);
    CHECK(closed.at("study_head") == study->study_events()[1].hash);
    CHECK_FALSE(nlohmann::ordered_json::parse(study->events("P02-simulated")[0].body).contains("study_head"));
    CHECK(verify(*study).problems == std::vector<Problem>{});
  }
  // Also where the count is lowered.
  hidden_sql(path, "DELETE FROM event WHERE kind = 'participant.excluded'; UPDATE tally SET events = events - 1");
  CHECK_THAT(problems_of(path), Catch::StartsWith("Session P03-real, event 1 (session.opened): names an event of the "
                                                  "study itself that is not there"));
}

TEST_CASE("rows that were moved are found, and change no result", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  const std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;
  {
    const auto study = new_study(path);
    const auto log = study->open_session(new_session(1));
    answer_all(*log, tutorial(), 1, 23);
    log->append(event_kind::kTrialVoided, voided_body(tutorial(), trials[22], 1, "taken_back"), kLater);
  }
  const auto counted = [&] {
    const auto study = Study::open(path, Access::read_only);
    return std::pair{study->sessions()[0].trials_done,
                     read_counted_trials(*study, tutorial(), study->sessions()).size()};
  };
  const auto before = counted();
  CHECK(before == std::pair{14, std::size_t{14}});
  SECTION("an answer behind what takes it back") {
    hidden_sql(path, "UPDATE event SET rowid = rowid + 100 WHERE kind = 'trial.completed' AND trial = 23");
    CHECK_THAT(problems_of(path), Catch::Contains("trial.voided") && Catch::Contains("rows were moved"));
  }
  SECTION("all of them the other way round") {
    hidden_sql(path, "UPDATE event SET rowid = -rowid");
    CHECK_THAT(problems_of(path), Catch::Contains("rows were moved"));
    const auto study = Study::open(path, Access::read_only);
    const std::vector<CountedTrial> read = read_counted_trials(*study, tutorial(), study->sessions());
    CHECK(std::is_sorted(read.begin(), read.end(),
                         [](const CountedTrial& a, const CountedTrial& b) { return a.index < b.index; }));
  }
  CHECK(counted() == before);
  SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
  CHECK(database.execAndGet("SELECT count(*) FROM taken_back").getInt() == 1);
  CHECK(database.execAndGet("SELECT trials_done FROM sessions").getInt() == 14);
}

TEST_CASE("results are refused where one stimulus was changed in the file", "[data]") {
  const TemporaryFolder folder;
  const auto path = study_with_exclusion(folder);
  CHECK(refusal_of(path).empty());
  std::string bytes = bytes_of(path);
  const std::size_t at = bytes.find("\"stimulus_1_n_per_m\":900");
  REQUIRE(at != std::string::npos);
  bytes.replace(at, 24, "\"stimulus_1_n_per_m\":400");
  write_bytes(path, bytes);
  const std::string refusal = refusal_of(path);
  CHECK_THAT(refusal, Catch::Contains("its hash does not match") && Catch::Contains("jnd recover"));
  CHECK_THAT(refusal, !Catch::Contains("400"));
}

TEST_CASE("only a recovery's own event forgives lost ticks, and verify counts what it forgives", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  nlohmann::ordered_json lost = nlohmann::ordered_json::array();
  for (const auto& [key, blobs] : content_of(path).telemetry)
    for (const TelemetryBlob& blob : blobs)
      lost.push_back({{"session", key.first}, {"seq", key.second}, {"interval", blob.interval}});
  const nlohmann::ordered_json forgiving = {{"file", "x"},
                                            {"seeds", nlohmann::ordered_json::array()},
                                            {"protocols", nlohmann::ordered_json::array()},
                                            {"sessions", nlohmann::ordered_json::array()},
                                            {"telemetry_lost", lost},
                                            {"study_events", nlohmann::ordered_json::array()}};
  hidden_sql(path, "DELETE FROM telemetry");
  Study::open(path, Access::read_write)->add_study_event(event_kind::kRecovered, forgiving, kLater);
  CHECK_THAT(problems_of(path), Catch::Contains("is not how this file began") && Catch::Contains("is missing"));

  // The real one, which also holds when the study is recovered or merged once more.
  const auto cut = folder / "cut.jnd";
  fill_study(*new_study(cut));
  hidden_sql(cut, "DELETE FROM telemetry WHERE seq = 3");
  recover(cut, folder / "once.jnd", std::nullopt, kLater);
  recover(folder / "once.jnd", folder / "twice.jnd", std::nullopt, kLater);
  for (const char* name : {"once.jnd", "twice.jnd"}) {
    const VerifyReport report = verify(*Study::open(folder / name, Access::read_only));
    CHECK(report.problems == std::vector<Problem>{});
    CHECK(report.telemetry == 4);
    CHECK(report.telemetry_lost == 2);
  }
}

TEST_CASE("what a study calls its protocol, and further protocols in it, are compared with its events", "[data]") {
  const TemporaryFolder folder;
  const auto path = study_with_exclusion(folder);
  hidden_sql(path, "UPDATE protocol SET name = 'preregistered-2019'");
  CHECK_THAT(problems_of(path), Catch::Contains("is called preregistered-2019, but study.created says tutorial"));
  hidden_sql(path, "UPDATE protocol SET name = 'tutorial'");
  CHECK(problems_of(path).empty());
  hidden_sql(path, "INSERT INTO protocol VALUES ('" + sha256_hex("{}") + "', 'extra', CAST('{}' AS BLOB))");
  CHECK_THAT(problems_of(path), Catch::Contains("no event of the study names it"));
}

TEST_CASE("an event that an export could not read is found", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  study->add_study_event(event_kind::kNote, {{"text", 5}}, kLater);
  study->add_study_event(event_kind::kNote, nlohmann::ordered_json::array(), kLater);
  log->append(event_kind::kNote, {{"text", "hello"}, {"after_trial", 1e99}}, kLater);
  log->append(event_kind::kNote, {{"text", nullptr}}, kLater);
  log->append(event_kind::kConsent, {{"refused", "no"}}, kLater);
  log->append(event_kind::kPaused, {{"cause", "key"}, {"reason", nullptr}}, kLater);  // is right
  const std::vector<std::string> problems = texts(verify(*study).problems);
  REQUIRE(problems.size() == 5);
  CHECK_THAT(problems[0], Catch::Contains("event 2 (note): \"after_trial\" is not a whole number"));
  CHECK_THAT(problems[1], Catch::Contains("event 3 (note): \"text\" is not text"));
  CHECK_THAT(problems[2], Catch::Contains("event 4 (consent.given): \"refused\" is not true or false"));
  CHECK_THAT(problems[3], Catch::Contains("Session study, event 2 (note): \"text\" is not text"));
  CHECK_THAT(problems[4], Catch::Contains("Session study, event 3 (note): the body is no object"));
}

TEST_CASE("a problem is sealed unless whoever makes it says that it gives nothing away", "[data]") {
  CHECK(Problem{}.reveals == Reveals::plan);
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  answer_all(*log, tutorial(), 1, 8);
  log->append(event_kind::kPracticeEnded, {{"rounds", 1}, {"share_correct", 0.1}, {"passed", false}}, kLater);
  Trial other = make_plan(tutorial(), 1, kSeed).trials[10];
  other.stimuli = {450, 900};
  log->append(event_kind::kTrialCompleted, to_body(record_of(tutorial(), other, kClassSame)), kLater);
  std::vector<Problem> problems = verify(*study).problems;
  const std::vector<Problem> deep = verify_deep(*study).problems;
  problems.insert(problems.end(), deep.begin(), deep.end());
  const auto sealed = [&](const std::string& words) {
    const auto found = std::find_if(problems.begin(), problems.end(),
                                    [&](const Problem& one) { return one.text.find(words) != std::string::npos; });
    REQUIRE(found != problems.end());
    CHECK(found->text.starts_with(found->where));
    return found->reveals == Reveals::plan;
  };
  CHECK(sealed("practice ended with a share correct of"));
  CHECK(sealed("presented 450 and 900"));
}

TEST_CASE("an event with a number that no event has is said to have it", "[data]") {
  const TemporaryFolder folder;
  const auto path = study_with_exclusion(folder);
  hidden_sql(path,
             "PRAGMA ignore_check_constraints = ON; UPDATE event SET seq = -9223372036854775807 - 1 WHERE session = "
             "'P02-simulated' AND seq = 1");
  const std::string refusal = refusal_of(path);
  CHECK_THAT(refusal, Catch::Contains("Session P02-simulated: event -9223372036854775808 has a number that no event "
                                      "has."));
}

TEST_CASE("one event is one event", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  CHECK_THAT(chain_line(require_whole_chains(*study)), Catch::Contains("(1 event)"));
}

}  // namespace
}  // namespace jnd
