// What is append-only stays so, and what was changed behind the program's back is found.
#include <string>

#include "data/chain.h"
#include "data/study.h"
#include "data/utc_time.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

std::filesystem::path whole_study(const TemporaryFolder& folder) {
  const auto path = folder / "study.jnd";
  const auto study = new_study(path);
  run_whole_session(*study, tutorial(), 1);
  run_whole_session(*study, tutorial(), 2);
  study->open_session(new_session(3));  // still open
  return path;
}

std::string problems_of(const std::filesystem::path& path) {
  std::string all;
  for (const std::string& problem : verify(*Study::open(path, Study::Access::read_only)).problems)
    all += problem + "\n";
  return all;
}

// Someone who knows SQL and takes the triggers away first.
std::string after_tampering(const std::string& sql) {
  const TemporaryFolder folder;
  const auto path = whole_study(folder);
  raw_sql(path,
          "DROP TRIGGER event_no_update; DROP TRIGGER event_no_delete; DROP TRIGGER event_in_order; DROP TRIGGER "
          "event_trial_once; DROP TRIGGER study_no_update; DROP TRIGGER protocol_no_update;" +
              sql);
  return problems_of(path);
}

TEST_CASE("a whole study verifies, with its counts", "[data]") {
  const TemporaryFolder folder;
  const VerifyReport report = verify(*Study::open(whole_study(folder), Study::Access::read_only));
  CHECK(report.problems == std::vector<std::string>{});
  CHECK(report.sessions == 3);
  CHECK(report.trials == 32);
  CHECK(report.voided == 0);
  CHECK(report.events == 1 + 2 + 2 * (1 + 24 + 1) + 1);  // the study's, two whole sessions, one only opened
}

TEST_CASE("the file refuses UPDATE, DELETE and every way round them", "[data]") {
  const TemporaryFolder folder;
  const auto path = whole_study(folder);
  const std::string copy = "SELECT session, seq, kind, utc, monotonic_ns, version, body, hash FROM event ";
  const std::string columns = "(session, seq, kind, utc, monotonic_ns, version, body, hash) ";
  for (const std::string& sql : {
           std::string("UPDATE event SET body = '{}' WHERE seq = 3"),
           std::string("DELETE FROM event WHERE seq = 3"),
           std::string("DELETE FROM event"),
           "INSERT INTO event " + columns + copy + "WHERE session = 'P01-simulated' AND seq = 3",
           "INSERT OR REPLACE INTO event " + columns + copy + "WHERE session = 'P01-simulated' AND seq = 3",
           std::string(
               "REPLACE INTO event (rowid, session, seq, kind, utc, monotonic_ns, version, body, hash) SELECT 2, "
               "session, 2, kind, utc, monotonic_ns, version, body, hash FROM event WHERE session = "
               "'P03-simulated'"),
           "INSERT INTO event " + columns +
               "SELECT session, 27, kind, utc, monotonic_ns, version, body, hash FROM event WHERE session = "
               "'P01-simulated' AND seq = 3",
           std::string("INSERT INTO event VALUES ('x', 1, 'note', '2023-11-14T22:13:20.123456789Z', 1, '0', 'no JSON', "
                       "hex(randomblob(32)))"),
           std::string("UPDATE study SET seed = '1'"),
           std::string("DELETE FROM study"),
           std::string("REPLACE INTO study SELECT id, '1', protocol FROM study"),
           std::string("UPDATE protocol SET bytes = x'00'"),
           std::string("DELETE FROM protocol"),
           std::string("REPLACE INTO protocol SELECT sha256, name, x'00' FROM protocol"),
       }) {
    CAPTURE(sql);
    CHECK_THROWS_AS(raw_sql(path, sql), SQLite::Exception);
  }
  CHECK(problems_of(path).empty());
}

TEST_CASE("a changed event is found and named", "[data]") {
  const std::string where = " WHERE session = 'P01-simulated' AND seq = 12";
  for (const std::string& sql :
       {std::string("UPDATE event SET body = replace(body, '\"duration_s\":', '\"duration_s\": ')"),
        std::string("UPDATE event SET utc = '2024-11-14T22:13:20.123456789Z'"),
        std::string("UPDATE event SET monotonic_ns = monotonic_ns + 1"), std::string("UPDATE event SET version = 'x'"),
        std::string("UPDATE event SET kind = 'trial.voided'")}) {
    CAPTURE(sql);
    const std::string problems = after_tampering(sql + where);
    CHECK_THAT(problems, Catch::Contains("P01-simulated, event 12"));
    CHECK_THAT(problems, Catch::Contains("hash does not match"));
  }
}

