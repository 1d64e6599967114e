// What is append-only stays so, and what was changed behind the program's back is found.
#include "data/verify/verify.h"

#include <atomic>
#include <string>
#include <thread>

#include "data/log/chain.h"
#include "data/log/utc_time.h"
#include "data/study/study.h"
#include "protocols/input/sha256.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"
#include "tests/data/telemetry_fixture.h"

namespace jnd {
namespace {

std::filesystem::path whole_study(const TemporaryFolder& folder) {
  const auto path = folder / "study.jnd";
  const auto study = new_study(path);
  run_whole_session(*study, tutorial(), 1);
  run_whole_session(*study, tutorial(), 2);
  append_with_telemetry(*study->open_session(new_session(3)), make_plan(tutorial(), 3, kSeed).trials[0],
                        {press(3), press(3)});  // still open
  return path;
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
  CHECK(report.problems == std::vector<Problem>{});
  CHECK(report.sessions == 3);
  CHECK(report.trials == 32);
  CHECK(report.voided == 0);
  CHECK(report.events == 1 + 2 + 2 * (1 + 24 + 1) + 2);  // the study's, two whole sessions, one with a trial
  CHECK(report.telemetry == 2);
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
           std::string("UPDATE telemetry SET ticks = 0"),
           std::string("DELETE FROM telemetry"),
           std::string(
               "REPLACE INTO telemetry SELECT session, seq, interval, sha256, 0, dropped, bytes FROM telemetry"),
           std::string("INSERT INTO telemetry VALUES ('P01-simulated', 3, 0, hex(randomblob(32)), 1, 0, x'00')"),
           std::string("INSERT INTO telemetry VALUES ('P09-simulated', 1, 0, hex(randomblob(32)), 1, 0, x'00')"),
           std::string("INSERT INTO telemetry VALUES ('P03-simulated', 2, 3, hex(randomblob(32)), 1, 0, x'00')"),
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

TEST_CASE("what was found before the file breaks off is told with the damage", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  {
    const auto study = new_study(path);
    run_whole_session(*study, tutorial(), 1);
    run_whole_session(*study, tutorial(), 2);
    const auto log = study->open_session(new_session(3));
    answer_all(*log, tutorial(), 3);
    for (int i = 0; i < 100; ++i) log->append(event_kind::kNote, {{"text", "of the page that is lost"}}, {9, 9});
  }
  hidden_sql(path,
             "UPDATE event SET utc = '2024-11-14T22:13:20.123456789Z' WHERE session = 'P01-simulated' AND seq = 12");
  std::string bytes = bytes_of(path);
  const std::size_t at = bytes.find("of the page that is lost");
  REQUIRE(at != std::string::npos);
  bytes.replace(at / 4096 * 4096, 4096, std::string(4096, '\xA5'));
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
  const VerifyReport report = verify(*Study::open(path, Study::Access::read_only));
  std::string all;
  for (const Problem& problem : report.problems) all += problem.text + "\n";
  CHECK_THAT(all, Catch::Contains("Session P01-simulated, event 12 (trial.completed): its hash does not match"));
  CHECK_THAT(all, Catch::Contains("could not be read to its end"));
  CHECK(report.events > 52);  // of the two sessions before it
  CHECK(report.sessions == 3);
}

TEST_CASE("a participant code that leads out of a folder is found, and no list of sessions takes it", "[data]") {
  const TemporaryFolder folder;
  const auto path = whole_study(folder);
  raw_sql(path,
          "DROP TRIGGER event_no_update; UPDATE event SET body = json_set(body, '$.participant', '/../../x') WHERE "
          "session = 'P01-simulated' AND seq = 1");
  CHECK_THAT(problems_of(path), Catch::Contains("Session P01-simulated, event 1: the participant code cannot be one."));
  CHECK_THROWS_WITH(Study::open(path, Study::Access::read_only)->sessions(),
                    Catch::Contains("has the participant code \"/../../x\", which cannot be one"));
}

TEST_CASE("a second closing in the study's own events does not take the place of the first", "[data]") {
  const TemporaryFolder folder;
  const auto path = whole_study(folder);
  const auto study = Study::open(path, Study::Access::read_write);
  study->add_study_event(
      event_kind::kSessionClosed,
      {{"session", "P01-simulated"}, {"participant", "P01"}, {"kind", "simulated"}, {"head", std::string(64, '0')}},
      {7, 7});
  const std::vector<std::string> problems = texts(verify(*study).problems);
  CHECK(problems == std::vector<std::string>{"Session P01-simulated: was closed twice in the study's own events."});
}

// The chain alone cannot find this one: a program with a fault writes it, hashes and all.
TEST_CASE("trials that are not the plan's are found although their hashes are right", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  const Plan plan = make_plan(tutorial(), 1, kSeed);
  Trial other = plan.trials[10];
  other.stimuli = {450, 900};
  other.target = kClassDifferent;
  Trial moved = plan.trials[11];
  moved.block += 1;
  Trial invented = plan.trials[12];
  invented.index = 999;
  for (const Trial& trial : {other, moved, invented})
    log->append(event_kind::kTrialCompleted, to_body(record_of(tutorial(), trial, kClassSame)), {5, 5});
  auto lie = to_body(record_of(tutorial(), plan.trials[13], kClassSame));
  lie["correct"] = !lie["correct"].get<bool>();
  log->append(event_kind::kTrialCompleted, lie, {6, 6});
  TrialRecord broken = record_of(tutorial(), plan.trials[14], kClassSame);
  broken.breach = "second interval: contacts 3, above 2";
  log->append(event_kind::kTrialCompleted, to_body(broken), {7, 7});
  const std::vector<std::string> problems = texts(verify(*study).problems);
  REQUIRE(problems.size() == 5);
  CHECK_THAT(problems[4], Catch::Contains("\"breach\" is not what follows"));
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

std::filesystem::path study_with_telemetry(const TemporaryFolder& folder) {
  const auto path = folder / "study.jnd";
  const auto study = new_study(path);
  const auto log = study->open_session(new_session(1));
  const std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;
  for (std::size_t i = 0; i < 3; ++i) append_with_telemetry(*log, trials[i], {press(30), press(20)});
  log->append(event_kind::kBreakTaken, {{"after_trial", 1}, {"duration_s", 1.0}}, {9, 9});
  return path;
}

TEST_CASE("telemetry that was changed, removed, moved or slipped in is found", "[data]") {
  const std::string at = " WHERE session = 'P01-simulated' AND seq = 3 AND interval = 1";
  const auto after = [&](const std::string& sql) {
    const TemporaryFolder folder;
    const auto path = study_with_telemetry(folder);
    CHECK(problems_of(path).empty());
    raw_sql(path,
            "DROP TRIGGER telemetry_no_update; DROP TRIGGER telemetry_no_delete; DROP TRIGGER telemetry_once;" + sql);
    return problems_of(path);
  };
  const std::string interval = "Session P01-simulated, event 3 (trial.completed): the telemetry of interval 2 ";
  const std::string blob_of_other = "(SELECT bytes FROM telemetry WHERE seq = 2 AND interval = 0)";
  CHECK_THAT(after("UPDATE telemetry SET bytes = CAST(bytes || x'00' AS BLOB)" + at),
             Catch::StartsWith(interval + "was changed"));
  CHECK_THAT(after("UPDATE telemetry SET bytes = " + blob_of_other + at), Catch::StartsWith(interval + "was changed"));
  CHECK_THAT(after("UPDATE telemetry SET ticks = ticks + 1" + at), Catch::Contains("contradict the event"));
  CHECK_THAT(after("UPDATE telemetry SET sha256 = '" + std::string(64, '0') + "'" + at),
             Catch::Contains("contradict the event"));
  CHECK_THAT(after("DELETE FROM telemetry" + at), Catch::StartsWith(interval + "is missing"));
  const std::string slipped_in =
      "INSERT INTO telemetry SELECT session, 5, interval, sha256, ticks, dropped, bytes FROM telemetry" + at;
  CHECK_THAT(after(slipped_in),
             Catch::StartsWith(
                 "Session P01-simulated, event 5: there is telemetry of interval 2 that the event does not name"));
  const std::string moved = after("UPDATE telemetry SET seq = 5" + at);
  CHECK_THAT(moved, Catch::Contains("is missing") && Catch::Contains("does not name"));
}

// Its hash is right, because the program that wrote it had a fault.
TEST_CASE("telemetry that cannot be read is found although its hash is right", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  TelemetryBlob broken = encode_telemetry(0, press(5));
  broken.bytes.resize(broken.bytes.size() - 6);
  broken.sha256 = sha256_hex(broken.bytes);
  TelemetryBlob miscounted = encode_telemetry(1, press(5));
  miscounted.ticks = 11;
  const std::vector<TelemetryBlob> blobs = {broken, miscounted};
  log->append(event_kind::kDeviceFault, {{"index", 1}, {"telemetry", telemetry_body(blobs)}}, {2, 2}, blobs);
  log->append(event_kind::kDeviceFault, {{"index", 999}, {"telemetry", 3}}, {3, 3});
  log->append(event_kind::kDeviceFault, {{"index", 999}}, {4, 4});
  const std::vector<std::string> problems = texts(verify(*study).problems);
  REQUIRE(problems.size() == 4);
  CHECK_THAT(problems[0], Catch::Contains("interval 1") && Catch::Contains("cannot be read"));
  CHECK_THAT(problems[1], Catch::Contains("holds 10 ticks") && Catch::Contains("says 11"));
  CHECK_THAT(problems[2], Catch::Contains("event 3") && Catch::Contains("\"telemetry\" of the event cannot be read"));
  CHECK_THAT(problems[3], Catch::Contains("trial 999 is not in the plan"));
}

TEST_CASE("a verification while a session writes sees one whole state", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  const auto writer = new_study(path, chinello());
  const auto reader = Study::open(path, Study::Access::read_only);
  const std::vector<TelemetryBlob> blobs = {encode_telemetry(0, press(20)), encode_telemetry(1, press(20))};
  std::atomic<bool> verified = false;
  std::atomic<int> stored = 0;
  std::thread session([&] {  // as long as the verifications take
    for (int number = 1; number <= 40 && !verified; ++number) {
      const auto log = writer->open_session(new_session(number));
      for (const Trial& trial : make_plan(chinello(), number, kSeed).trials) {
        if (verified) break;
        auto body = to_body(record_of(chinello(), trial, usual_answer(trial)));
        body["telemetry"] = telemetry_body(blobs);
        log->append(event_kind::kTrialCompleted, body, stamp_of(trial), blobs);
        stored += 2;
      }
    }
  });
  std::vector<std::string> problems;
  while (stored < 100) std::this_thread::yield();
  for (int i = 0; i < 6; ++i)
    for (const Problem& problem : verify(*reader).problems) problems.push_back(problem.text);
  verified = true;
  session.join();
  CHECK(problems == std::vector<std::string>{});
  CHECK(verify(*reader).telemetry == stored);
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
