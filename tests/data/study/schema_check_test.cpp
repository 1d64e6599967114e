// A study's schema: what it checks, and older ones.
#include "data/study/schema_check.h"

#include "data/copies/backup.h"
#include "data/copies/merge.h"
#include "data/copies/recover.h"
#include "data/study/schema.h"
#include "data/study/study_admin.h"
#include "data/study/study_impl.h"
#include "data/verify/verify.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/data/older_study.h"

namespace jnd {
namespace {

// A file is opened only where its tables, triggers and views are those of its own version of a study.

using Access = Study::Access;

std::filesystem::path small_study(const TemporaryFolder& folder) {
  const auto path = folder / "study.jnd";
  std::filesystem::remove(path);
  run_whole_session(*new_study(path), tutorial(), 1);
  return path;
}

// Rewrites the text of a definition behind SQLite's back.
std::string rewritten(const std::string& name, const std::string& from, const std::string& to) {
  return "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, '" + from + "', '" + to +
         "') WHERE name = '" + name + "'; PRAGMA writable_schema = OFF";
}

void check_refused(const std::filesystem::path& path, Access access, const std::string& words) {
  const std::string before = bytes_of(path);
  CHECK_THROWS_WITH(Study::open(path, access), Catch::Contains("is not a study of this program: " + words) &&
                                                   Catch::Contains("it was not changed"));
  CHECK(bytes_of(path) == before);
}

TEST_CASE("a file with another schema is refused by name, and not changed", "[data]") {
  const TemporaryFolder folder;
  const std::pair<std::string, std::string> cases[] = {
      {"CREATE TRIGGER z BEFORE INSERT ON event WHEN NEW.kind = 'note' BEGIN SELECT RAISE(IGNORE); END",
       "it has a trigger z that no study has"},
      {"CREATE TABLE extra (x)", "it has a table extra that no study has"},
      {"CREATE VIEW mine AS SELECT * FROM trials", "it has a view mine that no study has"},
      {"DROP VIEW counts; CREATE VIEW counts AS SELECT 1 AS n_diff", "its view counts is another"},
      {"PRAGMA foreign_keys = OFF; DROP TABLE telemetry", "its table telemetry is missing"},
      {"PRAGMA foreign_keys = OFF; DROP TABLE telemetry; CREATE VIEW telemetry AS WITH RECURSIVE r(n) AS (SELECT 1 "
       "UNION ALL SELECT n + 1 FROM r) SELECT n AS session FROM r",
       "its table telemetry is another"},
      {rewritten("event", "(json_extract(body, ''$.answer''))", "(''different'')"), "its table event is another"},
      {rewritten("trials", "e.answer", "''different'' AS answer"), "its view trials is another"}};
  for (const auto& [sql, words] : cases) {
    CAPTURE(sql);
    const auto path = small_study(folder);
    raw_sql(path, sql);
    for (const Access access : {Access::read_only, Access::read_write}) check_refused(path, access, words);
  }
}

TEST_CASE("tables of nothing are no study", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "crafted.jnd";
  for (int version = 1; version <= kSchemaVersion; ++version) {
    CAPTURE(version);
    std::filesystem::remove(path);
    SQLite::Database(path.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE)
        .exec(
            "CREATE TABLE event (session, seq, kind, utc, monotonic_ns, version, body, hash); CREATE TABLE study (id, "
            "seed, protocol); PRAGMA application_id = " +
            std::to_string(kApplicationId) + "; PRAGMA user_version = " + std::to_string(version));
    for (const Access access : {Access::read_only, Access::read_write})
      check_refused(path, access, "its table event is another");
  }
}

TEST_CASE("what somebody dropped is told by verify, and such a file takes no more events", "[data]") {
  const TemporaryFolder folder;
  for (const char* what : {"TRIGGER event_no_delete", "INDEX event_note", "VIEW counts"}) {
    CAPTURE(what);
    const auto path = small_study(folder);
    raw_sql(path, std::string("DROP ") + what);
    check_refused(path, Access::read_write, "its ");
    const std::vector<std::string> problems = texts(verify(*Study::open(path, Access::read_only)).problems);
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], Catch::Contains("is not as this program makes a study") && Catch::Contains("is missing"));
  }
}

TEST_CASE("what SQLite itself keeps, and what VACUUM moves, is no change", "[data]") {
  const TemporaryFolder folder;
  const auto path = small_study(folder);
  raw_sql(path, "ANALYZE; VACUUM");
  const auto study = Study::open(path, Access::read_write);
  CHECK(verify(*study).problems == std::vector<Problem>{});
}

TEST_CASE("every version has the schema that its own steps make", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "older.jnd";
  write_older_study(path);
  {
    SQLite::Database older(path.string(), SQLite::OPEN_READONLY);
    CHECK(schema_differences(older, example_steps()).empty());
  }
  raw_sql(path, "PRAGMA user_version = 2");
  SQLite::Database newer(path.string(), SQLite::OPEN_READONLY);
  CHECK(schema_differences(newer, example_steps()).size() == 3);
}