TEST_CASE("removed, moved and forged events are found", "[data]") {
  CHECK_THAT(after_tampering("DELETE FROM event WHERE session = 'P01-simulated' AND seq = 12"),
             Catch::Contains("event 13 follows event 11"));
  CHECK_THAT(after_tampering("DELETE FROM event WHERE session = 'P01-simulated' AND seq >= 20"),
             Catch::Contains("was closed with"));
  CHECK_THAT(after_tampering("DELETE FROM event WHERE session = 'P01-simulated'"),
             Catch::Contains("is not in the file"));
  CHECK_THAT(after_tampering("DELETE FROM event WHERE session = 'study'"), Catch::Contains("own events are missing"));
  CHECK_THAT(after_tampering("UPDATE event SET session = 'P09' WHERE session = 'P03-simulated'"),
             Catch::Contains("Session P09, event 1"));
  CHECK_THAT(after_tampering("UPDATE study SET seed = '7'"), Catch::Contains("seed"));
  CHECK_THAT(after_tampering("UPDATE protocol SET bytes = CAST(replace(CAST(bytes AS TEXT), 'Tutorial', 'Tutorium') AS "
                             "BLOB)"),
             Catch::Contains("SHA-256"));
  CHECK_THAT(after_tampering("UPDATE event SET kind = 'trial.invented' WHERE session = 'P01-simulated' AND seq = 5"),
             Catch::Contains("unknown kind \"trial.invented\""));
}

// The chain alone cannot find this one: a program with a fault writes it, hashes and all.
TEST_CASE("trials that are not the plan's are found although their hashes are right", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  const Plan plan = make_plan(tutorial(), 1, kSeed);
  Trial other = plan.trials[10];
  other.stimuli_n_per_m = {450, 900};
  other.same = false;
  Trial moved = plan.trials[11];
  moved.block += 1;
  Trial invented = plan.trials[12];
  invented.index = 999;
  for (const Trial& trial : {other, moved, invented})
    log->append(event_kind::kTrialCompleted, to_body(record_of(tutorial(), trial, Judgement::same)), {5, 5});
  auto lie = to_body(record_of(tutorial(), plan.trials[13], Judgement::same));
  lie["correct"] = !lie["correct"].get<bool>();
  log->append(event_kind::kTrialCompleted, lie, {6, 6});
  const std::vector<std::string> problems = verify(*study).problems;
  REQUIRE(problems.size() == 4);
  CHECK_THAT(problems[0], Catch::Contains("event 2") && Catch::Contains("presented 450 and 900"));
  CHECK_THAT(problems[1], Catch::Contains("event 3") && Catch::Contains("block"));
  CHECK_THAT(problems[2], Catch::Contains("trial 999 is not in the plan"));
  CHECK_THAT(problems[3], Catch::Contains("contradicts"));
}

TEST_CASE("a trial completed twice is found", "[data]") {
  const std::string problems = after_tampering(
      "UPDATE event SET body = (SELECT body FROM event WHERE session = 'P01-simulated' AND seq = 11) WHERE session = "
      "'P01-simulated' AND seq = 12");
  CHECK_THAT(problems, Catch::Contains("event 12") && Catch::Contains("was completed before"));
}

TEST_CASE("the hash is over netstrings of the stored fields", "[data]") {
  Event event;
  event.session = "P01";
  event.seq = 2;
  event.kind = "note";
  event.stamp.monotonic_ns = -7;
  event.version = "0.1.0";
  event.body = "{\"text\":\"\xC3\xA9\"}";
  // Python: hashlib.sha256(b"2:ab,3:P01,1:2,4:note,30:1970-01-01T00:00:00.000000000Z,2:-7,5:0.1.0,13:" +
  //   '{"text":"é"},'.encode()).hexdigest()
  CHECK(event_hash("ab", event, to_iso8601(0)) == "6c3f49f2e75e1d3a643a1b07db24357173a9a5d7a78c72f2a7805b6b22def9f3");
}

}  // namespace
}  // namespace jnd
