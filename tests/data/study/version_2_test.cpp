// Studies of file version 2 can be read as they are, and become current ones when a session goes on.
#include "data/log/replay.h"
#include "data/results/study_analysis.h"
#include "data/study/schema.h"
#include "data/study/study_impl.h"
#include "data/verify/verify.h"
#include "tests/catch.h"
#include "tests/data/version_2_study.h"

namespace jnd {
namespace {

using Access = Study::Access;

TEST_CASE("a study of version 2 is read, verified and analysed as it is", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "old.jnd";
  write_version_2_study(path);
  const std::string before = bytes_of(path);
  {
    const auto study = Study::open(path, Access::read_only);
    const std::vector<SessionInfo> sessions = study->sessions();
    REQUIRE(sessions.size() == 3);
    CHECK(sessions[0].number == 1);
    CHECK(sessions[0].language.empty());
    CHECK(sessions[0].rig_sha256.empty());
    CHECK(sessions[2].rig_sha256 == std::string(64, 'a'));
    CHECK(sessions[2].trials_voided == 1);
    CHECK_FALSE(sessions[2].excluded);
    CHECK(verify(*study).problems == std::vector<Problem>{});
    CHECK(replay(study->events("P03-simulated")).completed.size() == 2);
    CHECK(analyze(*study, tutorial(), SessionKind::simulated).participants == 3);
  }
  CHECK(bytes_of(path) == before);
  CHECK(version_of(path) == 2);
}

TEST_CASE("a study of version 2 becomes current when it is opened for writing", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "old.jnd";
  write_version_2_study(path);
  {
    const auto study = Study::open(path, Access::read_write);
    CHECK(verify(*study).problems == std::vector<Problem>{});
    const auto log = study->resume_session("P03-simulated");
    // What version 2 refused: an answer taken back, and given again.
    const Trial trial = make_plan(tutorial(), 3, kSeed).trials[1];
    log->append(event_kind::kTrialVoided, voided_body(tutorial(), trial, 1, "taken_back"), {8, 8});
    TrialRecord again = record_of(tutorial(), trial, usual_answer(trial));
    again.attempt = 2;
    log->append(event_kind::kTrialCompleted, to_body(again), {9, 9});
    CHECK(verify(*study).problems == std::vector<Problem>{});
  }
  CHECK(version_of(path) == kSchemaVersion);
  SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
  CHECK(database.execAndGet("SELECT count(*) FROM trials WHERE session = 'P03-simulated'").getInt() == 2);
  CHECK(database.execAndGet("SELECT group_concat(trial) FROM taken_back").getString() == "2");
  CHECK(database.execAndGet("SELECT min(session_number) FROM sessions").getInt() == 1);
}

TEST_CASE("a study brought forward from version 2 has the schema of a new one", "[data]") {
  const TemporaryFolder folder;
  write_version_2_study(folder / "old.jnd");
  Study::open(folder / "old.jnd", Access::read_write)->close();
  new_study(folder / "new.jnd")->close();
  const auto schema = [](const std::filesystem::path& path) {
    SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
    SQLite::Statement query(database, "SELECT name, sql FROM sqlite_master ORDER BY type, name");
    std::string all;
    while (query.executeStep()) all += query.getColumn(0).getString() + ": " + query.getColumn(1).getString() + "\n";
    return all;
  };
  CHECK(schema(folder / "old.jnd") == schema(folder / "new.jnd"));
}

}  // namespace
}  // namespace jnd
