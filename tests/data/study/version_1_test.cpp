// Studies of file version 1 can be read as they are, and become current ones when a session goes on.
#include "data/export/export.h"
#include "data/log/replay.h"
#include "data/results/study_analysis.h"
#include "data/study/schema.h"
#include "data/study/study_impl.h"
#include "data/verify/verify.h"
#include "tests/catch.h"
#include "tests/data/telemetry_fixture.h"
#include "tests/data/version_1_study.h"

namespace jnd {
namespace {

using Access = Study::Access;

TEST_CASE("a study of version 1 is read, verified, analysed and exported as it is", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "old.jnd";
  write_version_1_study(path);
  const std::string before = bytes_of(path);
  {
    const auto study = Study::open(path, Access::read_only);
    REQUIRE(study->sessions().size() == 2);
    CHECK(study->sessions()[0].trials_done == 16);
    CHECK(study->telemetry("P01-simulated", 2).empty());
    const VerifyReport report = verify(*study);
    CHECK(report.problems == std::vector<Problem>{});
    CHECK(report.trials == 16 + 2);
    const SessionState state = replay(study->events("P01-simulated"));
    REQUIRE(state.completed.size() == 24);
    const TrialRecord& record = state.completed[20];
    CHECK(record.trial == make_plan(tutorial(), 1, kSeed).trials[20]);
    REQUIRE(record.presentations[1].fingers.size() == 2);
    CHECK(record.presentations[1].fingers[1].finger == 1);  // the place was not stored: it is the order
    CHECK(record.presentations[1].fingers[1].channel == Channel::cutaneous);
    CHECK_FALSE(record.presentations[1].fingers[1].stiffness_se);

    // The results are those of the same trials in a study of this version.
    const auto current = new_study(folder / "current.jnd");
    run_whole_session(*current, tutorial(), 1);
    const StudyAnalysis old = analyze(*study, tutorial(), SessionKind::simulated),
                        now = analyze(*current, tutorial(), SessionKind::simulated);
    for (std::size_t i = 0; i < now.cells.size(); ++i) {
      CHECK(old.cells[i].counts == now.cells[i].counts);
      CHECK(old.cells[i].delivered_difference.mean == now.cells[i].delivered_difference.mean);
    }
    export_csv(*study, tutorial(), results_of(*study, tutorial(), SessionKind::simulated), folder / "out", false,
               TelemetryExport{});
    CHECK(bytes_of(folder / "out" / "sub-P01" / "cells.csv").size() > 100);
  }
  CHECK(bytes_of(path) == before);
  CHECK(version_of(path) == 1);
}

TEST_CASE("a study of version 1 becomes current when it is opened for writing, and loses nothing", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "old.jnd";
  write_version_1_study(path);
  // A reader that has the old file open goes on.
  const auto reader = Study::open(path, Access::read_only);
  const std::vector<Event> before = reader->events("P01-simulated");
  {
    const auto study = Study::open(path, Access::read_write);
    const std::vector<Event> after = study->events("P01-simulated");
    REQUIRE(after.size() == before.size());
    for (std::size_t i = 0; i < after.size(); ++i) CHECK(after[i].hash == before[i].hash);
    const auto log = study->resume_session("P02-simulated");
    const std::vector<Trial> trials = make_plan(tutorial(), 2, kSeed).trials;
    REQUIRE(replay(log->events()).completed.size() == 10);
    append_with_telemetry(*log, trials[10], {press(20), press(20)});
    for (std::size_t i = 11; i < trials.size(); ++i)
      log->append(event_kind::kTrialCompleted, to_body(record_of(tutorial(), trials[i], usual_answer(trials[i]))),
                  stamp_of(trials[i]));
    study->close_session("P02-simulated", {9, 9});
    CHECK(verify(*reader).problems == std::vector<Problem>{});
    CHECK(verify(*reader).telemetry == 2);
  }
  CHECK(version_of(path) == kSchemaVersion);
  const auto study = Study::open(path, Access::read_only);
  CHECK(verify(*study).problems == std::vector<Problem>{});
  CHECK(study->telemetry("P02-simulated", 12).size() == 2);
  SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
  CHECK(database.execAndGet("SELECT count(*) FROM trials WHERE stimulus_1_n_per_rad IS NULL AND stimulus_1_n_per_m > 0")
            .getInt() == 48);
  CHECK(database.execAndGet("SELECT sum(n_diff + n_same) FROM counts").getInt() == 32);
}

// Two ways to the same tables: made new, and brought forward.
TEST_CASE("a study brought forward has the schema of a new one", "[data]") {
  const TemporaryFolder folder;
  write_version_1_study(folder / "old.jnd");
  Study::open(folder / "old.jnd", Access::read_write)->close();
  new_study(folder / "new.jnd")->close();
  const auto schema = [](const std::filesystem::path& path) {
    SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
    SQLite::Statement query(database, "SELECT type, name, sql FROM sqlite_master ORDER BY type, name");
    std::string all;
    while (query.executeStep())
      all += query.getColumn(0).getString() + " " + query.getColumn(1).getString() + ": " +
             query.getColumn(2).getString() + "\n";
    return all;
  };
  CHECK(schema(folder / "old.jnd") == schema(folder / "new.jnd"));
}

}  // namespace
}  // namespace jnd