TEST_CASE("an event that something swallows is not said to be stored", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  study->impl().database().exec(
      "CREATE TEMP TRIGGER z BEFORE INSERT ON main.event WHEN NEW.kind = 'note' BEGIN SELECT RAISE(IGNORE); END");
  CHECK_THROWS_WITH(add_note(*study, "hello", kNow), Catch::Contains("study.jnd: a row was not stored"));
  CHECK_THROWS_WITH(log->append(event_kind::kNote, {{"text", "hello"}}, kNow), Catch::Contains("was not stored"));
  log->append(event_kind::kBreakTaken, {{"after_trial", 0}, {"duration_s", 1.0}}, kNow);
  CHECK(verify(*study).problems == std::vector<Problem>{});
}

// Files of an older version can be read as they are, and become current ones when they are opened for writing. Files of
// programs from before the release are refused.

TEST_CASE("a study of an older version is read as it is", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "older.jnd";
  write_older_study(path);
  const std::string before = bytes_of(path);
  {
    const auto database = open_database(path, false, example_steps());
    CHECK(schema_differences(*database, example_steps()).empty());
    CHECK(database->execAndGet("SELECT count(*) FROM trials").getInt() == 24 + 10);
    CHECK_FALSE(database->tableExists("length"));
  }
  CHECK(bytes_of(path) == before);
  CHECK(version_of(path) == kSchemaVersion);
}

TEST_CASE("a study of an older version becomes current when it is opened for writing, and loses nothing", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "older.jnd";
  write_older_study(path);
  // A reader that has the older file open goes on.
  const auto reader = open_database(path, false, example_steps());
  const std::string before = hashes_in(*reader);
  {
    const auto database = open_database(path, true, example_steps());
    CHECK(schema_differences(*database, example_steps()).empty());
    CHECK(faults_of_second_version(*database).empty());
    CHECK(hashes_in(*database) == before);
    CHECK(hashes_in(*reader) == before);
    CHECK(reader->execAndGet("SELECT count(*) FROM length").getInt() > 0);
  }
  CHECK_THROWS_WITH(Study::open(path, Access::read_only), Catch::Contains("newer jnd"));
  CHECK_THROWS_WITH(Study::open(path, Access::read_write), Catch::Contains("newer jnd"));
}

// Two ways to the same tables: made new, and brought forward.
TEST_CASE("a study brought forward has the schema of a new one", "[data]") {
  const TemporaryFolder folder;
  write_older_study(folder / "older.jnd");
  open_database(folder / "older.jnd", true, example_steps());
  SQLite::Database(folder / "new.jnd", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec("");
  {
    SQLite::Database fresh(folder / "new.jnd", SQLite::OPEN_READWRITE);
    migrate(fresh, 0, example_steps());
  }
  const auto schema = [](const std::filesystem::path& path) {
    SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
    SQLite::Statement query(database, "SELECT type, name, sql FROM sqlite_master ORDER BY type, name");
    std::string all;
    while (query.executeStep())
      all += query.getColumn(0).getString() + " " + query.getColumn(1).getString() + ": " +
             query.getColumn(2).getString() + "\n";
    return all;
  };
  CHECK(schema(folder / "older.jnd") == schema(folder / "new.jnd"));
  CHECK_THAT(schema(folder / "new.jnd"), Catch::Contains("table length"));
}

TEST_CASE("a step of the schema that fails leaves the file as it was", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "older.jnd";
  write_older_study(path);
  const std::string before = bytes_of(path);
  const std::array failing = {schema_steps()[0],
                              "CREATE TABLE length (x); INSERT INTO length SELECT raise_nothing(1) FROM event"};
  CHECK_THROWS_AS(open_database(path, true, failing), StorageError);
  CHECK(bytes_of(path) == before);
  CHECK(verify(*Study::open(path, Access::read_write)).problems == std::vector<Problem>{});
}

TEST_CASE("a study written before the release is refused, and not changed", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "old.jnd", to = folder / "new.jnd";
  const auto words = Catch::Contains(
      "old.jnd: was written by a jnd from before its first release, whose files this program does not read; it was not "
      "changed. Simulate or run the study again with this program, or analyse the CSV files that were exported from it");
  const auto another = new_study(folder / "another.jnd");
  for (int version = 1; version <= 4; ++version) {
    CAPTURE(version);
    std::filesystem::remove(path);
    write_older_study(path);
    raw_sql(path, "PRAGMA application_id = " + std::to_string(kApplicationIdBeforeRelease) +
                      "; PRAGMA user_version = " + std::to_string(version));
    const std::string before = bytes_of(path);
    CHECK_THROWS_WITH(Study::open(path, Access::read_only), words);
    CHECK_THROWS_WITH(Study::open(path, Access::read_write), words);
    CHECK_THROWS_WITH(recover(path, to, std::nullopt, kNow), words);
    CHECK_THROWS_WITH(merge({path}, to, kNow), words);
    CHECK_THROWS_WITH(back_up(*another, path, true), Catch::Contains("is no backup of this study"));
    CHECK(bytes_of(path) == before);
    CHECK_FALSE(std::filesystem::exists(to));
    CHECK_FALSE(std::filesystem::exists(path.string() + ".lock"));
  }
}

}  // namespace
}  // namespace jnd
